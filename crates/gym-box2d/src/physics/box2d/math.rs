//! Vectors, rotations and [`Sweep`]s, in Box2D's order of arithmetic.
//!
//! Sums of products are written out (`a.x * b.x + a.y * b.y`), minima and maxima are comparisons,
//! and normalization multiplies by the reciprocal length: each of these affects the bits.

use nalgebra::{Isometry2, Translation2, UnitComplex, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use gym_core::math::sin_cos_f32 as sin_cos;

/// A point or a vector.
pub(crate) type Vec2 = Vector2<f32>;
/// Position and rotation.
pub(crate) type Pose = Isometry2<f32>;
/// A rotation, as cosine and sine.
pub(crate) type Rot = UnitComplex<f32>;

#[inline]
pub(crate) fn vec2(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

#[inline]
pub(crate) fn dot(a: Vec2, b: Vec2) -> f32 {
    a.x * b.x + a.y * b.y
}

#[inline]
pub(crate) fn cross(a: Vec2, b: Vec2) -> f32 {
    a.x * b.y - a.y * b.x
}

/// The cross product of `v` and the unit vector out of the plane: `v`, turned clockwise by 90°.
#[inline]
pub(crate) fn cross_one(v: Vec2) -> Vec2 {
    vec2(v.y, -v.x)
}

/// The cross product of a vector of length `s` out of the plane and `v`: `s` times `v`, turned
/// counterclockwise by 90°.
#[inline]
pub(crate) fn cross_scalar(s: f32, v: Vec2) -> Vec2 {
    vec2(-s * v.y, s * v.x)
}

#[inline]
pub(crate) fn dot3(a: Vector3<f32>, b: Vector3<f32>) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[inline]
pub(crate) fn cross3(a: Vector3<f32>, b: Vector3<f32>) -> Vector3<f32> {
    Vector3::new(
        a.y * b.z - a.z * b.y,
        a.z * b.x - a.x * b.z,
        a.x * b.y - a.y * b.x,
    )
}

#[inline]
pub(crate) fn length(v: Vec2) -> f32 {
    dot(v, v).sqrt()
}

/// Returns the unit vector of `v`, and the length of `v`. A vector shorter than `f32::EPSILON` is
/// returned unchanged.
#[inline]
pub(crate) fn normalize(v: Vec2) -> (Vec2, f32) {
    let length = length(v);
    if length < f32::EPSILON {
        return (v, 0.0);
    }
    let inverse = 1.0 / length;
    (vec2(v.x * inverse, v.y * inverse), length)
}

#[inline]
pub(crate) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline]
pub(crate) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline]
pub(crate) fn clamp(a: f32, low: f32, high: f32) -> f32 {
    max(low, min(a, high))
}

#[inline]
pub(crate) fn min2(a: Vec2, b: Vec2) -> Vec2 {
    vec2(min(a.x, b.x), min(a.y, b.y))
}

#[inline]
pub(crate) fn max2(a: Vec2, b: Vec2) -> Vec2 {
    vec2(max(a.x, b.x), max(a.y, b.y))
}

/// Returns the reciprocal of `determinant`, or 0 for a singular matrix.
#[inline]
pub(crate) fn reciprocal(determinant: f32) -> f32 {
    if determinant == 0.0 {
        determinant
    } else {
        1.0 / determinant
    }
}

#[inline]
pub(crate) fn rotation(angle: f32) -> Rot {
    let (sin, cos) = sin_cos(angle);
    Rot::from_cos_sin_unchecked(cos, sin)
}

#[inline]
pub(crate) fn rotate(q: Rot, v: Vec2) -> Vec2 {
    vec2(q.re * v.x - q.im * v.y, q.im * v.x + q.re * v.y)
}

#[inline]
pub(crate) fn rotate_back(q: Rot, v: Vec2) -> Vec2 {
    vec2(q.re * v.x + q.im * v.y, -q.im * v.x + q.re * v.y)
}

#[inline]
pub(crate) fn pose(position: Vec2, rotation: Rot) -> Pose {
    Pose::from_parts(Translation2::from(position), rotation)
}

#[inline]
pub(crate) fn transform(xf: &Pose, v: Vec2) -> Vec2 {
    rotate(xf.rotation, v) + xf.translation.vector
}

#[inline]
pub(crate) fn transform_back(xf: &Pose, v: Vec2) -> Vec2 {
    rotate_back(xf.rotation, v - xf.translation.vector)
}

/// Returns the pose of a body at `angle` whose centre of mass is at `c`. In the body's coordinates,
/// the centre of mass is `local_center`.
#[inline]
pub(crate) fn pose_about(c: Vec2, angle: f32, local_center: Vec2) -> Pose {
    let q = rotation(angle);
    pose(c - rotate(q, local_center), q)
}

/// Returns the pose `b` in the coordinates of `a`.
#[inline]
pub(crate) fn relative(a: &Pose, b: &Pose) -> Pose {
    let (q, r) = (a.rotation, b.rotation);
    let rotation =
        Rot::from_cos_sin_unchecked(q.re * r.re + q.im * r.im, q.re * r.im - q.im * r.re);
    pose(
        rotate_back(q, b.translation.vector - a.translation.vector),
        rotation,
    )
}

/// The motion of a body's centre of mass during a step: Box2D's `b2Sweep`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::physics) struct Sweep {
    /// Centre of mass in the body's coordinates.
    pub(crate) local_center: Vec2,
    /// Centre of mass at the time `alpha0`.
    pub(crate) c0: Vec2,
    /// Centre of mass at the end of the step.
    pub(crate) c: Vec2,
    /// Angle at the time `alpha0`.
    pub(crate) a0: f32,
    /// Angle at the end of the step.
    pub(in crate::physics) a: f32,
    /// The fraction of the step, from 0 to 1, at which the body is at `c0` and `a0`.
    pub(crate) alpha0: f32,
}

impl Sweep {
    /// Returns the pose at the fraction `beta` of the time from `alpha0` to the end of the step.
    #[inline]
    pub(crate) fn pose(&self, beta: f32) -> Pose {
        let c = (1.0 - beta) * self.c0 + beta * self.c;
        pose_about(c, (1.0 - beta) * self.a0 + beta * self.a, self.local_center)
    }

    /// Moves the start of the motion forward to the time `alpha`.
    pub(crate) fn advance(&mut self, alpha: f32) {
        let beta = (alpha - self.alpha0) / (1.0 - self.alpha0);
        self.c0 = (1.0 - beta) * self.c0 + beta * self.c;
        self.a0 = (1.0 - beta) * self.a0 + beta * self.a;
        self.alpha0 = alpha;
    }

    /// Returns the same motion with `a0` between 0 and a full turn.
    pub(crate) fn normalized(mut self) -> Self {
        const TURN: f32 = 2.0 * std::f32::consts::PI;
        let turns = TURN * (self.a0 / TURN).floor();
        self.a0 -= turns;
        self.a -= turns;
        self
    }
}
