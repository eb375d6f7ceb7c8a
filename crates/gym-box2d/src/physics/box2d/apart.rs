//! A cheap test of whether a moving shape certainly stays away from a static shape. It makes most
//! computations of a time of impact unnecessary.

use super::math::{Vec2, cross_one, dot, max, min, normalize, transform, vec2};
use super::settings::LINEAR_SLOP;
use super::shape::MAX_VERTICES;
use super::time_of_impact::Moving;

/// The margin between the bound of [`stays_away`] and the distance at which
/// [`time_of_impact`](super::time_of_impact) reports an impact. The margin is far larger than
/// rounding errors.
const MARGIN: f32 = 0.5 * LINEAR_SLOP;
/// The largest rotation within a step that the test handles, in rad.
const MAX_TURN: f32 = 0.5;

/// Whether `ground` is at the origin and a separating axis keeps `moving` further away than `reach`
/// during the whole motion of `moving`. If so,
/// [`time_of_impact`](super::time_of_impact::time_of_impact) returns `None`. `reach` is the
/// distance at which the shapes count as touching.
pub(crate) fn stays_away(ground: &Moving<'_>, moving: &Moving<'_>, reach: f32) -> bool {
    let still = &ground.sweep;
    let zero = Vec2::zeros();
    if [still.c0, still.c, still.local_center] != [zero; 3] || [still.a0, still.a] != [0.0; 2] {
        return false;
    }
    let sweep = &moving.sweep;
    let turn = sweep.a - sweep.a0;
    if turn.abs() >= MAX_TURN {
        return false;
    }
    let (start, end) = (sweep.pose(0.0), sweep.pose(1.0));
    let mut radius2: f32 = 0.0;
    let mut ends = [zero; 2 * MAX_VERTICES];
    let vertices = moving.shape.vertices();
    for (vertex, ends) in vertices.iter().zip(ends.as_chunks_mut().0) {
        let lever = vertex - sweep.local_center;
        radius2 = radius2.max(dot(lever, lever));
        *ends = [transform(&start, *vertex), transform(&end, *vertex)];
    }
    let ends = &ends[..2 * vertices.len()];
    // a vertex moves along an arc: the arc's sagitta is the largest deviation from its chord
    let gap = reach + MARGIN + radius2.sqrt() * turn * turn / 8.0;
    let ground = ground.shape.vertices();
    let apart = |axis: Vec2| {
        let ((low, high), (moving_low, moving_high)) = (range(ground, axis), range(ends, axis));
        moving_low - high > gap || low - moving_high > gap
    };
    apart(vec2(0.0, 1.0))
        || apart(vec2(1.0, 0.0))
        || matches!(*ground, [a, b, ..] if apart(normalize(cross_one(b - a)).0))
}

/// Returns the least and the greatest projection of `points` onto `axis`.
fn range(points: &[Vec2], axis: Vec2) -> (f32, f32) {
    points
        .iter()
        .fold((f32::MAX, f32::MIN), |(low, high), point| {
            let x = dot(axis, *point);
            (min(low, x), max(high, x))
        })
}
