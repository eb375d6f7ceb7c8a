//! A capsule and a cylinder: MuJoCo's `mjc_Convex`. The distance of the capsule's axis from the
//! cylinder tells a contact, as long as the axis does not enter the cylinder; then the whole
//! capsule is taken out of it.

use super::super::spatial::{
    MINVAL, Mat3, Vec3, add, add_scaled, axis_angle, column, dot, norm, normalize, quat_to_mat,
    rotate, rotate_back, scale, sub,
};
use super::epa::Polytope;
use super::gjk::{self, Vertex};
use super::{Hit, Shape, frame};

/// By how much the shapes are turned to find further contacts, in radians.
const TURN: f64 = 1e-3;

/// Most contacts of the two shapes.
const MOST: usize = 5;

/// The contact of the two shapes, and up to four more, found with the shapes turned a little about
/// it, as far as they are `apart` from those found before.
pub(super) fn capsule_cylinder(
    a: Shape<'_>,
    b: Shape<'_>,
    margin: f64,
    apart: f64,
    polytope: &mut Polytope,
    push: &mut impl FnMut(Hit),
) {
    let Some(first) = one(a, b, margin, polytope) else {
        return;
    };
    push(first);
    let mut kept = [first.pos; MOST];
    let mut number = 1;
    let frame = frame(first.normal, [0.0; 3]);
    for tangent in [
        [frame[3], frame[4], frame[5]],
        [frame[6], frame[7], frame[8]],
    ] {
        for angle in [-TURN, TURN] {
            let turn = quat_to_mat(axis_angle(tangent, angle));
            let back = std::array::from_fn(|k| turn[3 * (k % 3) + k / 3]);
            let (a_pos, a_mat) = turned(a, first.pos, &turn);
            let (b_pos, b_mat) = turned(b, first.pos, &back);
            let turned = one(
                Shape {
                    pos: a_pos,
                    mat: &a_mat,
                    ..a
                },
                Shape {
                    pos: b_pos,
                    mat: &b_mat,
                    ..b
                },
                margin,
                polytope,
            );
            if let Some(hit) = turned.filter(|hit| {
                kept[..number]
                    .iter()
                    .all(|&pos| norm(sub(pos, hit.pos)) > apart)
            }) {
                push(Hit {
                    dist: first.dist,
                    ..hit
                });
                kept[number] = hit.pos;
                number += 1;
            }
        }
    }
}

/// Position and orientation of a shape turned about a point.
fn turned(shape: Shape<'_>, about: Vec3, turn: &Mat3) -> (Vec3, Mat3) {
    let columns = [0, 1, 2].map(|k| rotate(turn, column(shape.mat, k)));
    let offset = sub(about, shape.pos);
    let moved = sub(rotate(turn, offset), offset);
    (
        sub(shape.pos, moved),
        std::array::from_fn(|k| columns[k % 3][k / 3]),
    )
}

fn one(
    capsule: Shape<'_>,
    cylinder: Shape<'_>,
    margin: f64,
    polytope: &mut Polytope,
) -> Option<Hit> {
    let grown = 0.5 * margin;
    let grow = |point: Vec3, direction: Vec3| {
        if grown > 0.0 {
            add_scaled(point, direction, grown)
        } else {
            point
        }
    };
    let rim = |direction: Vec3| grow(cylinder_support(cylinder, direction), direction);
    let hit = |dist: f64, [w1, w2]: [Vec3; 2]| {
        let pos = scale(add(w1, w2), 0.5);
        Hit {
            dist: margin + dist,
            pos,
            normal: normalize(sub(w1, w2)).0,
            tangent: [0.0; 3],
        }
    };

    let centers = [capsule.pos, cylinder.pos];
    let reach = capsule.size[0] + grown;
    let axis = |direction: Vec3| {
        Vertex::new(
            line_support(capsule, direction),
            rim(scale(direction, -1.0)),
        )
    };
    let found = gjk::distance(centers, reach, &axis);
    if found.distance > gjk::TOLERANCE {
        let [w1, w2] = found.nearest;
        let dist = found.distance - reach;
        let normal = normalize(sub(w2, w1)).0;
        return (dist < 0.0).then(|| hit(dist, [add_scaled(w1, normal, reach), w2]));
    }

    let whole = |direction: Vec3| {
        let near = grow(capsule_support(capsule, direction), direction);
        Vertex::new(near, rim(scale(direction, -1.0)))
    };
    let found = gjk::distance(centers, 0.0, &whole);
    if found.distance > gjk::TOLERANCE || found.separated {
        return None;
    }
    let (nearest, depth) = polytope.overlap(&found, &whole)?;
    (depth > 0.0).then(|| hit(-depth, nearest))
}

/// The point of a capsule's axis furthest in a direction.
fn line_support(capsule: Shape<'_>, direction: Vec3) -> Vec3 {
    let (axis, half) = (capsule.axis(), capsule.size[1]);
    add_scaled(
        capsule.pos,
        axis,
        if dot(axis, direction) >= 0.0 {
            half
        } else {
            -half
        },
    )
}

/// The point of a capsule furthest in a direction.
fn capsule_support(capsule: Shape<'_>, direction: Vec3) -> Vec3 {
    let &[radius, half, _] = capsule.size;
    let local = rotate_back(capsule.mat, direction);
    let mut point = scale(local, radius);
    point[2] += if local[2] >= 0.0 { half } else { -half };
    add(rotate(capsule.mat, point), capsule.pos)
}

/// The point of a cylinder furthest in a direction.
fn cylinder_support(cylinder: Shape<'_>, direction: Vec3) -> Vec3 {
    let &[radius, half, _] = cylinder.size;
    let local = rotate_back(cylinder.mat, direction);
    let square = local[0] * local[0] + local[1] * local[1];
    let s = if square >= MINVAL * MINVAL {
        radius / square.sqrt()
    } else {
        0.0
    };
    let point = [
        s * local[0],
        s * local[1],
        if local[2] >= 0.0 { half } else { -half },
    ];
    add(rotate(cylinder.mat, point), cylinder.pos)
}
