//! A last test before two geoms may touch: the boxes around them, and around groups of geoms of
//! their bodies, must meet.
//!
//! For bodies with several geoms, MuJoCo compares the boxes before it computes contacts:
//! `mj_collideOBB`. Where geoms touch, only rounding can separate their boxes. So the test runs
//! only if all contacts are within rounding of the margin.

use super::Shape;
use crate::Model;
use crate::math::MAXVAL;
use crate::math::number::Number;
use crate::math::spatial::{Mat3, Vec3, add, column, dot, norm, rotate, rotate_back, sub};
use crate::model::bounds::{Bounds, bounding_box, meetings};
use crate::model::{GeomType, Pair};

/// If a contact is deeper below the margin than this, rounding cannot drop the contact, although a
/// plane's box has sides of 1e10.
pub(in crate::physics) const ROUNDING: f64 = 1e-5;

/// A frame: its origin and axes.
pub(in crate::physics) type Frame = (Vec3, Mat3);

/// For each of a pair of spheres and capsules: the square of the distance of the other's centre from
/// its segment, and a square above which the two have no contact, by more than rounding. `between`
/// leads from the first centre to the second, `axes` are the directions of the segments.
#[inline(always)]
pub(in crate::physics) fn from_segments<N: Number>(
    m: &Model,
    pair: &Pair,
    between: [N; 3],
    axes: [[N; 3]; 2],
) -> [(N, f64); 2] {
    const RELATIVE: f64 = 1e-9;
    // (a sphere is a capsule whose segment is a point)
    let halves = pair.geom.map(|g| match m.geom_type[g] {
        GeomType::Sphere => 0.0,
        _ => m.geom_size[g][1],
    });
    let radii = m.geom_size[pair.geom[0]][0] + m.geom_size[pair.geom[1]][0];
    let square = dot(between, between);
    [0, 1].map(
        #[inline(always)]
        |k| {
            let along = dot(between, axes[k]).abs();
            let (across, beyond) = (square - along * along, along - halves[k]);
            let [square] = N::choose(
                beyond.is_below(0.0),
                || [across],
                || [across + beyond * beyond],
            );
            let most = (radii + halves[1 - k] + pair.margin) * (1.0 + RELATIVE) + ROUNDING;
            (square, most * most)
        },
    )
}

/// Whether the boxes around two geoms are further apart than the margin, by more than rounding. The
/// geoms then have no contact, and the search for one would take much longer.
pub(super) fn far_apart(m: &Model, pair: &Pair, shapes: [Shape<'_>; 2]) -> bool {
    // what is below the tolerance of the search for the nearest points, and rounding far from the
    // origin, may make a contact
    const RELATIVE: f64 = 1e-9;
    let most = pair.margin + m.opt.ccd_tolerance + ROUNDING;
    let around = pair.geom.map(
        |g| match (m.geom_type[g], usize::try_from(m.geom_dataid[g])) {
            (GeomType::Mesh, Ok(mesh)) => m.meshes.layouts()[mesh].bounds,
            _ => bounding_box(m, g),
        },
    );
    let centre = |k: usize| add(rotate(shapes[k].mat, around[k][0]), shapes[k].pos);
    let ([_, a], [_, b]) = (around[0], around[1]);
    if pair.kind.0 == GeomType::Plane {
        let normal = shapes[0].axis();
        let along = rotate_back(shapes[1].mat, normal);
        let height = dot(normal, sub(centre(1), shapes[0].pos));
        let reach: f64 = (0..3).map(|k| (b[k] * along[k]).abs()).sum();
        return height - reach > most + RELATIVE * height.abs();
    }
    // in the frame of the first geom
    let between = sub(centre(1), centre(0));
    let margin = most + RELATIVE * norm(between);
    let place = rotate_back(shapes[0].mat, between);
    let columns = [0, 1, 2].map(|k| rotate_back(shapes[0].mat, column(shapes[1].mat, k)));
    let sizes = columns.map(|column| column.map(f64::abs));
    let on_first = |i: usize| {
        let reach = a[i] + b[0] * sizes[0][i] + b[1] * sizes[1][i] + b[2] * sizes[2][i];
        place[i].abs() > reach + margin
    };
    let on_second = |j: usize| {
        let reach = b[j] + dot(a, sizes[j]);
        dot(place, columns[j]).abs() > reach + margin
    };
    // along a direction that is orthogonal to an edge of each
    let across = |i: usize, j: usize| {
        let [i1, i2, j1, j2] = [(i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3];
        let reach = a[i1] * sizes[j][i2] + a[i2] * sizes[j][i1];
        let reach = reach + b[j1] * sizes[j2][i] + b[j2] * sizes[j1][i];
        (place[i2] * columns[j][i1] - place[i1] * columns[j][i2]).abs() > reach + margin
    };
    (0..3).any(|k| on_first(k) || on_second(k)) || (0..3).any(|i| (0..3).any(|j| across(i, j)))
}

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
