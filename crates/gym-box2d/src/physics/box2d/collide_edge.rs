//! Contact of an edge and a polygon: `b2EPCollider` of Box2D 2.3, for an edge without adjacent
//! edges (`m_hasVertex0` and `m_hasVertex3` are false). Such an edge collides from both sides.

use super::manifold::{ClipVertex, Feature, Kind, Manifold, clip};
use super::math::{
    Pose, Vec2, cross_one, dot, min, normalize, relative, rotate, transform, transform_back, vec2,
};
use super::settings::{ANGULAR_SLOP, POLYGON_RADIUS};
use super::shape::{Geometry, MAX_VERTICES};

/// A face of the polygon is preferred to the edge only if its separation is larger by this
/// tolerance.
const RELATIVE_TOLERANCE: f32 = 0.98;
const ABSOLUTE_TOLERANCE: f32 = 0.001;
const RADIUS: f32 = 2.0 * POLYGON_RADIUS;

/// The face to which the contact is clipped, in the edge's coordinates.
struct ReferenceFace {
    i1: usize,
    i2: usize,
    v1: Vec2,
    v2: Vec2,
    normal: Vec2,
}

pub(crate) fn edge_polygon(
    edge: &Geometry,
    xf_a: &Pose,
    polygon: &Geometry,
    xf_b: &Pose,
) -> Manifold {
    let xf = relative(xf_a, xf_b);
    let (v1, v2) = (edge.vertices()[0], edge.vertices()[1]);
    let direction = normalize(v2 - v1).0;
    let edge_normal = cross_one(direction);
    let front = dot(edge_normal, transform(&xf, polygon.centroid) - v1) >= 0.0;
    let normal = if front { edge_normal } else { -edge_normal };

    let count = polygon.vertices().len();
    let (mut vertices, mut normals) =
        ([Vec2::zeros(); MAX_VERTICES], [Vec2::zeros(); MAX_VERTICES]);
    for i in 0..count {
        vertices[i] = transform(&xf, polygon.vertices()[i]);
        normals[i] = rotate(xf.rotation, polygon.normals()[i]);
    }
    let (vertices, normals) = (&vertices[..count], &normals[..count]);

    let edge_separation = vertices
        .iter()
        .map(|v| dot(normal, v - v1))
        .fold(f32::MAX, |a, b| min(b, a));
    if edge_separation > RADIUS {
        return Manifold::EMPTY;
    }
    let polygon_face = polygon_separation(vertices, normals, v1, v2, normal);
    if polygon_face.is_some_and(|(_, separation)| separation > RADIUS) {
        return Manifold::EMPTY;
    }
    let threshold = RELATIVE_TOLERANCE * edge_separation + ABSOLUTE_TOLERANCE;
    let polygon_face = polygon_face.filter(|(_, separation)| *separation > threshold);

    let (incident, face) = if let Some((face, _)) = polygon_face {
        let id = [Feature::vertex(0), Feature::face(face)];
        let incident = [ClipVertex { v: v1, id }, ClipVertex { v: v2, id }];
        let next = polygon.next(face);
        let normal = normals[face];
        (
            incident,
            ReferenceFace {
                i1: face,
                i2: next,
                v1: vertices[face],
                v2: vertices[next],
                normal,
            },
        )
    } else {
        let mut best = 0;
        let mut best_value = dot(normal, normals[0]);
        for (i, other) in normals.iter().enumerate().skip(1) {
            let value = dot(normal, *other);
            if value < best_value {
                best_value = value;
                best = i;
            }
        }
        let incident = [best, polygon.next(best)].map(|i| ClipVertex {
            v: vertices[i],
            id: [Feature::face(0), Feature::vertex(i)],
        });
        let face = if front {
            ReferenceFace {
                i1: 0,
                i2: 1,
                v1,
                v2,
                normal,
            }
        } else {
            ReferenceFace {
                i1: 1,
                i2: 0,
                v1: v2,
                v2: v1,
                normal,
            }
        };
        (incident, face)
    };

    let side = vec2(face.normal.y, -face.normal.x);
    let clipped = clip(incident, side, dot(side, face.v1), face.i1)
        .and_then(|points| clip(points, -side, dot(-side, face.v2), face.i2));
    let mut manifold = if polygon_face.is_some() {
        Manifold::new(
            Kind::FaceB,
            polygon.normals()[face.i1],
            polygon.vertices()[face.i1],
        )
    } else {
        Manifold::new(Kind::FaceA, face.normal, face.v1)
    };
    for point in clipped.into_iter().flatten() {
        if dot(face.normal, point.v - face.v1) <= RADIUS {
            if polygon_face.is_some() {
                let [one, two] = point.id;
                manifold.push(point.v, [two, one]);
            } else {
                manifold.push(transform_back(&xf, point.v), point.id);
            }
        }
    }
    manifold
}

/// Returns the polygon's face with the largest separation from the edge.
fn polygon_separation(
    vertices: &[Vec2],
    normals: &[Vec2],
    v1: Vec2,
    v2: Vec2,
    normal: Vec2,
) -> Option<(usize, f32)> {
    // Box2D's limit on the angle of a face; for an edge without adjacent edges, the limit excludes
    // no face
    let limit = -normal;
    let mut best = None;
    let mut best_separation = -f32::MAX;
    for (i, (vertex, face_normal)) in vertices.iter().zip(normals).enumerate() {
        let n = -face_normal;
        let s = min(dot(n, vertex - v1), dot(n, vertex - v2));
        if s > RADIUS {
            return Some((i, s)); // no contact
        }
        if dot(n - limit, normal) < -ANGULAR_SLOP {
            continue;
        }
        if s > best_separation {
            best_separation = s;
            best = Some((i, s));
        }
    }
    best
}
