//! What the three environments share.

use gym_core::canvas::{Canvas, Color, Point, Primitive};
use gym_core::{Error, Result};

use crate::physics::{FixtureId, Vec2, World};

/// Sweeps over the velocities in a step: 6 * 30 in all of Gymnasium's three.
pub(crate) const VELOCITY_ITERATIONS: u32 = 180;
/// Sweeps over the positions in a step: 2 * 30.
pub(crate) const POSITION_ITERATIONS: u32 = 60;

/// An exception to the checks of gym-conform.
#[cfg(feature = "rapier")]
pub(crate) const RAPIER_ALLOCATES: (&str, &str) = ("no-allocation", "rapier2d allocates in its own step");

/// The rules of a version of `env`: those of 3 hold for later ones too.
///
/// # Errors
/// [`Error::InvalidArgument`] for a version that never was.
pub(crate) fn version(env: &str, version: u32) -> Result<u32> {
    match version {
        0 | 1 => {
            let reason =
                format!("there is no version {version} of it: set 2 or 3 with `Registration::version`");
            Err(Error::argument(env, reason))
        }
        _ => Ok(version.min(3)),
    }
}

/// A vector of the world from numbers of the environment, rounded as they pass.
pub(crate) fn vec2(x: f64, y: f64) -> Vec2 {
    Vec2::new(x as f32, y as f32)
}

/// Points of the world from numbers of the environment, each changed by `f`.
pub(crate) fn points(points: &[[f64; 2]], f: impl Fn(f64) -> f64) -> Vec<Vec2> {
    points.iter().map(|[x, y]| vec2(f(*x), f(*y))).collect()
}

/// numpy's `sign`: 0 for 0.
pub(crate) fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

/// As many corners as a polygon has, and one for the first again.
const MOST_CORNERS: usize = 9;

/// The corners of a polygon where its body is now.
pub(crate) fn corners(world: &World, fixture: FixtureId) -> ([Point; MOST_CORNERS], usize) {
    let pose = world.pose(world.body_of(fixture));
    let vertices = world.vertices(fixture);
    let mut corners = [[0.0; 2]; MOST_CORNERS];
    for (corner, vertex) in corners.iter_mut().zip(vertices) {
        let p = pose.rotation * vertex + pose.translation.vector;
        *corner = [f64::from(p.x), f64::from(p.y)];
    }
    (corners, vertices.len())
}

/// The corners of a polygon in pixels, so many of them per m. Gymnasium scales in `f32`.
pub(crate) fn pixel_corners(world: &World, fixture: FixtureId, scale: f64) -> ([Point; MOST_CORNERS], usize) {
    let (corners, count) = corners(world, fixture);
    (corners.map(|corner| corner.map(|x| f64::from(x as f32 * scale as f32))), count)
}

/// `draw.polygon` and `gfxdraw.aapolygon`, which Gymnasium calls together.
pub(crate) fn draw_polygon(canvas: &mut dyn Canvas, points: &[Point], color: Color) {
    canvas.pygame(Primitive::Polygon(points), color);
    canvas.pygame(Primitive::AaPolygon(points), color);
}
