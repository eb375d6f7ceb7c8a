//! A capsule and a cylinder: the distance of the capsule's axis from the cylinder, by GJK; where the axis enters the cylinder,
//! the least translation that takes it out, directly.

use std::f64::consts::{PI, TAU};

use super::super::spatial::{
    MINVAL, Mat3, Vec3, add, add_scaled, axis_angle, column, cross, dot, norm, normalize, quat_to_mat,
    rotate, rotate_back, scale, sub,
};
use super::gjk::{self, Distance};
use super::{Hit, Shape, frame};
use crate::libm;

/// By how much the shapes are turned to find further contacts, in radians.
const TURN: f64 = 1e-3;

/// Most contacts of the two shapes.
const MOST: usize = 5;

/// The contact of the two shapes, and up to four more, found with the shapes turned a little about it, as far as they are
/// `apart` from those found before.
pub(super) fn capsule_cylinder(
    a: Shape<'_>,
    b: Shape<'_>,
    margin: f64,
    apart: f64,
    push: &mut impl FnMut(Hit),
) {
    let Some(first) = one(a, b, margin) else { return };
    push(first);
    let mut kept = [first.pos; MOST];
    let mut number = 1;
    let frame = frame(first.normal, [0.0; 3]);
    for tangent in [[frame[3], frame[4], frame[5]], [frame[6], frame[7], frame[8]]] {
        for angle in [-TURN, TURN] {
            let (a_pos, a_mat) = turned(a, first.pos, tangent, angle);
            let (b_pos, b_mat) = turned(b, first.pos, tangent, -angle);
            let turned =
                one(Shape { pos: a_pos, mat: &a_mat, ..a }, Shape { pos: b_pos, mat: &b_mat, ..b }, margin);
            if let Some(hit) =
                turned.filter(|hit| kept[..number].iter().all(|&pos| norm(sub(hit.pos, pos)) > apart))
            {
                push(Hit { dist: first.dist, ..hit });
                kept[number] = hit.pos;
                number += 1;
            }
        }
    }
}

/// Position and orientation of a shape turned about a point.
fn turned(shape: Shape<'_>, about: Vec3, axis: Vec3, angle: f64) -> (Vec3, Mat3) {
    let turn = quat_to_mat(axis_angle(axis, angle));
    let columns = [0, 1, 2].map(|k| rotate(&turn, column(shape.mat, k)));
    (add(about, rotate(&turn, sub(shape.pos, about))), std::array::from_fn(|k| columns[k % 3][k / 3]))
}

fn one(capsule: Shape<'_>, cylinder: Shape<'_>, margin: f64) -> Option<Hit> {
    let grown = 0.5 * margin;
    let reach = capsule.size[0] + grown;
    let (axis, half) = (capsule.axis(), capsule.size[1]);
    let segment_end = |direction: Vec3| {
        let end = if dot(direction, axis) >= 0.0 { half } else { -half };
        add_scaled(capsule.pos, axis, end)
    };
    let rim = |direction: Vec3| {
        let local = rotate_back(cylinder.mat, direction);
        add_scaled(
            add(cylinder.pos, rotate(cylinder.mat, cylinder_support(cylinder, local))),
            direction,
            grown,
        )
    };
    let (w1, w2) = match gjk::distance(sub(capsule.pos, cylinder.pos), reach, segment_end, rim) {
        Distance::Beyond => return None,
        Distance::Apart(w1, w2) => (w1, w2),
        Distance::Within => return Some(within(capsule, cylinder, margin)),
    };
    let (normal, distance) = normalize(sub(w2, w1));
    let depth = distance - reach;
    (depth < 0.0).then(|| Hit {
        dist: margin + depth,
        pos: scale(add(add_scaled(w1, normal, reach), w2), 0.5),
        normal,
        tangent: [0.0; 3],
    })
}

/// The point of a cylinder furthest in a direction, both in the cylinder's frame.
fn cylinder_support(cylinder: Shape<'_>, direction: Vec3) -> Vec3 {
    let &[radius, half, _] = cylinder.size;
    let length = (direction[0] * direction[0] + direction[1] * direction[1]).sqrt();
    let s = if length > MINVAL { radius / length } else { 0.0 };
    [direction[0] * s, direction[1] * s, if direction[2] >= 0.0 { half } else { -half }]
}

/// The contact of a capsule whose axis enters the cylinder.
///
/// The axis is a segment with centre `c`, half length `h` and direction `a` in the cylinder's frame. Moving it along a unit
/// vector `n` until it leaves takes `depth(n) = s(n) - n.c + h |n.a|`, where `s` is how far the cylinder reaches. The least
/// depth is found where `n` is the axis of the cylinder, or points from it to an end of the segment, or is at right angles to
/// the segment (an edge against a side or a rim), which leaves one angle to be searched.
fn within(capsule: Shape<'_>, cylinder: Shape<'_>, margin: f64) -> Hit {
    let c = rotate_back(cylinder.mat, sub(capsule.pos, cylinder.pos));
    let a = rotate_back(cylinder.mat, capsule.axis());
    let half = capsule.size[1];
    let depth = |n: Vec3| dot(cylinder_support(cylinder, n), n) - dot(n, c) + half * dot(n, a).abs();

    let mut best = (f64::MAX, [0.0, 0.0, 1.0]);
    let mut consider = |n: Vec3| {
        let depth = depth(n);
        if depth < best.0 {
            best = (depth, n);
        }
    };
    consider([0.0, 0.0, 1.0]);
    consider([0.0, 0.0, -1.0]);
    for end in [add_scaled(c, a, half), add_scaled(c, a, -half)] {
        consider(normalize([end[0], end[1], 0.0]).0);
    }
    // two directions at right angles to the segment, the first at right angles to the cylinder's axis too
    let (u, sine) = normalize([-a[1], a[0], 0.0]);
    let u = if sine < MINVAL { [1.0, 0.0, 0.0] } else { u };
    let v = cross(a, u);
    let around = |angle: f64| {
        let (sin, cos) = libm::sin_cos(angle);
        add_scaled(scale(u, cos), v, sin)
    };
    for angle in [0.0, PI, least(|angle| depth(around(angle)))] {
        consider(around(angle));
    }

    let (depth, n) = best;
    let (near, far) = meeting(cylinder, c, a, half, n, depth);
    let reach = capsule.size[0] + 0.5 * margin;
    let middle = scale(add(add_scaled(near, n, -reach), add_scaled(far, n, 0.5 * margin)), 0.5);
    Hit {
        dist: -(depth + capsule.size[0]),
        pos: add(cylinder.pos, rotate(cylinder.mat, middle)),
        normal: scale(rotate(cylinder.mat, n), -1.0),
        tangent: [0.0; 3],
    }
}

/// The angle at which a function of period 2 pi is least: the best of many, then by golden section.
fn least(f: impl Fn(f64) -> f64) -> f64 {
    const MANY: usize = 64;
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let step = TAU / MANY as f64;
    let start = (0..MANY).map(|k| k as f64 * step).fold((0.0, f64::MAX), |best, angle| {
        let value = f(angle);
        if value < best.1 { (angle, value) } else { best }
    });
    let (mut low, mut high) = (start.0 - step, start.0 + step);
    for _ in 0..80 {
        let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if f(a) < f(b) {
            high = b;
        } else {
            low = a;
        }
    }
    0.5 * (low + high)
}

/// The point of the segment that leaves the cylinder last, and the point of the cylinder that it touches then.
fn meeting(cylinder: Shape<'_>, c: Vec3, a: Vec3, half: f64, n: Vec3, depth: f64) -> (Vec3, Vec3) {
    const FLAT: f64 = 1e-9;
    let slope = dot(n, a);
    let along = if slope.abs() > FLAT {
        if slope > 0.0 { -half } else { half }
    } else if n[2].abs() > FLAT {
        // a point of the rim
        dot(a, sub(cylinder_support(cylinder, n), c)).clamp(-half, half)
    } else {
        // a line of the side
        let side = [-n[1], n[0], 0.0];
        let across = dot(a, side);
        if across.abs() > FLAT { (-dot(c, side) / across).clamp(-half, half) } else { 0.0 }
    };
    let near = add_scaled(c, a, along);
    (near, add_scaled(near, n, depth))
}
