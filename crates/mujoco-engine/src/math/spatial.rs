//! Vectors, quaternions, rotation matrices and six-dimensional vectors: MuJoCo's
//! `engine_util_spatial`.
//!
//! A quaternion is `w, x, y, z`. A matrix is row-major. A six-dimensional vector is rotation, then
//! translation.

use std::ops::{Add, Mul};

use super::libm;
use super::number::{self, Number};

/// Lengths below this count as zero: MuJoCo's `mjMINVAL`.
pub(crate) const MINVAL: f64 = 1e-15;
/// Lengths that MuJoCo's compiler takes for equal, or for zero: `mjEPS`.
pub(crate) const EPS: f64 = 1e-14;

/// A vector.
pub type Vec3 = [f64; 3];
/// A quaternion: `w, x, y, z`.
pub type Quat = [f64; 4];
/// A matrix of three rows, one after the other.
pub type Mat3 = [f64; 9];
pub(crate) type Vec6 = [f64; 6];

/// The matrix that turns nothing.
pub const IDENTITY: Mat3 = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// The inverse of a rotation.
#[inline(always)]
pub(crate) fn inverse([w, x, y, z]: Quat) -> Quat {
    [w, -x, -y, -z]
}

/// `a + b`.
#[inline(always)]
pub fn add<N: Number + Add<V, Output = N>, V: Copy>(a: [N; 3], b: [V; 3]) -> [N; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`.
#[inline(always)]
pub fn sub<N: Number>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a` times `s`.
#[inline(always)]
pub fn scale<N: Number + Mul<S, Output = N>, S: Copy>(a: [N; 3], s: S) -> [N; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// `a + s b`.
#[inline(always)]
pub fn add_scaled<N: Number>(a: [N; 3], b: [N; 3], s: N) -> [N; 3] {
    [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s]
}

/// The scalar product.
#[inline(always)]
pub fn dot<N: Number>(a: [N; 3], b: [N; 3]) -> N {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product.
#[inline(always)]
pub fn cross<N: Number>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The length.
#[inline]
pub fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// `a` scaled to length 1, and its length; `(1, 0, 0)` if it is shorter than 1e-15.
#[inline]
pub fn normalize(a: Vec3) -> (Vec3, f64) {
    unit((), a)
}

/// [`normalize`] for one world or several.
#[inline(always)]
pub(crate) fn unit<N: Number>(place: N::At, a: [N; 3]) -> ([N; 3], N) {
    let length = dot(a, a).sqrt();
    let direction = N::choose(
        length.is_below(MINVAL),
        #[inline(always)]
        || number::of(place, [1.0, 0.0, 0.0]),
        #[inline(always)]
        || scale(a, length.inverse()),
    );
    (direction, length)
}

/// Column `k` of a matrix.
#[inline(always)]
pub fn column<N: Number>(m: &[N; 9], k: usize) -> [N; 3] {
    [m[k], m[3 + k], m[6 + k]]
}

/// `m v`.
#[inline(always)]
pub fn rotate<N: Number + Mul<V, Output = N>, V: Copy>(m: &[N; 9], v: [V; 3]) -> [N; 3] {
    [
        m[0] * v[0] + m[1] * v[1] + m[2] * v[2],
        m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
        m[6] * v[0] + m[7] * v[1] + m[8] * v[2],
    ]
}

/// `m' v`.
#[inline(always)]
pub fn rotate_back<N: Number + Mul<V, Output = N>, V: Copy>(m: &[N; 9], v: [V; 3]) -> [N; 3] {
    [
        m[0] * v[0] + m[3] * v[1] + m[6] * v[2],
        m[1] * v[0] + m[4] * v[1] + m[7] * v[2],
        m[2] * v[0] + m[5] * v[1] + m[8] * v[2],
    ]
}

/// Functions of quaternions, generic over the order of the sum of four terms, which differs between
/// MuJoCo versions.
pub(crate) trait Order {
    /// The sum of the terms of a product or a square.
    fn sum<N: Number>(terms: [N; 4]) -> N;

    /// The sum of the terms of a diagonal element of a rotation matrix.
    fn sum_diagonal<N: Number>(terms: [N; 4]) -> N;

    /// The sum of the terms of element 1 of the product of a quaternion and an axis.
    fn axis_first(a: f64, b: f64, c: f64) -> f64;

    /// The sum of the terms of the last element of the product of a quaternion and an axis.
    fn axis_last(a: f64, b: f64, c: f64) -> f64;

    /// The rotation `b` followed by `a`, where `b` is given in the frame of `a`: the product `a b`.
    #[inline(always)]
    fn mul_quat<N: Number + Mul<V, Output = N>, V: Copy>(a: [N; 4], b: [V; 4]) -> [N; 4] {
        [
            Self::sum([a[0] * b[0], -a[1] * b[1], -a[2] * b[2], -a[3] * b[3]]),
            Self::sum([a[0] * b[1], a[1] * b[0], a[2] * b[3], -a[3] * b[2]]),
            Self::sum([a[0] * b[2], -a[1] * b[3], a[2] * b[0], a[3] * b[1]]),
            Self::sum([a[0] * b[3], a[1] * b[2], -a[2] * b[1], a[3] * b[0]]),
        ]
    }

    /// `q` scaled to length 1; the identity if it is shorter than [`MINVAL`].
    #[inline(always)]
    fn normalize_quat<N: Number>(place: N::At, q: [N; 4]) -> [N; 4] {
        let length = Self::sum([q[0] * q[0], q[1] * q[1], q[2] * q[2], q[3] * q[3]]).sqrt();
        N::choose(
            length.is_below(MINVAL),
            #[inline(always)]
            || number::of(place, [1.0, 0.0, 0.0, 0.0]),
            #[inline(always)]
            || {
                N::choose(
                    length.is_off(1.0, MINVAL),
                    #[inline(always)]
                    || {
                        let s = length.inverse();
                        [q[0] * s, q[1] * s, q[2] * s, q[3] * s]
                    },
                    #[inline(always)]
                    || q,
                )
            },
        )
    }

    /// The rotation matrix of a quaternion of length 1.
    #[inline(always)]
    fn quat_to_mat<N: Number>(q: [N; 4]) -> [N; 9] {
        let (q00, q11, q22, q33) = (q[0] * q[0], q[1] * q[1], q[2] * q[2], q[3] * q[3]);
        let (q01, q02, q03) = (q[0] * q[1], q[0] * q[2], q[0] * q[3]);
        let (q12, q13, q23) = (q[1] * q[2], q[1] * q[3], q[2] * q[3]);
        [
            Self::sum_diagonal([q00, q11, -q22, -q33]),
            (q12 - q03) * 2.0,
            (q13 + q02) * 2.0,
            (q12 + q03) * 2.0,
            Self::sum_diagonal([q00, -q11, q22, -q33]),
            (q23 - q01) * 2.0,
            (q13 - q02) * 2.0,
            (q23 + q01) * 2.0,
            Self::sum_diagonal([q00, -q11, -q22, q33]),
        ]
    }

    /// The rotation vector from `b` to `a`, in the frame of `b`: MuJoCo's `mju_subQuat`.
    fn sub_quat(a: Quat, b: Quat) -> Vec3 {
        quat_to_velocity(Self::mul_quat([b[0], -b[1], -b[2], -b[3]], a))
    }

    /// The quaternion after a rotation at a constant angular velocity, given in the frame of the
    /// quaternion: MuJoCo's `mju_quatIntegrate`.
    #[inline(always)]
    fn quat_integrate<N: Number>(at: N::At, q: [N; 4], velocity: [N; 3], time: f64) -> [N; 4] {
        let (axis, speed) = unit(at, velocity);
        let turn = axis_angle(at, axis, speed * time);
        Self::mul_quat(Self::normalize_quat(at, q), turn)
    }
}

/// Adds the terms from first to last: before 4.0, and the model compiler in every revision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InTurn;

/// Adds the terms in pairs: from 4.0 on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pairwise;

impl Order for InTurn {
    #[inline(always)]
    fn sum<N: Number>([a, b, c, d]: [N; 4]) -> N {
        a + b + c + d
    }

    #[inline(always)]
    fn sum_diagonal<N: Number>(terms: [N; 4]) -> N {
        Self::sum(terms)
    }

    #[inline(always)]
    fn axis_first(a: f64, b: f64, c: f64) -> f64 {
        a + b + c
    }

    #[inline(always)]
    fn axis_last(a: f64, b: f64, c: f64) -> f64 {
        a + b + c
    }
}

impl Order for Pairwise {
    #[inline(always)]
    fn sum<N: Number>([a, b, c, d]: [N; 4]) -> N {
        (a + b) + (c + d)
    }

    #[inline(always)]
    fn sum_diagonal<N: Number>([a, b, c, d]: [N; 4]) -> N {
        (a + c) + (b + d)
    }

    #[inline(always)]
    fn axis_first(a: f64, b: f64, c: f64) -> f64 {
        (a + c) + b
    }

    #[inline(always)]
    fn axis_last(a: f64, b: f64, c: f64) -> f64 {
        a + (b + c)
    }
}

/// The rotation by `angle` about `axis`, which has length 1.
#[inline(always)]
pub(crate) fn axis_angle<N: Number + Mul<V, Output = N>, V: Copy>(
    place: N::At,
    axis: [V; 3],
    angle: N,
) -> [N; 4] {
    N::choose(
        angle.is_zero(),
        #[inline(always)]
        || number::of(place, [1.0, 0.0, 0.0, 0.0]),
        #[inline(always)]
        || {
            let (s, c) = (angle * 0.5).sin_cos();
            [c, s * axis[0], s * axis[1], s * axis[2]]
        },
    )
}

/// `v` rotated by a quaternion.
#[inline(always)]
pub(crate) fn rotate_quat<N: Number>(v: Vec3, q: [N; 4]) -> [N; 3] {
    let t = [
        q[0] * v[0] + q[2] * v[2] - q[3] * v[1],
        q[0] * v[1] + q[3] * v[0] - q[1] * v[2],
        q[0] * v[2] + q[1] * v[1] - q[2] * v[0],
    ];
    let c = cross([q[1], q[2], q[3]], t);
    [c[0] * 2.0 + v[0], c[1] * 2.0 + v[1], c[2] * 2.0 + v[2]]
}

/// The rotation vector of a quaternion: MuJoCo's `mju_quat2Vel` for a time of 1.
pub(crate) fn quat_to_velocity(d: Quat) -> Vec3 {
    let (axis, sine) = normalize([d[1], d[2], d[3]]);
    let mut angle = 2.0 * libm::atan2(sine, d[0]);
    if angle > std::f64::consts::PI {
        angle -= 2.0 * std::f64::consts::PI;
    }
    scale(axis, angle)
}

#[inline(always)]
pub(crate) fn rotation<N: Number>(v: &[N; 6]) -> [N; 3] {
    [v[0], v[1], v[2]]
}

#[inline(always)]
pub(crate) fn translation<N: Number>(v: &[N; 6]) -> [N; 3] {
    [v[3], v[4], v[5]]
}

#[inline(always)]
pub(crate) fn join<N: Number>(rotation: [N; 3], translation: [N; 3]) -> [N; 6] {
    let ([a, b, c], [x, y, z]) = (rotation, translation);
    [a, b, c, x, y, z]
}

/// Both parts of a vector in the axes of `m`.
#[inline(always)]
pub(crate) fn rotate_back6<N: Number>(m: &[N; 9], v: &[N; 6]) -> [N; 6] {
    join(rotate_back(m, rotation(v)), rotate_back(m, translation(v)))
}

/// The product of two vectors, in the order of [`dense::dot`](super::dense::dot).
#[inline(always)]
pub(crate) fn dot6<N: Number>(a: &[N; 6], b: &[N; 6]) -> N {
    ((a[0] * b[0] + a[2] * b[2]) + (a[1] * b[1] + a[3] * b[3])) + (a[4] * b[4] + a[5] * b[5])
}

/// `a += s b`.
#[inline(always)]
pub(crate) fn add_to<N: Number + Mul<S, Output = N>, S: Copy>(a: &mut [N; 6], b: &[N; 6], s: S) {
    for k in 0..6 {
        a[k] = a[k] + b[k] * s;
    }
}

/// Cross product of two motions: MuJoCo's `mju_crossMotion`.
#[inline(always)]
pub(crate) fn cross_motion<N: Number>(v: &[N; 6], s: &[N; 6]) -> [N; 6] {
    let w = rotation(v);
    let moves = add(cross(w, translation(s)), cross(translation(v), rotation(s)));
    join(cross(w, rotation(s)), moves)
}

/// Cross product of a motion and a force: MuJoCo's `mju_crossForce`.
#[inline(always)]
pub(crate) fn cross_force<N: Number>(v: &[N; 6], f: &[N; 6]) -> [N; 6] {
    let w = rotation(v);
    let torque = add(cross(w, rotation(f)), cross(translation(v), translation(f)));
    join(torque, cross(w, translation(f)))
}

/// The momentum of the inertia `i` that moves with `v`: MuJoCo's `mju_mulInertVec`.
#[inline(always)]
pub(crate) fn mul_inertia<N: Number>(i: &[N; 10], v: &[N; 6]) -> [N; 6] {
    [
        i[0] * v[0] + i[3] * v[1] + i[4] * v[2] - i[8] * v[4] + i[7] * v[5],
        i[3] * v[0] + i[1] * v[1] + i[5] * v[2] + i[8] * v[3] - i[6] * v[5],
        i[4] * v[0] + i[5] * v[1] + i[2] * v[2] - i[7] * v[3] + i[6] * v[4],
        i[8] * v[1] - i[7] * v[2] + i[9] * v[3],
        i[6] * v[2] - i[8] * v[0] + i[9] * v[4],
        i[7] * v[0] - i[6] * v[1] + i[9] * v[5],
    ]
}

/// The spatial inertia of a body with principal moments about the axes `mat`, at an offset from the
/// reference point: xx, yy, zz, xy, xz, yz, mass times offset (3), mass. MuJoCo's `mju_inertCom`.
#[inline(always)]
pub(crate) fn inertia_at<N: Number>(
    place: N::At,
    moments: Vec3,
    mat: &[N; 9],
    offset: [N; 3],
    mass: f64,
) -> [N; 10] {
    // as in MuJoCo, a moment is first multiplied with the element of row `j`: the order decides the
    // rounding
    let (r,) = (
        #[inline(always)]
        |i: usize, j: usize| {
            mat[3 * i] * (mat[3 * j] * moments[0])
                + mat[3 * i + 1] * (mat[3 * j + 1] * moments[1])
                + mat[3 * i + 2] * (mat[3 * j + 2] * moments[2])
        },
    );
    let d = offset;
    [
        r(0, 0) + (d[1] * d[1] + d[2] * d[2]) * mass,
        r(1, 1) + (d[0] * d[0] + d[2] * d[2]) * mass,
        r(2, 2) + (d[0] * d[0] + d[1] * d[1]) * mass,
        r(0, 1) - d[0] * mass * d[1],
        r(0, 2) - d[0] * mass * d[2],
        r(1, 2) - d[1] * mass * d[2],
        d[0] * mass,
        d[1] * mass,
        d[2] * mass,
        N::of(place, mass),
    ]
}

/// The motion `v` about another reference point: MuJoCo's `mju_transformSpatial`.
#[inline(always)]
pub(crate) fn transform_motion<N: Number>(v: &[N; 6], to: [N; 3], from: [N; 3]) -> [N; 6] {
    let across = cross(sub(to, from), rotation(v));
    join(rotation(v), sub(translation(v), across))
}

/// The force `f` about another reference point: MuJoCo's `mju_transformSpatial`.
#[inline]
pub(crate) fn transform_force(f: &Vec6, to: Vec3, from: Vec3) -> Vec6 {
    let across = cross(sub(to, from), translation(f));
    join(sub(rotation(f), across), translation(f))
}

/// The velocity of a point, given the velocity about a reference point and the offset between them.
#[inline(always)]
pub(crate) fn velocity_at<N: Number>(v: &[N; 6], offset: [N; 3]) -> [N; 3] {
    add(translation(v), cross(rotation(v), offset))
}
