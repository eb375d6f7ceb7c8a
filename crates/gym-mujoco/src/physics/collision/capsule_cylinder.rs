//! A capsule and a cylinder: MuJoCo's `mjc_Convex`. The distance of the capsule's axis from the
//! cylinder tells a contact, as long as the axis does not enter the cylinder; then the whole
//! capsule is taken out of it.

use super::super::spatial::{
    InTurn, MINVAL, Mat3, Order, Vec3, add, add_scaled, axis_angle, column, dot, norm, normalize,
    rotate, rotate_back, scale, sub,
};
use super::epa::Polytope;
use super::gjk::{self, Vertex};
use super::{Hit, Shape, frame, on_end};
use crate::Revision;

/// By how much the shapes are turned to find further contacts, in radians.
const TURN: f64 = 1e-3;

/// Most contacts of the two shapes.
const MOST: usize = 5;

/// The contacts of the two shapes: the revision's routine.
pub(super) fn capsule_cylinder(
    a: Shape<'_>,
    b: Shape<'_>,
    margin: f64,
    apart: f64,
    (revision, polytope): (Revision, &mut Polytope),
    push: &mut impl FnMut(Hit),
) {
    match revision {
        Revision::V3_12 => contacts_3_12(a, b, margin, apart, polytope, push),
        Revision::V4_0 => contacts_4_0(a, b, margin, polytope, push),
    }
}

/// From 4.0 on: the contact of the two shapes; or, where the capsule lies on an end of the
/// cylinder, the two furthest apart along its axis.
fn contacts_4_0(
    capsule: Shape<'_>,
    cylinder: Shape<'_>,
    margin: f64,
    polytope: &mut Polytope,
    push: &mut impl FnMut(Hit),
) {
    let Some(touch) = one(capsule, cylinder, margin, Revision::V4_0, polytope) else {
        return;
    };
    let line = on_end::line(capsule, cylinder, 0.5 * margin, &touch, polytope);
    let first = line.is_none().then_some(touch);
    for touch in first.into_iter().chain(line.into_iter().flatten()) {
        push(touch.hit(margin));
    }
}

/// Before 4.0: the contact of the two shapes, and up to four more, found with the shapes turned a
/// little about it, as far as they are `apart` from those found before.
fn contacts_3_12(
    a: Shape<'_>,
    b: Shape<'_>,
    margin: f64,
    apart: f64,
    polytope: &mut Polytope,
    push: &mut impl FnMut(Hit),
) {
    let mut one = |a: Shape<'_>, b: Shape<'_>| {
        one(a, b, margin, Revision::V3_12, polytope).map(|touch| touch.hit(margin))
    };
    let Some(first) = one(a, b) else {
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
            let turn = InTurn::quat_to_mat(axis_angle((), tangent, angle));
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

/// The deepest points of the two shapes.
fn one(
    capsule: Shape<'_>,
    cylinder: Shape<'_>,
    margin: f64,
    revision: Revision,
    polytope: &mut Polytope,
) -> Option<Touch> {
    let grown = 0.5 * margin;
    let grow = |point: Vec3, direction: Vec3| {
        if grown > 0.0 {
            add_scaled(point, direction, grown)
        } else {
            point
        }
    };
    let rim = |direction: Vec3| {
        let (point, low) = cylinder_support(cylinder, direction);
        (grow(point, direction), low)
    };

    let centers = [capsule.pos, cylinder.pos];
    // from 4.0 on, the capsule's axis meets a cylinder that has not grown
    let (reach, grown_after) = match revision {
        Revision::V3_12 => (capsule.size[0] + grown, 0.0),
        Revision::V4_0 => (grown + capsule.size[0], grown),
    };
    let axis = |direction: Vec3| {
        let back = scale(direction, -1.0);
        let other = match revision {
            Revision::V3_12 => rim(back),
            Revision::V4_0 => cylinder_support(cylinder, back),
        };
        Vertex::new(line_support(capsule, direction), other)
    };
    let found = gjk::distance(centers, reach + grown_after, revision, &axis);
    if found.distance > gjk::TOLERANCE {
        let [w1, w2] = found.nearest;
        let dist = found.distance - (reach + grown_after);
        let normal = normalize(sub(w2, w1)).0;
        let w2 = match revision {
            Revision::V3_12 => w2,
            Revision::V4_0 => add_scaled(w2, normal, -grown_after),
        };
        return (dist < 0.0).then(|| Touch {
            dist,
            points: [add_scaled(w1, normal, reach), w2],
            low: end(&found.simplex[..found.number]),
        });
    }

    let whole = |direction: Vec3| {
        let near = grow(capsule_support(capsule, direction), direction);
        Vertex::new(near, rim(scale(direction, -1.0)))
    };
    let found = gjk::distance(centers, 0.0, revision, &whole);
    if found.distance > gjk::TOLERANCE || found.separated {
        return None;
    }
    let overlap = polytope.overlap(&found, revision, &whole)?;
    (overlap.depth > 0.0).then(|| Touch {
        dist: -overlap.depth,
        points: overlap.nearest,
        low: end(&overlap.corners),
    })
}

/// Whether the points of all vertices but the last of four are on the lower end of the cylinder;
/// `None` where they are on both.
fn end(simplex: &[Vertex]) -> Option<bool> {
    let last = simplex.len() - 1;
    let [a, b, c] = [0, 1, 2].map(|i| simplex[i.min(last)].low);
    (a == b && b == c).then_some(a)
}

/// The deepest points of two shapes.
#[derive(Clone, Copy)]
pub(super) struct Touch {
    /// Their distance, without the margin.
    pub(super) dist: f64,
    pub(super) points: [Vec3; 2],
    /// Whether they are on the lower end of the cylinder, if they are on one of the ends.
    pub(super) low: Option<bool>,
}

impl Touch {
    fn hit(&self, margin: f64) -> Hit {
        let [w1, w2] = self.points;
        Hit {
            dist: margin + self.dist,
            pos: scale(add(w1, w2), 0.5),
            normal: normalize(sub(w1, w2)).0,
            tangent: [0.0; 3],
        }
    }
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

/// The point of a cylinder furthest in a direction, and whether it is on the lower end.
fn cylinder_support(cylinder: Shape<'_>, direction: Vec3) -> (Vec3, bool) {
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
    (
        add(rotate(cylinder.mat, point), cylinder.pos),
        point[2] < 0.0,
    )
}
