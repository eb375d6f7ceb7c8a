//! The time of impact of two moving shapes: conservative advancement with root finding, as in
//! `b2TimeOfImpact.cpp`.

use super::distance::{Cache, distance, support};
use super::math::{
    Pose, Sweep, Vec2, cross_one, dot, max, normalize, rotate, rotate_back, transform,
};
use super::settings::{LINEAR_SLOP, MAX_PUSH_BACKS};
use super::shape::Geometry;

const MAX_ITERATIONS: u32 = 20;
const MAX_ROOT_ITERATIONS: u32 = 50;

/// A shape and its motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moving<'a> {
    pub(crate) shape: &'a Geometry,
    pub(crate) sweep: Sweep,
}

/// The accepted difference of the hulls' distance from the [target].
pub(crate) const TOLERANCE: f32 = 0.25 * LINEAR_SLOP;

/// Returns the distance of the hulls at which two shapes count as touching.
pub(crate) fn target(a: &Moving<'_>, b: &Moving<'_>) -> f32 {
    max(
        LINEAR_SLOP,
        a.shape.radius + b.shape.radius - 3.0 * LINEAR_SLOP,
    )
}

/// Returns the fraction of the motion after which the shapes touch; `None` if they stay apart,
/// overlap at the start, or the search fails.
pub(crate) fn time_of_impact(a: Moving<'_>, b: Moving<'_>) -> Option<f32> {
    const T_MAX: f32 = 1.0;
    let a = Moving {
        sweep: a.sweep.normalized(),
        ..a
    };
    let b = Moving {
        sweep: b.sweep.normalized(),
        ..b
    };
    let (target, tolerance) = (target(&a, &b), TOLERANCE);

    let mut t1 = 0.0;
    let mut cache = Cache::default();
    for _ in 0..MAX_ITERATIONS {
        let (xf_a, xf_b) = (a.sweep.pose(t1), b.sweep.pose(t1));
        let apart = distance(a.shape, &xf_a, b.shape, &xf_b, &mut cache);
        if apart <= 0.0 {
            return None; // the shapes overlap
        }
        if apart < target + tolerance {
            return Some(t1);
        }
        let separation = Separation::new(&cache, &a, &xf_a, &b, &xf_b);

        // resolve the deepest points one after another
        let mut t2 = T_MAX;
        for _ in 0..MAX_PUSH_BACKS {
            let (witness, mut s2) = separation.deepest(t2);
            if s2 > target + tolerance {
                return None; // the shapes stay apart
            }
            if s2 > target - tolerance {
                t1 = t2; // advance
                break;
            }
            let mut s1 = separation.at(witness, t1);
            if s1 < target - tolerance {
                return None; // the separation does not match the simplex: give up
            }
            if s1 <= target + tolerance {
                return Some(t1);
            }
            // find the root of `separation - target` between t1 and t2
            let (mut a1, mut a2) = (t1, t2);
            for iteration in 0..MAX_ROOT_ITERATIONS {
                let t = if iteration % 2 == 1 {
                    a1 + (target - s1) * (a2 - a1) / (s2 - s1)
                } else {
                    0.5 * (a1 + a2)
                };
                let s = separation.at(witness, t);
                if (s - target).abs() < tolerance {
                    t2 = t;
                    break;
                }
                if s > target {
                    a1 = t;
                    s1 = s;
                } else {
                    a2 = t;
                    s2 = s;
                }
            }
        }
    }
    None
}

/// The axis along which the shapes are separated.
struct Separation<'a> {
    a: &'a Moving<'a>,
    b: &'a Moving<'a>,
    kind: Kind,
    axis: Vec2,
    /// A point of the face whose normal is the axis.
    local_point: Vec2,
}

#[derive(Clone, Copy)]
enum Kind {
    /// Two vertices define the axis, which is in world coordinates.
    Points,
    /// A face of A defines the axis.
    FaceA,
    /// A face of B defines the axis.
    FaceB,
}

/// The indices of the vertices of A and B whose separation is measured.
#[derive(Clone, Copy)]
struct Witness {
    a: usize,
    b: usize,
}

impl<'a> Separation<'a> {
    /// Makes the separation from the closest features in `cache`, at the poses `xf_a` and `xf_b`.
    fn new(cache: &Cache, a: &'a Moving<'a>, xf_a: &Pose, b: &'a Moving<'a>, xf_b: &Pose) -> Self {
        let point_a = |i: usize| a.shape.vertices()[cache.index_a[i]];
        let point_b = |i: usize| b.shape.vertices()[cache.index_b[i]];
        if cache.count == 1 {
            let axis = normalize(transform(xf_b, point_b(0)) - transform(xf_a, point_a(0))).0;
            return Self {
                a,
                b,
                kind: Kind::Points,
                axis,
                local_point: Vec2::zeros(),
            };
        }
        // a face of one shape and a vertex of the other
        let on_b = cache.index_a[0] == cache.index_a[1];
        let (kind, [p1, p2], face, xf_face, vertex) = if on_b {
            let vertex = transform(xf_a, point_a(0));
            (Kind::FaceB, [point_b(0), point_b(1)], b, xf_b, vertex)
        } else {
            let vertex = transform(xf_b, point_b(0));
            (Kind::FaceA, [point_a(0), point_a(1)], a, xf_a, vertex)
        };
        debug_assert!(face.shape.vertices().len() > 1);
        let axis = normalize(cross_one(p2 - p1)).0;
        let normal = rotate(xf_face.rotation, axis);
        let local_point = 0.5 * (p1 + p2);
        let s = dot(vertex - transform(xf_face, local_point), normal);
        Self {
            a,
            b,
            kind,
            axis: if s < 0.0 { -axis } else { axis },
            local_point,
        }
    }

    /// Returns the vertices with the least separation at time `t`, and their separation.
    fn deepest(&self, t: f32) -> (Witness, f32) {
        let (xf_a, xf_b) = (self.a.sweep.pose(t), self.b.sweep.pose(t));
        let (va, vb) = (self.a.shape.vertices(), self.b.shape.vertices());
        let witness = match self.kind {
            Kind::Points => Witness {
                a: support(va, rotate_back(xf_a.rotation, self.axis)),
                b: support(vb, rotate_back(xf_b.rotation, -self.axis)),
            },
            Kind::FaceA => {
                let normal = rotate(xf_a.rotation, self.axis);
                Witness {
                    a: 0,
                    b: support(vb, rotate_back(xf_b.rotation, -normal)),
                }
            }
            Kind::FaceB => {
                let normal = rotate(xf_b.rotation, self.axis);
                Witness {
                    a: support(va, rotate_back(xf_a.rotation, -normal)),
                    b: 0,
                }
            }
        };
        (witness, self.between(witness, &xf_a, &xf_b))
    }

    /// Returns the separation of the vertices `witness` at time `t`.
    fn at(&self, witness: Witness, t: f32) -> f32 {
        self.between(witness, &self.a.sweep.pose(t), &self.b.sweep.pose(t))
    }

    fn between(&self, witness: Witness, xf_a: &Pose, xf_b: &Pose) -> f32 {
        let point_a = |local| transform(xf_a, local);
        let point_b = |local| transform(xf_b, local);
        let (vertex_a, vertex_b) = (
            self.a.shape.vertices()[witness.a],
            self.b.shape.vertices()[witness.b],
        );
        match self.kind {
            Kind::Points => dot(point_b(vertex_b) - point_a(vertex_a), self.axis),
            Kind::FaceA => {
                let normal = rotate(xf_a.rotation, self.axis);
                dot(point_b(vertex_b) - point_a(self.local_point), normal)
            }
            Kind::FaceB => {
                let normal = rotate(xf_b.rotation, self.axis);
                dot(point_a(vertex_a) - point_b(self.local_point), normal)
            }
        }
    }
}
