//! Pairs of shapes whose contacts have a closed form.

use super::{Hit, Push, Shape, spheres};
use crate::Revision;
use crate::math::number::Number;
use crate::math::spatial::{
    MINVAL, Vec3, add, add_scaled, column, cross, dot, norm, normalize, scale, sub,
};

/// The distance of a sphere from a plane, and their contact point.
#[inline(always)]
pub(in crate::physics) fn above_plane<N: Number>(
    (origin, normal): ([N; 3], [N; 3]),
    centre: [N; 3],
    radius: f64,
) -> (N, [N; 3]) {
    let height = dot(sub(centre, origin), normal);
    let dist = height - radius;
    let pos = add_scaled(centre, normal, -(dist * 0.5 + radius));
    (dist, pos)
}

/// The contact of a plane and a sphere.
fn plane_point(
    plane: Shape<'_>,
    centre: Vec3,
    radius: f64,
    tangent: Vec3,
    margin: f64,
) -> Option<Hit> {
    let normal = plane.axis();
    let (dist, pos) = above_plane((plane.pos, normal), centre, radius);
    (dist <= margin).then_some(Hit {
        dist,
        pos,
        normal,
        tangent,
    })
}

pub(super) fn plane_sphere(plane: Shape<'_>, sphere: Shape<'_>, margin: f64, push: Push<'_>) {
    let hit = plane_point(plane, sphere.pos, sphere.size[0], [0.0; 3], margin);
    hit.into_iter().for_each(push);
}

/// Contacts of the capsule's ends as spheres, first the end at +z; the tangent is the capsule's
/// axis.
pub(super) fn plane_capsule(plane: Shape<'_>, capsule: Shape<'_>, margin: f64, push: Push<'_>) {
    let (axis, &[radius, half, _]) = (capsule.axis(), capsule.size);
    for end in [half, -half] {
        let centre = add_scaled(capsule.pos, axis, end);
        let hit = plane_point(plane, centre, radius, axis, margin);
        hit.into_iter().for_each(&mut *push);
    }
}

/// Contacts at the lowest point of the nearer rim, at the opposite point of the other rim, and at
/// two more points of the nearer rim, so that a cylinder can stand.
pub(super) fn plane_cylinder(plane: Shape<'_>, cylinder: Shape<'_>, margin: f64, push: Push<'_>) {
    let normal = plane.axis();
    let &[radius, half, _] = cylinder.size;
    let mut axis = cylinder.axis();
    let mut slope = dot(normal, axis);
    if slope > 0.0 {
        (axis, slope) = (scale(axis, -1.0), -slope);
    }
    let height = dot(sub(cylinder.pos, plane.pos), normal);

    // from the centre to the lowest point of the rim
    let down = sub(scale(axis, slope), normal);
    let length = norm(down);
    let rim = if length < MINVAL {
        scale(column(cylinder.mat, 0), radius)
    } else {
        scale(down, radius / length)
    };
    let fall = dot(rim, normal);
    let (axis, slope) = (scale(axis, half), slope * half);

    let center = cylinder.pos;
    let mut point = |place: Vec3, dist: f64| {
        if dist <= margin {
            let pos = add_scaled(place, normal, -dist * 0.5);
            push(Hit::new(dist, pos, normal));
        }
        dist <= margin
    };
    if !point(add(add(center, rim), axis), height + slope + fall) {
        return;
    }
    point(sub(add(center, rim), axis), height - slope + fall);
    let side = scale(normalize(cross(rim, axis)).0, radius * 3.0_f64.sqrt() / 2.0);
    let dist = height + slope - 0.5 * fall;
    for beside in [add(center, side), sub(center, side)] {
        point(add_scaled(add(beside, axis), rim, -0.5), dist);
    }
}

pub(super) fn sphere_sphere(a: Shape<'_>, b: Shape<'_>, margin: f64, push: Push<'_>) {
    let axes = (a.axis(), b.axis());
    let hit = spheres(a.pos, a.size[0], b.pos, b.size[0], axes, margin);
    hit.into_iter().for_each(push);
}

pub(super) fn sphere_capsule(sphere: Shape<'_>, capsule: Shape<'_>, margin: f64, push: Push<'_>) {
    let (axis, &[radius, half, _]) = (capsule.axis(), capsule.size);
    let along = dot(axis, sub(sphere.pos, capsule.pos)).clamp(-half, half);
    let nearest = add_scaled(capsule.pos, axis, along);
    let axes = (sphere.axis(), axis);
    let hit = spheres(sphere.pos, sphere.size[0], nearest, radius, axes, margin);
    hit.into_iter().for_each(push);
}

/// Adds the contacts of spheres at the nearest points of the capsules' segments. Parallel segments
/// have up to two contacts. Each version of MuJoCo has another function.
pub(super) fn capsule_capsule(
    a: Shape<'_>,
    b: Shape<'_>,
    margin: f64,
    revision: Revision,
    push: Push<'_>,
) {
    let mut test = |c1: Vec3, c2: Vec3| {
        let hit = spheres(c1, a.size[0], c2, b.size[0], (a.axis(), b.axis()), margin);
        hit.map(&mut *push).is_some()
    };
    if revision.tests_capsule_ends() {
        segments_between_ends(a, b, &mut test);
    } else {
        segments_about_centres(a, b, &mut test);
    }
}

/// Finds the nearest points as positions from the centres (0) to the ends (1 and -1) of the
/// segments.
fn segments_about_centres(a: Shape<'_>, b: Shape<'_>, test: &mut impl FnMut(Vec3, Vec3) -> bool) {
    let (a1, a2) = (scale(a.axis(), a.size[1]), scale(b.axis(), b.size[1]));
    let between = sub(a.pos, b.pos);
    let (ma, mb, mc) = (dot(a1, a1), -dot(a1, a2), dot(a2, a2));
    let (u, v) = (-dot(a1, between), dot(a2, between));
    let det = ma * mc - mb * mb;

    let mut test = |x1: f64, x2: f64| test(add_scaled(a.pos, a1, x1), add_scaled(b.pos, a2, x2));
    if det.abs() >= MINVAL {
        let (mut x1, mut x2) = ((mc * u - mb * v) / det, (ma * v - mb * u) / det);
        if x1 > 1.0 {
            (x1, x2) = (1.0, (v - mb) / mc);
        } else if x1 < -1.0 {
            (x1, x2) = (-1.0, (v + mb) / mc);
        }
        if x2 > 1.0 {
            (x1, x2) = (((u - mb) / ma).clamp(-1.0, 1.0), 1.0);
        } else if x2 < -1.0 {
            (x1, x2) = (((u + mb) / ma).clamp(-1.0, 1.0), -1.0);
        }
        test(x1, x2);
        return;
    }
    let mut found = 0;
    for x1 in [1.0, -1.0] {
        found += usize::from(test(x1, ((v - x1 * mb) / mc).clamp(-1.0, 1.0)));
    }
    for x2 in [1.0, -1.0] {
        if found < 2 {
            found += usize::from(test(((u - x2 * mb) / ma).clamp(-1.0, 1.0), x2));
        }
    }
}

/// Finds the nearest points as positions between the ends of the segments, from 3.17 on. Segments
/// that are almost parallel touch at the points nearest to the ends of the first one.
fn segments_between_ends(a: Shape<'_>, b: Shape<'_>, test: &mut impl FnMut(Vec3, Vec3) -> bool) {
    /// The square of the sine of the angle between segments that count as parallel.
    const PARALLEL: f64 = 1e-8;
    let ends = |shape: Shape<'_>| {
        let half = scale(shape.axis(), shape.size[1]);
        (sub(shape.pos, half), add(shape.pos, half))
    };
    let ((a0, a1), (b0, b1)) = (ends(a), ends(b));
    let (d1, d2, between) = (sub(a1, a0), sub(b1, b0), sub(a0, b0));
    let (square1, square2) = (dot(d1, d1), dot(d2, d2));
    let (f, c, both) = (dot(d2, between), dot(d1, between), dot(d1, d2));
    let share = |x: f64| x.clamp(0.0, 1.0);
    let (to_start, to_end) = (-c / square1, (both - c) / square1);
    // a position beyond an end of the second segment is moved to that end, and the position on the
    // first segment recomputed
    let mut test = |s: f64, t: f64| {
        let (s, t) = if t < 0.0 {
            (share(to_start), 0.0)
        } else if t > 1.0 {
            (share(to_end), 1.0)
        } else {
            (s, t)
        };
        test(add_scaled(a0, d1, s), add_scaled(b0, d2, t))
    };
    let normal = cross(d1, d2);
    let square = dot(normal, normal);
    if square > PARALLEL * square1 * square2 {
        let s = share(dot(normal, cross(d2, between)) / square);
        test(s, (both * s + f) / square2);
    } else {
        test(0.0, f / square2);
        test(1.0, (f + both) / square2);
    }
}
