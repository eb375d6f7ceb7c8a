//! Tendons around spheres and cylinders: MuJoCo's `mju_wrap`.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::Revision;
use crate::math::libm;
use crate::math::spatial::{
    MINVAL, Mat3, Vec3, add, cross, dot, norm, normalize, rotate, rotate_back, scale, sub,
};

type Vec2 = [f64; 2];

/// A geom that a tendon wraps around.
pub(super) struct Obstacle<'a> {
    pub(super) cylinder: bool,
    pub(super) pos: Vec3,
    pub(super) mat: &'a Mat3,
    pub(super) radius: f64,
    /// The site that selects the side on which the tendon passes.
    pub(super) side: Option<Vec3>,
}

/// The length of the arc around a geom, and its two end points. `None` if the straight path does
/// not touch the geom.
pub(super) fn wrap(
    x0: Vec3,
    x1: Vec3,
    geom: &Obstacle<'_>,
    revision: Revision,
) -> Option<(f64, [Vec3; 2])> {
    let local = |x: Vec3| rotate_back(geom.mat, sub(x, geom.pos));
    let (p0, p1) = (local(x0), local(x1));
    if norm(p0) < MINVAL || norm(p1) < MINVAL {
        return None;
    }
    let axes = if geom.cylinder {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    } else {
        plane(p0, p1)
    };
    let flat = |p: Vec3| axes.map(|axis| dot(p, axis));
    let ends = [flat(p0), flat(p1)];
    let side = geom.side.map(local);
    let around = match side {
        Some(side) if norm(side) < geom.radius => inside(ends, geom.radius, revision)?,
        _ => {
            let side = side.map(|side| unit(flat(side)).map(|x| x * geom.radius));
            if revision.winds_past_side() {
                circle_by_winding(ends, side, geom.radius)?
            } else {
                circle(ends, side, geom.radius, revision)?
            }
        }
    };
    let (mut arc, points) = around;
    let mut points = points.map(|[u, v]| add(scale(axes[0], u), scale(axes[1], v)));
    if geom.cylinder {
        // on a helix, the height is proportional to the arc
        let l0 = norm([p0[0] - points[0][0], p0[1] - points[0][1], 0.0]);
        let l1 = norm([p1[0] - points[1][0], p1[1] - points[1][1], 0.0]);
        let whole = l0 + arc + l1;
        points[0][2] = p0[2] + (p1[2] - p0[2]) * l0 / whole;
        points[1][2] = p0[2] + (p1[2] - p0[2]) * (l0 + arc) / whole;
        let height = (points[1][2] - points[0][2]).abs();
        arc = (arc * arc + height * height).sqrt();
    }
    let points = points.map(|point| add(rotate(geom.mat, point), geom.pos));
    Some((arc, points))
}

/// Two axes of the plane through the centre and two points.
fn plane(p0: Vec3, p1: Vec3) -> [Vec3; 2] {
    let (first, _) = normalize(p0);
    let (mut normal, length) = normalize(cross(p0, p1));
    if length < MINVAL {
        let size = first.map(f64::abs);
        let mut i = 0;
        if size[1] > size[0] && size[1] > size[2] {
            i = 1;
        }
        if size[2] > size[0] && size[2] > size[1] {
            i = 2;
        }
        let mut other = [1.0; 3];
        other[i] = 0.0;
        normal = normalize(cross(first, other)).0;
    }
    [first, normalize(cross(normal, first)).0]
}

fn dot2(a: Vec2, b: Vec2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// `v` scaled to length 1: MuJoCo's `mju_normalize`.
fn unit(v: Vec2) -> Vec2 {
    let length = dot2(v, v).sqrt();
    if length < MINVAL {
        return [1.0, 0.0];
    }
    let inverse = 1.0 / length;
    v.map(|x| x * inverse)
}

/// Whether two segments in the plane cross.
fn cross_each_other(p1: Vec2, p2: Vec2, p3: Vec2, p4: Vec2) -> bool {
    let det = (p4[1] - p3[1]) * (p2[0] - p1[0]) - (p4[0] - p3[0]) * (p2[1] - p1[1]);
    if det.abs() < MINVAL {
        return false;
    }
    let a = ((p4[0] - p3[0]) * (p1[1] - p3[1]) - (p4[1] - p3[1]) * (p1[0] - p3[0])) / det;
    let b = ((p2[0] - p1[0]) * (p1[1] - p3[1]) - (p2[1] - p1[1]) * (p1[0] - p3[0])) / det;
    (0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b)
}

/// The point between the ends that is nearest to the centre of a circle; `None` if an end is inside
/// the circle, or if there is no circle or no distance between the ends.
fn nearest_to_center([e0, e1]: [Vec2; 2], radius: f64) -> Option<Vec2> {
    let square = radius * radius;
    let (q0, q1) = (dot2(e0, e0), dot2(e1, e1));
    if q0 < square || q1 < square || radius < MINVAL {
        return None;
    }
    let dif = [e1[0] - e0[0], e1[1] - e0[1]];
    let dd = dot2(dif, dif);
    if dd < MINVAL {
        return None;
    }
    let a = (-dot2(dif, e0) / dd).clamp(0.0, 1.0);
    Some([a * dif[0] + e0[0], a * dif[1] + e0[1]])
}

/// The arc around the outside of a circle.
fn circle(
    ends: [Vec2; 2],
    side: Option<Vec2>,
    radius: f64,
    revision: Revision,
) -> Option<(f64, [Vec2; 2])> {
    let [e0, e1] = ends;
    let nearest = nearest_to_center(ends, radius)?;
    if dot2(nearest, nearest) > radius * radius
        && side.is_none_or(|side| dot2(side, nearest) >= 0.0)
    {
        return None;
    }
    let solutions = tangents(ends, radius);
    let good = solutions.map(|[s0, s1]| {
        if cross_each_other(e0, s0, e1, s1) {
            return -10000.0;
        }
        match side {
            Some(side) => dot2(unit([s0[0] + s1[0], s0[1] + s1[1]]), side),
            None => {
                let apart = [s0[0] - s1[0], s0[1] - s1[1]];
                -dot2(apart, apart)
            }
        }
    });
    let second = good[0] <= good[1];
    let points = solutions[usize::from(second)];
    if cross_each_other(e0, points[0], e1, points[1]) {
        return None;
    }
    let arc = if revision.turns_by_arc_tangents() {
        radius * arc_angle(points, second)
    } else {
        arc_length(points, second, radius)
    };
    Some((arc, points))
}

/// For both sides: the points where the tangents from the two end points touch the circle.
fn tangents([e0, e1]: [Vec2; 2], radius: f64) -> [[Vec2; 2]; 2] {
    let square = radius * radius;
    let (q0, q1) = (dot2(e0, e0), dot2(e1, e1));
    let (r0, r1) = ((q0 - square).sqrt(), (q1 - square).sqrt());
    [1.0, -1.0].map(|sign| {
        [
            [
                (e0[0] * square + sign * radius * e0[1] * r0) / q0,
                (e0[1] * square - sign * radius * e0[0] * r0) / q0,
            ],
            [
                (e1[0] * square - sign * radius * e1[1] * r1) / q1,
                (e1[1] * square + sign * radius * e1[0] * r1) / q1,
            ],
        ]
    })
}

/// The angle from one vector to another.
fn angle(from: Vec2, to: Vec2) -> f64 {
    let across = from[0] * to[1] - from[1] * to[0];
    libm::atan2(across, dot2(from, to))
}

/// Whether the two tangent segments, each from an end point to the circle, cross; from 4.0 on.
fn segments_cross(e0: Vec2, s0: Vec2, e1: Vec2, s1: Vec2) -> bool {
    let minus = |a: Vec2, b: Vec2| [a[0] - b[0], a[1] - b[1]];
    let across = |a: Vec2, b: Vec2| a[0] * b[1] - a[1] * b[0];
    let (d0, d1) = (minus(s0, e0), minus(s1, e1));
    let det = d0[0] * d1[1] - d1[0] * d0[1];
    if det.abs() < MINVAL {
        return false;
    }
    let sign = if det > 0.0 { 1.0 } else { -1.0 };
    let (ends, touches) = (minus(e0, e1), minus(s0, s1));
    across(d1, touches) * sign < 0.0
        && across(d0, ends) * sign >= 0.0
        && across(d1, ends) * sign >= 0.0
        && across(d0, touches) * sign < 0.0
}

/// The arc around the outside of a circle, from 4.0 on. The tendon winds around the circle in the
/// same direction as the path through `side`.
fn circle_by_winding(ends: [Vec2; 2], side: Option<Vec2>, radius: f64) -> Option<(f64, [Vec2; 2])> {
    let [e0, e1] = ends;
    let nearest = nearest_to_center(ends, radius)?;
    let free = dot2(nearest, nearest) > radius * radius;
    // the angle about the centre that the path through `side` winds
    let winding = side.map(|side| angle(side, e1) + angle(e0, side));
    match winding {
        None if free => return None,
        Some(winding) if free && (winding - angle(e0, e1)).abs() < PI => return None,
        _ => {}
    }
    let solutions = tangents(ends, radius);
    let good = solutions.map(|[s0, s1]| {
        if segments_cross(e0, s0, e1, s1) {
            return -10000.0;
        }
        let apart = [s0[0] - s1[0], s0[1] - s1[1]];
        -dot2(apart, apart)
    });
    let second = winding.map_or(good[0] <= good[1], |winding| winding > 0.0);
    let points = solutions[usize::from(second)];
    let [p0, p1] = points;
    if segments_cross(e0, p0, e1, p1) {
        return None;
    }
    let turned = if let Some(winding) = winding {
        ((winding - angle(e0, p0)) - angle(p1, e1)).abs()
    } else {
        arc_angle(points, second)
    };
    Some((turned * radius, points))
}

/// The angle of an arc from `p0` to `p1`, in the direction that `second` selects, from 3.17 on.
fn arc_angle([p0, p1]: [Vec2; 2], second: bool) -> f64 {
    const LEAST: f64 = 1e-6;
    let turn = p0[1] * p1[0] - p0[0] * p1[1];
    let least = libm::atan2(turn.abs(), dot2(p0, p1));
    let around = (turn < 0.0 && !second) || (turn > 0.0 && second);
    if around && least > LEAST {
        2.0 * PI - least
    } else {
        least
    }
}

/// The point where a tendon that passes inside a circle touches the circle; the point of the circle
/// between the ends if Newton's method does not find it.
fn inside(ends: [Vec2; 2], radius: f64, revision: Revision) -> Option<(f64, [Vec2; 2])> {
    let [e0, e1] = ends;
    let (len0, len1) = (dot2(e0, e0).sqrt(), dot2(e1, e1).sqrt());
    if len0 <= radius || len1 <= radius || radius < MINVAL || len0 < MINVAL || len1 < MINVAL {
        return None;
    }
    let dif = [e1[0] - e0[0], e1[1] - e0[1]];
    let dd = dot2(dif, dif);
    if dd > MINVAL {
        let a = -dot2(dif, e0) / dd;
        if a > 0.0 && a < 1.0 {
            let nearest = [e0[0] + dif[0] * a, e0[1] + dif[1] * a];
            if dot2(nearest, nearest).sqrt() <= radius {
                return None;
            }
        }
    }
    let cos = (len0 * len0 + len1 * len1 - dd) / (2.0 * len0 * len1);
    if cos < -1.0 + MINVAL {
        return None;
    }
    let (a, b) = (radius / len0, radius / len1);
    let first = e0[0] * e1[1] - e0[1] * e1[0] > 0.0;
    let (from, part) = if first { (e0, a) } else { (e1, b) };
    let turn = match revision.turns_by_arc_tangents() {
        _ if cos > 1.0 - MINVAL => None,
        false => turn_by_sine([a, b], libm::acos(cos), part),
        true => turn([a, b], libm::acos(cos), part),
    };
    let point = if let Some(turn) = turn {
        let [u, v] = unit(from);
        let (sin, cos) = libm::sin_cos(turn);
        [radius * (cos * u - sin * v), radius * (sin * u + cos * v)]
    } else {
        unit([0.5 * (e0[0] + e1[0]), 0.5 * (e0[1] + e1[1])]).map(|x| x * radius)
    };
    Some((0.0, [point; 2]))
}

/// The angle from an end to the point that a tendon inside a circle touches, from 3.17 on. `a` and
/// `b` are the radius divided by the ends' distances, and `part` is that of the end. Newton's method
/// solves for the angle of the point.
fn turn([a, b]: [f64; 2], between: f64, part: f64) -> Option<f64> {
    const MOST: i32 = 18;
    const TOLERANCE: f64 = 1e-6;
    let mut f = libm::asin(b) + libm::asin(a) - PI + between;
    if f > 0.0 {
        return None;
    }
    let (mut turn, mut sin, mut iteration) = (FRAC_PI_2, 1.0, -1);
    while f.abs() > TOLERANCE {
        let square = sin * sin;
        let part = |x: f64| x / f64::max(MINVAL, (1.0 + square * -x * x).sqrt());
        let slope = (part(a) + part(b)) * libm::sin_cos(turn).1 - 2.0;
        let next = turn - f / slope;
        if slope > -MINVAL || next > turn {
            return None;
        }
        turn = next;
        sin = libm::sin_cos(turn).0;
        f = libm::asin(b * sin) + libm::asin(a * sin) - (turn + turn) + between;
        iteration += 1;
        if f > TOLERANCE || iteration > MOST {
            return None;
        }
    }
    Some(turn - libm::asin(part * sin))
}

/// The length of the arc of a circle from `p0` to `p1`, in the direction that `second` selects.
fn arc_length([p0, p1]: [Vec2; 2], second: bool, radius: f64) -> f64 {
    let mut angle = libm::acos(dot2(unit(p0), unit(p1)));
    let turn = p0[1] * p1[0] - p0[0] * p1[1];
    if (turn > 0.0 && second) || (turn < 0.0 && !second) {
        angle = 2.0 * PI - angle;
    }
    radius * angle
}

/// The angle from an end to the point that a tendon inside a circle touches, as `turn`, before 3.17.
/// Newton's method solves for the sine of the point's angle.
fn turn_by_sine([a, b]: [f64; 2], between: f64, part: f64) -> Option<f64> {
    const MOST: usize = 20;
    const START: f64 = 1.0 - 1e-7;
    const TOLERANCE: f64 = 1e-6;
    let value = |z: f64| libm::asin(a * z) + libm::asin(b * z) - 2.0 * libm::asin(z) + between;
    let mut z = START;
    let mut f = value(z);
    if f > 0.0 {
        return None;
    }
    let mut iteration = 0;
    while iteration < MOST && f.abs() > TOLERANCE {
        let root = |x: f64| f64::max(MINVAL, (1.0 - z * z * x * x).sqrt());
        let slope = a / root(a) + b / root(b) - 2.0 / f64::max(MINVAL, (1.0 - z * z).sqrt());
        let next = z - f / slope;
        if slope > -MINVAL || next > z {
            return None;
        }
        z = next;
        f = value(z);
        if f > TOLERANCE {
            return None;
        }
        iteration += 1;
    }
    (iteration < MOST).then(|| libm::asin(z) - libm::asin(part * z))
}
