//! Points of the worlds, and polygons as Gymnasium draws them.

use gym_core::canvas::{Canvas, Color, Point, Primitive};

use crate::physics::{FixtureId, Vec2, World};

/// Makes a vector of the world from coordinates in `f64`, rounded to `f32`.
pub(crate) fn vec2(x: f64, y: f64) -> Vec2 {
    Vec2::new(x as f32, y as f32)
}

/// Makes vectors of the world from `points`, with `f` applied to each coordinate.
pub(crate) fn points(points: &[[f64; 2]], f: impl Fn(f64) -> f64) -> Vec<Vec2> {
    points.iter().map(|[x, y]| vec2(f(*x), f(*y))).collect()
}

/// numpy's `sign`, which returns 0 for 0.
pub(crate) fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

/// The most corners of a polygon, plus one for the repeated first corner.
const MOST_CORNERS: usize = 9;

/// Returns the corners of a polygon in world coordinates, and their number.
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

/// Returns the corners of a polygon in pixels, with `scale` pixels per m. Gymnasium scales in
/// `f32`.
pub(crate) fn pixel_corners(
    world: &World,
    fixture: FixtureId,
    scale: f64,
) -> ([Point; MOST_CORNERS], usize) {
    let (corners, count) = corners(world, fixture);
    (
        corners.map(|corner| corner.map(|x| f64::from(x as f32 * scale as f32))),
        count,
    )
}

/// Draws a polygon with `draw.polygon` and `gfxdraw.aapolygon`, as Gymnasium does.
pub(crate) fn draw_polygon(canvas: &mut dyn Canvas, points: &[Point], color: Color) {
    canvas.pygame(Primitive::Polygon(points), color);
    canvas.pygame(Primitive::AaPolygon(points), color);
}
