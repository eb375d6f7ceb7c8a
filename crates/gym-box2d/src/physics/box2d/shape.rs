//! Shapes: circles, edges and convex polygons.

use serde::{Deserialize, Serialize};

use super::math::{
    Pose, Vec2, cross, cross_one, dot, max2, min2, normalize, rotate_back, transform, vec2,
};
use super::settings::{LINEAR_SLOP, POLYGON_RADIUS};
use crate::physics::Shape;

/// The most vertices of a polygon: Box2D's default. (pybox2d allows 16.)
pub(crate) const MAX_VERTICES: usize = 8;

/// The kind of a shape, which selects Box2D's algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Kind {
    Circle,
    Edge,
    Polygon,
}

/// A shape of any kind: the convex hull of its vertices, thickened by a radius.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::physics) struct Geometry {
    pub(crate) kind: Kind,
    count: u8,
    pub(crate) radius: f32,
    /// Centroid of a polygon.
    pub(crate) centroid: Vec2,
    vertices: [Vec2; MAX_VERTICES],
    normals: [Vec2; MAX_VERTICES],
}

/// Mass, centre of mass and moment of inertia about the body's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct MassData {
    pub(crate) mass: f32,
    pub(crate) center: Vec2,
    pub(crate) inertia: f32,
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Aabb {
    pub(crate) lower: Vec2,
    pub(crate) upper: Vec2,
}

impl Aabb {
    #[inline]
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        other.lower.x - self.upper.x <= 0.0
            && other.lower.y - self.upper.y <= 0.0
            && self.lower.x - other.upper.x <= 0.0
            && self.lower.y - other.upper.y <= 0.0
    }

    pub(crate) fn contains(&self, other: &Self) -> bool {
        self.lower.x <= other.lower.x
            && self.lower.y <= other.lower.y
            && other.upper.x <= self.upper.x
            && other.upper.y <= self.upper.y
    }

    pub(crate) fn union(&self, other: &Self) -> Self {
        Self {
            lower: min2(self.lower, other.lower),
            upper: max2(self.upper, other.upper),
        }
    }
}

impl From<&Shape> for Geometry {
    fn from(shape: &Shape) -> Self {
        match *shape {
            Shape::Circle { center, radius } => Self {
                radius,
                ..Self::new(Kind::Circle, &[center])
            },
            Shape::Edge(a, b) => Self::new(Kind::Edge, &[a, b]),
            Shape::Rect {
                half_width: x,
                half_height: y,
            } => {
                let corners = [vec2(-x, -y), vec2(x, -y), vec2(x, y), vec2(-x, y)];
                let mut rect = Self::new(Kind::Polygon, &corners);
                let normals = [
                    vec2(0.0, -1.0),
                    vec2(1.0, 0.0),
                    vec2(0.0, 1.0),
                    vec2(-1.0, 0.0),
                ];
                rect.normals[..4].copy_from_slice(&normals);
                rect
            }
            Shape::Polygon(ref points) => Self::polygon(points),
        }
    }
}

impl Geometry {
    fn new(kind: Kind, points: &[Vec2]) -> Self {
        let mut vertices = [Vec2::zeros(); MAX_VERTICES];
        vertices[..points.len()].copy_from_slice(points);
        Self {
            kind,
            count: points.len() as u8,
            radius: POLYGON_RADIUS,
            centroid: Vec2::zeros(),
            vertices,
            normals: [Vec2::zeros(); MAX_VERTICES],
        }
    }

    /// Returns the convex hull of `points`, counterclockwise, by gift wrapping from the rightmost
    /// lowest point. Points beyond [`MAX_VERTICES`] are ignored. Fewer than three points, or
    /// collinear points, give a box of side 2, as in Box2D.
    fn polygon(points: &[Vec2]) -> Self {
        let points = &points[..points.len().min(MAX_VERTICES)];
        let unit = Self::from(&Shape::Rect {
            half_width: 1.0,
            half_height: 1.0,
        });
        let Some(first) = (0..points.len()).reduce(|best, i| {
            let (p, b) = (points[i], points[best]);
            if p.x > b.x || (p.x == b.x && p.y < b.y) {
                i
            } else {
                best
            }
        }) else {
            return unit;
        };
        let mut hull = [Vec2::zeros(); MAX_VERTICES];
        let (mut count, mut last) = (0, first);
        while count < points.len() {
            hull[count] = points[last];
            count += 1;
            let mut next = 0;
            for j in 1..points.len() {
                let (r, v) = (points[next] - points[last], points[j] - points[last]);
                let side = cross(r, v);
                if next == last || side < 0.0 || (side == 0.0 && dot(v, v) > dot(r, r)) {
                    next = j;
                }
            }
            last = next;
            if last == first {
                break;
            }
        }
        if count < 3 {
            return unit;
        }
        let mut polygon = Self::new(Kind::Polygon, &hull[..count]);
        for i in 0..count {
            polygon.normals[i] = normalize(cross_one(hull[(i + 1) % count] - hull[i])).0;
        }
        polygon.centroid = centroid(&hull[..count]);
        polygon
    }

    #[inline]
    pub(in crate::physics) fn vertices(&self) -> &[Vec2] {
        &self.vertices[..usize::from(self.count).min(MAX_VERTICES)]
    }

    /// Returns a polygon's normals. Normal `i` belongs to the side from vertex `i` to the next
    /// vertex.
    #[inline]
    pub(crate) fn normals(&self) -> &[Vec2] {
        &self.normals[..usize::from(self.count).min(MAX_VERTICES)]
    }

    /// Returns the index of the vertex after vertex `i`.
    #[inline]
    pub(crate) fn next(&self, i: usize) -> usize {
        if i + 1 < usize::from(self.count) {
            i + 1
        } else {
            0
        }
    }

    /// Reads one number of the first vertex and of its normal, to prefetch them.
    pub(crate) fn prefetch(&self) -> u32 {
        self.vertices[0].x.to_bits() ^ self.normals[0].x.to_bits()
    }

    pub(crate) fn aabb(&self, xf: &Pose) -> Aabb {
        let first = transform(xf, self.vertices[0]);
        let (mut lower, mut upper) = (first, first);
        for vertex in &self.vertices()[1..] {
            let vertex = transform(xf, *vertex);
            lower = min2(lower, vertex);
            upper = max2(upper, vertex);
        }
        let r = vec2(self.radius, self.radius);
        Aabb {
            lower: lower - r,
            upper: upper + r,
        }
    }

    pub(crate) fn mass(&self, density: f32) -> MassData {
        match self.kind {
            Kind::Circle => {
                let (center, r) = (self.vertices[0], self.radius);
                let mass = density * std::f32::consts::PI * r * r;
                MassData {
                    mass,
                    center,
                    inertia: mass * (0.5 * r * r + dot(center, center)),
                }
            }
            Kind::Edge => {
                let center = 0.5 * (self.vertices[0] + self.vertices[1]);
                MassData {
                    mass: 0.0,
                    center,
                    inertia: 0.0,
                }
            }
            Kind::Polygon => self.polygon_mass(density),
        }
    }

    /// Computes the mass of a polygon by a fan of triangles about the mean of its vertices.
    fn polygon_mass(&self, density: f32) -> MassData {
        const THIRD: f32 = 1.0 / 3.0;
        let vertices = self.vertices();
        let mut origin = Vec2::zeros();
        for vertex in vertices {
            origin += vertex;
        }
        origin *= 1.0 / vertices.len() as f32;
        let (mut center, mut area, mut inertia) = (Vec2::zeros(), 0.0, 0.0);
        for (i, vertex) in vertices.iter().enumerate() {
            let (e1, e2) = (vertex - origin, vertices[self.next(i)] - origin);
            let d = cross(e1, e2);
            let triangle = 0.5 * d;
            area += triangle;
            center += triangle * THIRD * (e1 + e2);
            let x2 = e1.x * e1.x + e2.x * e1.x + e2.x * e2.x;
            let y2 = e1.y * e1.y + e2.y * e1.y + e2.y * e2.y;
            inertia += (0.25 * THIRD * d) * (x2 + y2);
        }
        let mass = density * area;
        center *= 1.0 / area;
        let shifted = center + origin;
        inertia *= density;
        inertia += mass * (dot(shifted, shifted) - dot(center, center));
        MassData {
            mass,
            center: shifted,
            inertia,
        }
    }

    /// Returns the fraction of the way from `from` to `to` at which the ray hits the shape, if the
    /// fraction is at most `limit`.
    pub(crate) fn ray_cast(&self, xf: &Pose, from: Vec2, to: Vec2, limit: f32) -> Option<f32> {
        let origin = xf.translation.vector;
        let p1 = rotate_back(xf.rotation, from - origin);
        let d = rotate_back(xf.rotation, to - origin) - p1;
        match self.kind {
            Kind::Circle => {
                let s = from - transform(xf, self.vertices[0]);
                let r = to - from;
                let b = dot(s, s) - self.radius * self.radius;
                let (c, rr) = (dot(s, r), dot(r, r));
                let sigma = c * c - rr * b;
                if sigma < 0.0 || rr < f32::EPSILON {
                    return None;
                }
                let a = -(c + sigma.sqrt());
                (0.0 <= a && a <= limit * rr).then(|| a / rr)
            }
            Kind::Edge => Segment::new([self.vertices[0], self.vertices[1]]).ray_cast(p1, d, limit),
            Kind::Polygon => {
                let (mut lower, mut upper, mut entered) = (0.0, limit, false);
                for (vertex, normal) in self.vertices().iter().zip(self.normals()) {
                    let numerator = dot(*normal, vertex - p1);
                    let denominator = dot(*normal, d);
                    if denominator == 0.0 {
                        if numerator < 0.0 {
                            return None;
                        }
                    } else if denominator < 0.0 && numerator < lower * denominator {
                        lower = numerator / denominator;
                        entered = true;
                    } else if denominator > 0.0 && numerator < upper * denominator {
                        upper = numerator / denominator;
                    }
                    if upper < lower {
                        return None;
                    }
                }
                entered.then_some(lower)
            }
        }
    }

    /// Whether deserialized data is a valid shape.
    pub(crate) fn is_valid(&self) -> bool {
        let count = match self.kind {
            Kind::Circle => 1..=1,
            Kind::Edge => 2..=2,
            Kind::Polygon => 3..=MAX_VERTICES as u8,
        };
        count.contains(&self.count)
            && self.radius >= 0.0
            && (self.kind == Kind::Circle || self.radius >= LINEAR_SLOP)
    }
}

/// An edge, prepared for ray casts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    start: Vec2,
    along: Vec2,
    normal: Vec2,
}

impl Segment {
    #[inline]
    pub(crate) fn new([v1, v2]: [Vec2; 2]) -> Self {
        let e = v2 - v1;
        Self {
            start: v1,
            along: e,
            normal: normalize(cross_one(e)).0,
        }
    }

    /// Returns the fraction of the way from `p1` to `p1 + d` at which the ray hits the edge, if the
    /// fraction is at most `limit`.
    #[inline]
    pub(crate) fn ray_cast(&self, p1: Vec2, d: Vec2, limit: f32) -> Option<f32> {
        let denominator = dot(self.normal, d);
        if denominator == 0.0 {
            return None;
        }
        let t = dot(self.normal, self.start - p1) / denominator;
        if t < 0.0 || limit < t {
            return None;
        }
        let along = dot(p1 + t * d - self.start, self.along) / dot(self.along, self.along);
        (0.0..=1.0).contains(&along).then_some(t)
    }
}

/// Returns the centroid, by a fan of triangles about the origin.
fn centroid(vertices: &[Vec2]) -> Vec2 {
    const THIRD: f32 = 1.0 / 3.0;
    let (mut center, mut area) = (Vec2::zeros(), 0.0);
    for (i, p2) in vertices.iter().enumerate() {
        let p3 = vertices[(i + 1) % vertices.len()];
        let triangle = 0.5 * cross(*p2, p3);
        area += triangle;
        center += triangle * THIRD * (p2 + p3);
    }
    center * (1.0 / area)
}
