//! The distance of two shapes: the GJK algorithm (Gilbert, Johnson and Keerthi), as in
//! `b2Distance.cpp`.

use super::math::{
    Pose, Vec2, cross, cross_one, cross_scalar, dot, length, rotate_back, transform,
};
use super::shape::Geometry;

const MAX_ITERATIONS: usize = 20;

/// The features that were closest in the last call; the next call starts from these features.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Cache {
    metric: f32,
    pub(crate) count: usize,
    pub(crate) index_a: [usize; 3],
    pub(crate) index_b: [usize; 3],
}

/// A vertex of the simplex: `w` is a point of B minus a point of A.
#[derive(Clone, Copy, Default)]
struct Vertex {
    point_a: Vec2,
    point_b: Vec2,
    w: Vec2,
    /// The barycentric coordinate of the closest point.
    share: f32,
    index_a: usize,
    index_b: usize,
}

struct Simplex {
    vertices: [Vertex; 3],
    count: usize,
}

/// Returns the index of the vertex that is furthest in `direction`; of equally far ones, the first.
#[inline]
pub(crate) fn support(vertices: &[Vec2], direction: Vec2) -> usize {
    let mut best = 0;
    let mut best_value = dot(vertices[0], direction);
    for (i, vertex) in vertices.iter().enumerate().skip(1) {
        let value = dot(*vertex, direction);
        if value > best_value {
            best = i;
            best_value = value;
        }
    }
    best
}

/// Returns the distance of the hulls of two shapes, without their radii.
pub(crate) fn distance(
    a: &Geometry,
    xf_a: &Pose,
    b: &Geometry,
    xf_b: &Pose,
    cache: &mut Cache,
) -> f32 {
    let vertex = |index_a: usize, index_b: usize| {
        let point_a = transform(xf_a, a.vertices()[index_a]);
        let point_b = transform(xf_b, b.vertices()[index_b]);
        Vertex {
            point_a,
            point_b,
            w: point_b - point_a,
            share: 0.0,
            index_a,
            index_b,
        }
    };
    let mut simplex = Simplex {
        vertices: [Vertex::default(); 3],
        count: cache.count,
    };
    for i in 0..cache.count {
        simplex.vertices[i] = vertex(cache.index_a[i], cache.index_b[i]);
    }
    if simplex.count > 1 {
        let metric = simplex.metric();
        if metric < 0.5 * cache.metric || 2.0 * cache.metric < metric || metric < f32::EPSILON {
            simplex.count = 0;
        }
    }
    if simplex.count == 0 {
        simplex.vertices[0] = Vertex {
            share: 1.0,
            ..vertex(0, 0)
        };
        simplex.count = 1;
    }

    for _ in 0..MAX_ITERATIONS {
        let (saved, saved_count) = (
            simplex.vertices.map(|v| (v.index_a, v.index_b)),
            simplex.count,
        );
        match simplex.count {
            2 => simplex.solve2(),
            3 => simplex.solve3(),
            _ => {}
        }
        if simplex.count == 3 {
            break; // the simplex contains the origin: the shapes overlap
        }
        let d = simplex.search_direction();
        if dot(d, d) < f32::EPSILON * f32::EPSILON {
            break; // the origin lies on the simplex
        }
        let index_a = support(a.vertices(), rotate_back(xf_a.rotation, -d));
        let index_b = support(b.vertices(), rotate_back(xf_b.rotation, d));
        simplex.vertices[simplex.count] = vertex(index_a, index_b);
        if saved[..saved_count].contains(&(index_a, index_b)) {
            break; // no progress
        }
        simplex.count += 1;
    }

    cache.metric = simplex.metric();
    cache.count = simplex.count;
    cache.index_a = simplex.vertices.map(|v| v.index_a);
    cache.index_b = simplex.vertices.map(|v| v.index_b);
    simplex.distance()
}

/// Whether two shapes with their radii touch: Box2D's test for sensors.
pub(crate) fn overlap(a: &Geometry, xf_a: &Pose, b: &Geometry, xf_b: &Pose) -> bool {
    let distance = distance(a, xf_a, b, xf_b, &mut Cache::default());
    let radii = a.radius + b.radius;
    let apart = if distance > radii && distance > f32::EPSILON {
        distance - radii
    } else {
        0.0
    };
    apart < 10.0 * f32::EPSILON
}

impl Simplex {
    /// Returns the simplex's length or area, to check whether a cached simplex is still valid.
    fn metric(&self) -> f32 {
        let [v1, v2, v3] = self.vertices.map(|v| v.w);
        match self.count {
            2 => length(v1 - v2),
            3 => cross(v2 - v1, v3 - v1),
            _ => 0.0,
        }
    }

    fn search_direction(&self) -> Vec2 {
        let w1 = self.vertices[0].w;
        if self.count == 1 {
            return -w1;
        }
        let e12 = self.vertices[1].w - w1;
        if cross(e12, -w1) > 0.0 {
            cross_scalar(1.0, e12)
        } else {
            cross_one(e12)
        }
    }

    /// Returns the distance of the two closest points.
    fn distance(&self) -> f32 {
        let [v1, v2, _] = &self.vertices;
        match self.count {
            1 => length(v1.point_a - v1.point_b),
            2 => {
                let a = v1.share * v1.point_a + v2.share * v2.point_a;
                let b = v1.share * v1.point_b + v2.share * v2.point_b;
                length(a - b)
            }
            _ => 0.0,
        }
    }

    fn keep1(&mut self, i: usize) {
        self.vertices[0] = Vertex {
            share: 1.0,
            ..self.vertices[i]
        };
        self.count = 1;
    }

    /// Reduces the simplex to vertices `i` and `j`, with barycentric coordinates in the ratio `a`
    /// to `b`.
    fn keep2(&mut self, (i, a): (usize, f32), (j, b): (usize, f32)) {
        let inverse = 1.0 / (a + b);
        let first = Vertex {
            share: a * inverse,
            ..self.vertices[i]
        };
        let second = Vertex {
            share: b * inverse,
            ..self.vertices[j]
        };
        self.vertices[0] = first;
        self.vertices[1] = second;
        self.count = 2;
    }

    /// Reduces a segment to its closest point to the origin.
    fn solve2(&mut self) {
        let [w1, w2, _] = self.vertices.map(|v| v.w);
        let e12 = w2 - w1;
        let d12_2 = -dot(w1, e12);
        if d12_2 <= 0.0 {
            return self.keep1(0);
        }
        let d12_1 = dot(w2, e12);
        if d12_1 <= 0.0 {
            return self.keep1(1);
        }
        self.keep2((0, d12_1), (1, d12_2));
    }

    /// Reduces a triangle to its closest point to the origin.
    fn solve3(&mut self) {
        let [w1, w2, w3] = self.vertices.map(|v| v.w);
        let e12 = w2 - w1;
        let (d12_1, d12_2) = (dot(w2, e12), -dot(w1, e12));
        let e13 = w3 - w1;
        let (d13_1, d13_2) = (dot(w3, e13), -dot(w1, e13));
        let e23 = w3 - w2;
        let (d23_1, d23_2) = (dot(w3, e23), -dot(w2, e23));
        let n123 = cross(e12, e13);
        let d123_1 = n123 * cross(w2, w3);
        let d123_2 = n123 * cross(w3, w1);
        let d123_3 = n123 * cross(w1, w2);

        if d12_2 <= 0.0 && d13_2 <= 0.0 {
            self.keep1(0);
        } else if d12_1 > 0.0 && d12_2 > 0.0 && d123_3 <= 0.0 {
            self.keep2((0, d12_1), (1, d12_2));
        } else if d13_1 > 0.0 && d13_2 > 0.0 && d123_2 <= 0.0 {
            self.keep2((0, d13_1), (2, d13_2));
        } else if d12_1 <= 0.0 && d23_2 <= 0.0 {
            self.keep1(1);
        } else if d13_1 <= 0.0 && d23_1 <= 0.0 {
            self.keep1(2);
        } else if d23_1 > 0.0 && d23_2 > 0.0 && d123_1 <= 0.0 {
            // the third vertex replaces the first
            let inverse = 1.0 / (d23_1 + d23_2);
            self.vertices[1].share = d23_1 * inverse;
            self.vertices[0] = Vertex {
                share: d23_2 * inverse,
                ..self.vertices[2]
            };
            self.count = 2;
        } else {
            let inverse = 1.0 / (d123_1 + d123_2 + d123_3);
            self.vertices[0].share = d123_1 * inverse;
            self.vertices[1].share = d123_2 * inverse;
            self.vertices[2].share = d123_3 * inverse;
            self.count = 3;
        }
    }
}
