//! Drawing with pygame's calls, for environments that look like Gymnasium's.
//!
//! Gymnasium draws with pygame, y up, and flips the surface. An environment here passes the same
//! numbers to [`Canvas::pygame`], in the coordinates of [`flipped`]. A canvas at Gymnasium's own
//! size repeats pygame's pixels; any other draws smooth shapes ([`smooth`](crate::canvas::smooth)).
//!
//! pygame's coordinates name the centres of pixels, so the origin is the centre of the bottom left
//! pixel. A surface wider than its frame uses coordinates shifted left by whole pixels: calls are
//! clipped at the surface's edges.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::drawing::canvas::{Canvas, Color, Point, Primitive, Transform};

/// The coordinates of a surface of that height, in pixels, that is turned upside down at the end.
pub const fn flipped(height: f64) -> Transform {
    Transform {
        origin: [0.5, height - 0.5],
        ..Transform::y_up(0.0)
    }
}

/// The coordinates of a surface that is not turned, in pixels.
pub const UPRIGHT: Transform = Transform::translate(0.5, 0.5);

/// `Vector2.rotate_rad`: a vector turned from x towards y. Quarter turns are exact.
pub fn rotate_rad(vector: Point, angle: f64) -> Point {
    Rotation::new(angle).apply(vector)
}

/// [`rotate_rad`] by one angle, for many vectors.
#[derive(Clone, Copy, Debug)]
pub struct Rotation {
    sin: f64,
    cos: f64,
}

impl Rotation {
    /// By an angle in radians, from x towards y.
    pub fn new(angle: f64) -> Self {
        /// pygame's tolerance for a quarter turn.
        const EPSILON: f64 = 1e-6;
        let angle = angle % TAU;
        let angle = if angle < 0.0 { angle + TAU } else { angle };
        let (sin, cos) = if (angle + EPSILON) % FRAC_PI_2 < 2.0 * EPSILON {
            match ((angle + EPSILON) / FRAC_PI_2) as i32 {
                1 => (1.0, 0.0),
                2 => (0.0, -1.0),
                3 => (-1.0, 0.0),
                _ => (0.0, 1.0),
            }
        } else {
            gym_numerics::math::sin_cos(angle)
        };
        Self { sin, cos }
    }

    /// The vector, turned.
    #[inline]
    pub fn apply(&self, [x, y]: Point) -> Point {
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y]
    }
}

/// `gfxdraw.aapolygon` and `gfxdraw.filled_polygon`, which Gymnasium calls together.
pub fn gfx_polygon(canvas: &mut dyn Canvas, points: &[Point], color: Color) {
    canvas.pygame(Primitive::AaPolygon(points), color);
    canvas.pygame(Primitive::FilledPolygon(points), color);
}

/// `gfxdraw.aacircle` and `gfxdraw.filled_circle`, which Gymnasium calls together, with whole
/// numbers.
pub fn gfx_circle(canvas: &mut dyn Canvas, center: Point, radius: f64, color: Color) {
    canvas.pygame(Primitive::AaCircle { center, radius }, color);
    canvas.pygame(Primitive::FilledCircle { center, radius }, color);
}

/// A rectangle between two opposite corners, in Gymnasium's order: left bottom, left top, right
/// top, right bottom.
pub const fn corners([l, b]: Point, [r, t]: Point) -> [Point; 4] {
    [[l, b], [l, t], [r, t], [r, b]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        for (quarters, expected) in [
            (0, [3.0, 1.0]),
            (1, [-1.0, 3.0]),
            (2, [-3.0, -1.0]),
            (3, [1.0, -3.0]),
            (4, [3.0, 1.0]),
        ] {
            for turn in [-2.0, 0.0, 5.0] {
                let angle = f64::from(quarters) * FRAC_PI_2 + turn * TAU;
                assert_eq!(rotate_rad([3.0, 1.0], angle), expected, "{quarters} {turn}");
            }
        }
    }
}
