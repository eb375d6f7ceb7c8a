//! A capsule that lies on an end of a cylinder: two contacts instead of one, from 4.0 on.

use super::super::spatial::{
    MINVAL, Vec3, add, add_scaled, cross, dot, normalize, rotate, scale, sub,
};
use super::Shape;
use super::convex::Touch;
use super::epa::Polytope;

/// The number of sides of the polygon that stands for the end.
const SIDES: usize = 16;

/// The cosines of the polygon's corners, with as many digits as libmujoco has.
#[expect(
    clippy::approx_constant,
    reason = "the last digits of the contacts depend on it"
)]
const COSINES: [f64; SIDES] = [
    1.0,
    0.923879532511287,
    0.707106781186548,
    0.38268343236509,
    0.0,
    -0.38268343236509,
    -0.707106781186547,
    -0.923879532511287,
    -1.0,
    -0.923879532511287,
    -0.707106781186548,
    -0.38268343236509,
    0.0,
    0.38268343236509,
    0.707106781186547,
    0.923879532511287,
];

/// The greatest sine of the angle between the capsule's axis and the plane of the end.
const SLOPE: f64 = 0.0888;

/// The part of the capsule's axis above the end on which it lies, by its end points, at most two.
/// `None` if it lies on no end, or no point is above it.
pub(super) fn line(
    capsule: Shape<'_>,
    cylinder: Shape<'_>,
    grown: f64,
    found: &Touch,
    polytope: &mut Polytope,
) -> Option<impl Iterator<Item = Touch>> {
    let low = found.low?;
    let sign = if low { -1.0 } else { 1.0 };
    let normal = rotate(cylinder.mat, [0.0, 0.0, sign]);
    let ([w1, w2], axis) = (found.points, capsule.axis());
    if dot(sub(w2, w1), normal) <= MINVAL || dot(axis, normal).abs() >= SLOPE {
        return None;
    }
    let (place, half) = (dot(sub(w1, capsule.pos), axis), capsule.size[1]);
    let [line, cut] = &mut polytope.lines;
    line.clear();
    line.extend([-place - half, half - place].map(|along| add_scaled(w1, axis, along)));

    let corners: [Vec3; SIDES] = std::array::from_fn(|k| {
        let &[radius, half, _] = cylinder.size;
        let (cos, sin) = (COSINES[k], COSINES[(k + 3 * SIDES / 4) % SIDES]);
        let point = [radius * cos, sign * (radius * -sin), sign * half];
        add(rotate(cylinder.mat, point), cylinder.pos)
    });
    for (k, &corner) in corners.iter().enumerate() {
        let along = sub(corners[(k + 1) % SIDES], corner);
        let outward = normalize(cross(along, sub(add(corner, normal), corner))).0;
        cut_by_side(line, corner, outward, cut);
        std::mem::swap(line, cut);
    }
    let height = move |p: Vec3| dot(sub(p, corners[0]), normal);
    line.retain(|p| height(*p) <= grown);
    let ends = match line[..] {
        [] => return None,
        [one] => [Some(one), None],
        [first, second] => [Some(first), Some(second)],
        _ => furthest_apart(line).map(Some),
    };
    let down = scale(normal, -1.0);
    Some(ends.into_iter().flatten().map(move |p| {
        let mut w2 = add_scaled(p, normal, -height(p));
        let mut dist = dot(sub(w2, p), down);
        let w1 = add_scaled(w2, down, -dist);
        if grown > 0.0 {
            w2 = add_scaled(w2, down, -grown);
            dist -= grown;
        }
        Touch {
            dist,
            points: [w1, w2],
            low: Some(low),
        }
    }))
}

/// Cuts a closed line of points by a plane, and keeps the part on its normal's side.
fn cut_by_side(line: &[Vec3], corner: Vec3, normal: Vec3, kept: &mut Vec<Vec3>) {
    kept.clear();
    for (i, &p) in line.iter().enumerate() {
        let q = line[(i + 1) % line.len()];
        let [from, to] = [p, q].map(|point| dot(sub(point, corner), normal));
        let [starts, stays] = [from, to].map(|height| height > -MINVAL);
        if starts != stays {
            let share = from / (from - to);
            if (0.0..=1.0).contains(&share) {
                kept.push(add_scaled(p, sub(q, p), share));
            }
        }
        if stays {
            kept.push(q);
        }
    }
}

/// The two points of `points` that are furthest apart.
fn furthest_apart(points: &[Vec3]) -> [Vec3; 2] {
    let (mut best, mut most) = ([points[0], points[1]], f64::NEG_INFINITY);
    for (i, &p) in points.iter().enumerate() {
        for &q in &points[i + 1..] {
            let between = sub(q, p);
            let square = dot(between, between);
            if square > most {
                (best, most) = ([p, q], square);
            }
        }
    }
    best
}
