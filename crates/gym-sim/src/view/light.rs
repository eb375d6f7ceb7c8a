//! The light, and colours in it.

use gym_core::canvas::Color;

use mujoco_engine::math::{Vec3, dot};

/// The direction to the light: above, and a little to the left and the front of most cameras.
pub(super) const LIGHT: Vec3 = [-0.37, -0.46, 0.81];
/// The number of outlines of a round shape.
pub(super) const LAYERS: usize = 9;

/// A mixture of two colours: `a` at `t` = 0, `b` at 1.
pub(super) fn blend(a: Color, b: Color, t: f64) -> Color {
    let t = t.clamp(0.0, 1.0);
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * t).round() as u8;
    Color {
        r: mix(a.r, b.r),
        g: mix(a.g, b.g),
        b: mix(a.b, b.b),
        a: a.a,
    }
}

/// The colour of a surface with the normal `normal`.
pub(super) fn lit(color: Color, normal: Vec3) -> Color {
    let facing = dot(normal, LIGHT);
    let dark = blend(color, Color::rgb(16, 18, 34), 0.5);
    if facing < 0.4 {
        blend(dark, color, (facing + 0.4) / 0.8)
    } else {
        blend(color, Color::WHITE, (facing - 0.4) / 0.6 * 0.2)
    }
}

/// The colour of a layer of a round shape: `t` is 0 for the outermost, 1 for the innermost.
pub(super) fn shade(color: Color, t: f64) -> Color {
    let dark = blend(color, Color::rgb(16, 18, 34), 0.52);
    let bright = blend(color, Color::WHITE, 0.22);
    if t < 0.6 {
        blend(dark, color, (t / 0.6).sqrt())
    } else {
        blend(color, bright, (t - 0.6) / 0.4)
    }
}
