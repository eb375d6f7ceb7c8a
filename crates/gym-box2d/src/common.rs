//! What the three environments share.

use gym_core::canvas::{Canvas, Color, Point, Shape};
use gym_core::pixels;

use crate::physics::{FixtureId, Vec2, World};

/// Sweeps over the velocities in a step: 6 * 30 in all of Gymnasium's three.
pub(crate) const VELOCITY_ITERATIONS: u32 = 180;
/// Sweeps over the positions in a step: 2 * 30.
pub(crate) const POSITION_ITERATIONS: u32 = 60;

/// An exception to the checks of gym-conform.
#[cfg(feature = "rapier")]
pub(crate) const RAPIER_ALLOCATES: (&str, &str) = ("no-allocation", "rapier2d allocates in its own step");

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

/// The corners of a polygon where its body is now.
pub(crate) fn corners(world: &World, fixture: FixtureId) -> ([Point; 8], usize) {
    let pose = world.pose(world.body_of(fixture));
    let vertices = world.vertices(fixture);
    let mut corners = [[0.0; 2]; 8];
    for (corner, vertex) in corners.iter_mut().zip(vertices) {
        let p = pose.rotation * vertex + pose.translation.vector;
        *corner = [f64::from(p.x), f64::from(p.y)];
    }
    (corners, vertices.len())
}

/// Fills a fixture's polygon.
pub(crate) fn draw_fixture(canvas: &mut dyn Canvas, world: &World, fixture: FixtureId, fill: Color) {
    let (corners, count) = corners(world, fixture);
    canvas.polygon(&corners[..count], fill);
}

/// Fills a fixture's polygon on a canvas in pixels, so many of them per m, and outlines it. pygame does
/// the same with whole pixels, or with an outline that is not cut to them.
pub(crate) fn draw_outlined(
    canvas: &mut dyn Canvas,
    world: &World,
    fixture: FixtureId,
    scale: f64,
    [fill, outline]: [Color; 2],
    whole: bool,
) {
    let (mut corners, count) = corners(world, fixture);
    for corner in &mut corners {
        // Gymnasium scales in `f32`: what is whole there is whole here, before fractions are cut off
        *corner = corner.map(|x| f64::from(x as f32 * scale as f32));
        if whole {
            *corner = pixels::whole(canvas, *corner);
        }
    }
    // the outline covers what pygame fills around the corners
    canvas.polygon(&corners[..count], fill);
    canvas.stroke(Shape::Polygon(&corners[..count]), 1.0, outline);
}
