//! Contact of two polygons: finds the face with the largest separation and clips the other
//! polygon's edge to it, like `b2CollidePolygon.cpp` of Box2D 2.3.0 (later versions search every
//! face).

use super::manifold::{ClipVertex, Feature, Kind, Manifold, clip};
use super::math::{
    Pose, cross_one, dot, normalize, rotate, rotate_back, transform, transform_back,
};
use super::shape::Geometry;

/// A face of the second polygon is preferred only if its separation is larger by this tolerance, so
/// that the choice is stable from step to step.
const RELATIVE_TOLERANCE: f32 = 0.98;
const ABSOLUTE_TOLERANCE: f32 = 0.001;

pub(crate) fn polygons(a: &Geometry, xf_a: &Pose, b: &Geometry, xf_b: &Pose) -> Manifold {
    let radius = a.radius + b.radius;
    let (face_a, separation_a) = max_separation(a, xf_a, b, xf_b);
    if separation_a > radius {
        return Manifold::EMPTY;
    }
    let (face_b, separation_b) = max_separation(b, xf_b, a, xf_a);
    if separation_b > radius {
        return Manifold::EMPTY;
    }
    if separation_b > RELATIVE_TOLERANCE * separation_a + ABSOLUTE_TOLERANCE {
        clip_to_face(Kind::FaceB, (b, xf_b, face_b), (a, xf_a), radius)
    } else {
        clip_to_face(Kind::FaceA, (a, xf_a, face_a), (b, xf_b), radius)
    }
}

/// Returns the separation of `b` from the line through the face `face` of `a`.
fn face_separation(a: &Geometry, xf_a: &Pose, face: usize, b: &Geometry, xf_b: &Pose) -> f32 {
    let normal = rotate(xf_a.rotation, a.normals()[face]);
    let local_normal = rotate_back(xf_b.rotation, normal);
    let mut deepest = b.vertices()[0];
    let mut min_dot = f32::MAX;
    for vertex in b.vertices() {
        let d = dot(*vertex, local_normal);
        if d < min_dot {
            min_dot = d;
            deepest = *vertex;
        }
    }
    dot(
        transform(xf_b, deepest) - transform(xf_a, a.vertices()[face]),
        normal,
    )
}

/// Returns the face of `a` with the largest separation from `b`. The search climbs from face to
/// face, from the face that points most towards `b`.
fn max_separation(a: &Geometry, xf_a: &Pose, b: &Geometry, xf_b: &Pose) -> (usize, f32) {
    let d = transform(xf_b, b.centroid) - transform(xf_a, a.centroid);
    let towards = rotate_back(xf_a.rotation, d);
    let mut face = 0;
    let mut max_dot = -f32::MAX;
    for (i, normal) in a.normals().iter().enumerate() {
        let d = dot(*normal, towards);
        if d > max_dot {
            max_dot = d;
            face = i;
        }
    }
    let previous = |i: usize| if i > 0 { i - 1 } else { a.vertices().len() - 1 };
    let separation = |i: usize| face_separation(a, xf_a, i, b, xf_b);
    let s = separation(face);
    let (back, s_back) = (previous(face), separation(previous(face)));
    let (ahead, s_ahead) = (a.next(face), separation(a.next(face)));

    let (mut best, mut best_separation, forward) = if s_back > s && s_back > s_ahead {
        (back, s_back, false)
    } else if s_ahead > s {
        (ahead, s_ahead, true)
    } else {
        return (face, s);
    };
    loop {
        let i = if forward {
            a.next(best)
        } else {
            previous(best)
        };
        let s = separation(i);
        if s <= best_separation || s.is_nan() {
            return (best, best_separation);
        }
        best = i;
        best_separation = s;
    }
}

/// Clips the incident edge to the reference face `face`. The incident edge is the edge of
/// `incident` whose normal points most against this face's normal.
fn clip_to_face(
    kind: Kind,
    (reference, xf1, face): (&Geometry, &Pose, usize),
    (incident, xf2): (&Geometry, &Pose),
    radius: f32,
) -> Manifold {
    let normal = rotate_back(
        xf2.rotation,
        rotate(xf1.rotation, reference.normals()[face]),
    );
    let mut edge = 0;
    let mut min_dot = f32::MAX;
    for (i, other) in incident.normals().iter().enumerate() {
        let d = dot(normal, *other);
        if d < min_dot {
            min_dot = d;
            edge = i;
        }
    }
    let ends = [edge, incident.next(edge)].map(|i| ClipVertex {
        v: transform(xf2, incident.vertices()[i]),
        id: [Feature::face(face), Feature::vertex(i)],
    });

    let next = reference.next(face);
    let (v11, v12) = (reference.vertices()[face], reference.vertices()[next]);
    let local_tangent = normalize(v12 - v11).0;
    let mut manifold = Manifold::new(kind, cross_one(local_tangent), 0.5 * (v11 + v12));
    let tangent = rotate(xf1.rotation, local_tangent);
    let normal = cross_one(tangent);
    let (v11, v12) = (transform(xf1, v11), transform(xf1, v12));
    let front = dot(normal, v11);
    let clipped = clip(ends, -tangent, -dot(tangent, v11) + radius, face)
        .and_then(|ends| clip(ends, tangent, dot(tangent, v12) + radius, next));
    for point in clipped.into_iter().flatten() {
        if dot(normal, point.v) - front <= radius {
            let [one, two] = point.id;
            let id = if kind == Kind::FaceB {
                [two, one]
            } else {
                [one, two]
            };
            manifold.push(transform_back(xf2, point.v), id);
        }
    }
    manifold
}

#[cfg(test)]
mod tests {
    use super::super::math::{Vec2, pose_about, vec2};
    use super::*;
    use crate::physics::Shape;

    /// A number from -1 to 1 by lot.
    fn lot(seed: &mut u64) -> f32 {
        *seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    /// A polygon within a flat ellipse, of which the other may lie in any direction.
    fn polygon(seed: &mut u64) -> (Geometry, Pose) {
        let points = (0..8).map(|_| vec2(4.0 * lot(seed), lot(seed)));
        let polygon = Geometry::from(&Shape::Polygon(points.collect()));
        let place = vec2(2.0 * lot(seed), 2.0 * lot(seed));
        (polygon, pose_about(place, 4.0 * lot(seed), Vec2::zeros()))
    }

    /// The search ends at a face that no neighbour exceeds, however far it climbs.
    #[test]
    fn no_neighbour_of_the_face_found_separates_more() {
        let (mut climbs, seed) = ([0; 4], &mut 3);
        for _ in 0..2000 {
            let [(a, xf_a), (b, xf_b)] = [polygon(seed), polygon(seed)];
            let (face, found) = max_separation(&a, &xf_a, &b, &xf_b);
            let of = |i: usize| face_separation(&a, &xf_a, i, &b, &xf_b);
            let count = a.vertices().len();
            assert_eq!(found, of(face));
            for other in [a.next(face), (face + count - 1) % count] {
                assert!(of(other) <= found, "{other} exceeds {face}");
            }

            let towards = rotate_back(
                xf_a.rotation,
                transform(&xf_b, b.centroid) - transform(&xf_a, a.centroid),
            );
            let along = |i: &usize| dot(a.normals()[*i], towards);
            let first = (0..count)
                .max_by(|i, j| along(i).total_cmp(&along(j)))
                .unwrap();
            let apart = first.abs_diff(face);
            climbs[apart.min(count - apart).min(3)] += 1;
        }
        assert!(climbs.iter().all(|climbs| *climbs > 0), "{climbs:?}");
    }
}
