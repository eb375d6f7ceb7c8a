//! Contact manifolds, by the kinds of the two shapes.

use super::collide_edge::edge_polygon;
use super::collide_polygons::polygons;
use super::manifold::{Feature, Kind, Manifold};
use super::math::{Pose, Vec2, dot, normalize, transform, transform_back, vec2};
use super::shape::{Geometry, Kind as ShapeKind};

/// Whether shapes of two kinds can collide (two edges cannot) and, if so, whether to swap them:
/// edges come before polygons, polygons before circles.
pub(crate) fn order(a: ShapeKind, b: ShapeKind) -> Option<bool> {
    use ShapeKind::{Circle, Edge, Polygon};
    match (a, b) {
        (Edge, Edge) => None,
        (Polygon, Edge) | (Circle, Edge | Polygon) => Some(true),
        _ => Some(false),
    }
}

/// Returns the manifold of two shapes, which must be in the order of [`order`].
pub(crate) fn collide(a: &Geometry, xf_a: &Pose, b: &Geometry, xf_b: &Pose) -> Manifold {
    match (a.kind, b.kind) {
        (ShapeKind::Edge, ShapeKind::Polygon) => edge_polygon(a, xf_a, b, xf_b),
        (ShapeKind::Edge, _) => edge_circle(a, xf_a, b, xf_b),
        (ShapeKind::Polygon, ShapeKind::Polygon) => polygons(a, xf_a, b, xf_b),
        (ShapeKind::Polygon, _) => polygon_circle(a, xf_a, b, xf_b),
        (ShapeKind::Circle, _) => circles(a, xf_a, b, xf_b),
    }
}

fn circles(a: &Geometry, xf_a: &Pose, b: &Geometry, xf_b: &Pose) -> Manifold {
    let (center_a, center_b) = (a.vertices()[0], b.vertices()[0]);
    let d = transform(xf_b, center_b) - transform(xf_a, center_a);
    let radius = a.radius + b.radius;
    if dot(d, d) > radius * radius {
        return Manifold::EMPTY;
    }
    Manifold::new(Kind::Circles, Vec2::zeros(), center_a)
        .with_point(center_b, [Feature::vertex(0); 2])
}

fn edge_circle(edge: &Geometry, xf_a: &Pose, circle: &Geometry, xf_b: &Pose) -> Manifold {
    let center = circle.vertices()[0];
    let q = transform_back(xf_a, transform(xf_b, center));
    let (a, b) = (edge.vertices()[0], edge.vertices()[1]);
    let e = b - a;
    let (u, v) = (dot(e, b - q), dot(e, q - a)); // barycentric coordinates
    let radius = edge.radius + circle.radius;
    let beyond = |p: Vec2| dot(q - p, q - p) > radius * radius;
    for (outside, end, index) in [(v <= 0.0, a, 0), (u <= 0.0, b, 1)] {
        if outside {
            if beyond(end) {
                return Manifold::EMPTY;
            }
            let id = [Feature::vertex(index), Feature::vertex(0)];
            return Manifold::new(Kind::Circles, Vec2::zeros(), end).with_point(center, id);
        }
    }
    if beyond((1.0 / dot(e, e)) * (u * a + v * b)) {
        return Manifold::EMPTY;
    }
    let mut n = vec2(-e.y, e.x);
    if dot(n, q - a) < 0.0 {
        n = -n;
    }
    let id = [Feature::face(0), Feature::vertex(0)];
    Manifold::new(Kind::FaceA, normalize(n).0, a).with_point(center, id)
}

fn polygon_circle(polygon: &Geometry, xf_a: &Pose, circle: &Geometry, xf_b: &Pose) -> Manifold {
    let center = circle.vertices()[0];
    let c = transform_back(xf_a, transform(xf_b, center));
    let radius = polygon.radius + circle.radius;
    let mut face = 0;
    let mut separation = -f32::MAX;
    for (i, (vertex, normal)) in polygon.vertices().iter().zip(polygon.normals()).enumerate() {
        let s = dot(*normal, c - vertex);
        if s > radius {
            return Manifold::EMPTY;
        }
        if s > separation {
            separation = s;
            face = i;
        }
    }
    let (v1, v2) = (
        polygon.vertices()[face],
        polygon.vertices()[polygon.next(face)],
    );
    let normal = polygon.normals()[face];
    let middle = 0.5 * (v1 + v2);
    let contact = |normal, point| {
        Manifold::new(Kind::FaceA, normal, point).with_point(center, [Feature::vertex(0); 2])
    };
    if separation < f32::EPSILON {
        return contact(normal, middle); // the circle's centre is inside the polygon
    }
    for (corner, other) in [(v1, v2), (v2, v1)] {
        let d = c - corner;
        if dot(d, other - corner) <= 0.0 {
            if dot(d, d) > radius * radius {
                return Manifold::EMPTY;
            }
            return contact(normalize(d).0, corner);
        }
    }
    if dot(c - middle, normal) > radius {
        return Manifold::EMPTY;
    }
    contact(normal, middle)
}
