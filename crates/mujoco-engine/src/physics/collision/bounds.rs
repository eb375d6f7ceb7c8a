//! A last test before two geoms may touch: the boxes around them, and around groups of geoms of
//! their bodies, must meet.
//!
//! For bodies with several geoms, MuJoCo compares the boxes before it computes contacts:
//! `mj_collideOBB`. Where geoms touch, only rounding can separate their boxes. So the test runs
//! only if all contacts are within rounding of the margin.

use super::Shape;
use crate::Model;
use crate::math::MAXVAL;
use crate::math::spatial::{Mat3, Vec3, add, column, dot, rotate};
use crate::model::Pair;
use crate::model::bounds::{Bounds, bounding_box, meetings};

/// If a contact is deeper below the margin than this, rounding cannot drop the contact, although a
/// plane's box has sides of 1e10.
pub(in crate::physics) const ROUNDING: f64 = 1e-5;

/// A frame: its origin and axes.
pub(in crate::physics) type Frame = (Vec3, Mat3);

/// Whether boxes separate two geoms; `inertial` returns the inertial frame of a body.
pub(super) fn apart(
    m: &Model,
    pair: &Pair,
    shapes: [Shape<'_>; 2],
    inertial: impl Fn(usize) -> Frame,
) -> bool {
    let around = pair.geom.map(|g| bounding_box(m, g));
    let alone = [0, 1].map(|k| {
        let axes = [0, 1, 2].map(|axis| column(shapes[k].mat, axis));
        let centre = add(rotate(shapes[k].mat, around[k][0]), shapes[k].pos);
        (around[k][1], axes, centre)
    });
    let reach = |k: usize, normal: Vec3| {
        let (half, axes, centre) = alone[k];
        let part = |i: usize| (half[i] * dot(axes[i], normal)).abs();
        (dot(centre, normal), part(0) + part(1) + part(2))
    };
    separated(
        [&around[0][1], &around[1][1]],
        alone.map(|(_, axes, _)| axes),
        pair.margin,
        reach,
    ) || groups_apart(m, pair, inertial)
}

/// Whether boxes around groups of geoms separate the two geoms of a pair.
fn groups_apart(m: &Model, pair: &Pair, inertial: impl Fn(usize) -> Frame) -> bool {
    let (mut geoms, mut bodies) = (pair.geom, pair.geom.map(|g| m.geom_bodyid[g]));
    if bodies[0] > bodies[1] {
        geoms.reverse();
        bodies.reverse();
    }
    let trees = bodies.map(|body| &m.plan().bounds[body]);
    let margin = trees[0].margin + trees[1].margin;
    let frames = bodies.map(inertial);
    let axes = [0, 1].map(|k| [0, 1, 2].map(|axis| column(&frames[k].1, axis)));
    meetings(trees, geoms).any(|boxes: [&Bounds; 2]| {
        let reach = |k: usize, normal: Vec3| {
            let [centre, half] = boxes[k];
            let along = axes[k].map(|axis| dot(axis, normal));
            let part = |i: usize| (half[i] * along[i]).abs();
            let place = centre[0] * along[0] + centre[1] * along[1] + centre[2] * along[2];
            (
                place + dot(frames[k].0, normal),
                part(0) + part(1) + part(2),
            )
        };
        separated([&boxes[0][1], &boxes[1][1]], axes, margin, reach)
    })
}

/// Whether one of the six face normals of two boxes separates them by more than the margin. `reach`
/// returns the position of a box along a normal, and its half width there.
fn separated(
    halves: [&Vec3; 2],
    axes: [[Vec3; 3]; 2],
    margin: f64,
    reach: impl Fn(usize, Vec3) -> (f64, f64),
) -> bool {
    let endless = halves.map(|half| half.map(|half| half >= MAXVAL));
    if endless.contains(&[true; 3]) {
        return false;
    }
    (0..2).filter(|&k| endless[1 - k] == [false; 3]).any(|k| {
        axes[k].into_iter().any(|normal| {
            let (a, b) = (reach(0, normal), reach(1, normal));
            a.1 + b.1 + margin < (b.0 - a.0).abs()
        })
    })
}
