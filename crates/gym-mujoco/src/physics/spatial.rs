//! Vectors, quaternions, rotation matrices and six-dimensional vectors: MuJoCo's
//! `engine_util_spatial`.
//!
//! A quaternion is `w, x, y, z`. A matrix is row-major. A six-dimensional vector is rotation, then
//! translation.

use crate::libm;

/// Lengths below this count as zero: MuJoCo's `mjMINVAL`.
pub(crate) const MINVAL: f64 = 1e-15;

pub(crate) type Vec3 = [f64; 3];
pub(crate) type Quat = [f64; 4];
pub(crate) type Mat3 = [f64; 9];
pub(crate) type Vec6 = [f64; 6];
/// An inertia about some point: xx, yy, zz, xy, xz, yz, mass times offset (3), mass.
pub(crate) type Inertia = [f64; 10];

pub(crate) const IDENTITY: Mat3 = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

#[inline]
pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(crate) fn scale(a: Vec3, s: f64) -> Vec3 {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// `a + s b`.
#[inline]
pub(crate) fn add_scaled(a: Vec3, b: Vec3, s: f64) -> Vec3 {
    [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s]
}

#[inline]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline]
pub(crate) fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// The vector at length 1, and its length before; `(1, 0, 0)` for one shorter than [`MINVAL`].
#[inline]
pub(crate) fn normalize(a: Vec3) -> (Vec3, f64) {
    let length = norm(a);
    if length < MINVAL {
        ([1.0, 0.0, 0.0], length)
    } else {
        (scale(a, 1.0 / length), length)
    }
}

/// Column `k` of a matrix.
#[inline]
pub(crate) fn column(m: &Mat3, k: usize) -> Vec3 {
    [m[k], m[3 + k], m[6 + k]]
}

/// `m v`.
#[inline]
pub(crate) fn rotate(m: &Mat3, v: Vec3) -> Vec3 {
    [
        m[0] * v[0] + m[1] * v[1] + m[2] * v[2],
        m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
        m[6] * v[0] + m[7] * v[1] + m[8] * v[2],
    ]
}

/// `m' v`.
#[inline]
pub(crate) fn rotate_back(m: &Mat3, v: Vec3) -> Vec3 {
    [
        m[0] * v[0] + m[3] * v[1] + m[6] * v[2],
        m[1] * v[0] + m[4] * v[1] + m[7] * v[2],
        m[2] * v[0] + m[5] * v[1] + m[8] * v[2],
    ]
}

/// The order in which functions of quaternions add four terms: it differs between revisions.
pub(crate) trait Order {
    /// The sum of the terms of a product or a square.
    fn sum(terms: [f64; 4]) -> f64;

    /// The sum of the terms of an element on the diagonal of a rotation matrix.
    fn sum_diagonal(terms: [f64; 4]) -> f64;

    /// The sum of the terms of the second element of the product with an axis.
    fn axis_first(a: f64, b: f64, c: f64) -> f64;

    /// The sum of the terms of its last element.
    fn axis_last(a: f64, b: f64, c: f64) -> f64;
}

/// One after the other: [`Revision::V3_12`](crate::Revision::V3_12), and the compiler of models in
/// every revision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InTurn;

/// By pairs: [`Revision::V4_0`](crate::Revision::V4_0).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pairwise;

impl Order for InTurn {
    #[inline(always)]
    fn sum([a, b, c, d]: [f64; 4]) -> f64 {
        a + b + c + d
    }

    #[inline(always)]
    fn sum_diagonal(terms: [f64; 4]) -> f64 {
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
    fn sum([a, b, c, d]: [f64; 4]) -> f64 {
        (a + b) + (c + d)
    }

    #[inline(always)]
    fn sum_diagonal([a, b, c, d]: [f64; 4]) -> f64 {
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

/// The rotation `a`, after the rotation `b` in its frame.
#[inline]
pub(crate) fn mul_quat<O: Order>(a: Quat, b: Quat) -> Quat {
    [
        O::sum([a[0] * b[0], -a[1] * b[1], -a[2] * b[2], -a[3] * b[3]]),
        O::sum([a[0] * b[1], a[1] * b[0], a[2] * b[3], -a[3] * b[2]]),
        O::sum([a[0] * b[2], -a[1] * b[3], a[2] * b[0], a[3] * b[1]]),
        O::sum([a[0] * b[3], a[1] * b[2], -a[2] * b[1], a[3] * b[0]]),
    ]
}

/// The quaternion at length 1; the identity for one shorter than [`MINVAL`].
#[inline]
pub(crate) fn normalize_quat<O: Order>(q: Quat) -> Quat {
    let length = O::sum(q.map(|x| x * x)).sqrt();
    if length < MINVAL {
        [1.0, 0.0, 0.0, 0.0]
    } else if (length - 1.0).abs() > MINVAL {
        let s = 1.0 / length;
        [q[0] * s, q[1] * s, q[2] * s, q[3] * s]
    } else {
        q
    }
}

/// The rotation by `angle` about `axis`, which has length 1.
#[inline]
pub(crate) fn axis_angle(axis: Vec3, angle: f64) -> Quat {
    if angle == 0.0 {
        return [1.0, 0.0, 0.0, 0.0];
    }
    let (s, c) = libm::sin_cos(angle * 0.5);
    [c, axis[0] * s, axis[1] * s, axis[2] * s]
}

/// `v` rotated by a quaternion.
#[inline]
pub(crate) fn rotate_quat(v: Vec3, q: Quat) -> Vec3 {
    let t = [
        q[0] * v[0] + q[2] * v[2] - q[3] * v[1],
        q[0] * v[1] + q[3] * v[0] - q[1] * v[2],
        q[0] * v[2] + q[1] * v[1] - q[2] * v[0],
    ];
    let c = cross([q[1], q[2], q[3]], t);
    [v[0] + 2.0 * c[0], v[1] + 2.0 * c[1], v[2] + 2.0 * c[2]]
}

/// The rotation matrix of a quaternion of length 1.
#[inline]
pub(crate) fn quat_to_mat<O: Order>(q: Quat) -> Mat3 {
    let (q00, q11, q22, q33) = (q[0] * q[0], q[1] * q[1], q[2] * q[2], q[3] * q[3]);
    let (q01, q02, q03) = (q[0] * q[1], q[0] * q[2], q[0] * q[3]);
    let (q12, q13, q23) = (q[1] * q[2], q[1] * q[3], q[2] * q[3]);
    [
        O::sum_diagonal([q00, q11, -q22, -q33]),
        2.0 * (q12 - q03),
        2.0 * (q13 + q02),
        2.0 * (q12 + q03),
        O::sum_diagonal([q00, -q11, q22, -q33]),
        2.0 * (q23 - q01),
        2.0 * (q13 - q02),
        2.0 * (q23 + q01),
        O::sum_diagonal([q00, -q11, -q22, q33]),
    ]
}

/// The rotation vector that leads from `b` to `a`, in the frame of `b`: MuJoCo's `mju_subQuat`.
pub(crate) fn sub_quat<O: Order>(a: Quat, b: Quat) -> Vec3 {
    quat_to_velocity(mul_quat::<O>([b[0], -b[1], -b[2], -b[3]], a))
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

/// The quaternion moved by an angular velocity, in its own frame, for some time: MuJoCo's
/// `mju_quatIntegrate`.
pub(crate) fn quat_integrate<O: Order>(q: Quat, velocity: Vec3, time: f64) -> Quat {
    let (axis, speed) = normalize(velocity);
    mul_quat::<O>(normalize_quat::<O>(q), axis_angle(axis, time * speed))
}

#[inline]
pub(crate) fn rotation(v: &Vec6) -> Vec3 {
    [v[0], v[1], v[2]]
}

#[inline]
pub(crate) fn translation(v: &Vec6) -> Vec3 {
    [v[3], v[4], v[5]]
}

#[inline]
pub(crate) fn join(rotation: Vec3, translation: Vec3) -> Vec6 {
    [
        rotation[0],
        rotation[1],
        rotation[2],
        translation[0],
        translation[1],
        translation[2],
    ]
}

/// The product of two vectors, in the order of [`dense::dot`](super::dense::dot).
#[inline]
pub(crate) fn dot6(a: &Vec6, b: &Vec6) -> f64 {
    ((a[0] * b[0] + a[2] * b[2]) + (a[1] * b[1] + a[3] * b[3])) + (a[4] * b[4] + a[5] * b[5])
}

/// `a += s b`.
#[inline]
pub(crate) fn add_to(a: &mut Vec6, b: &Vec6, s: f64) {
    for k in 0..6 {
        a[k] += b[k] * s;
    }
}

/// Cross product of two motions: MuJoCo's `mju_crossMotion`.
#[inline]
pub(crate) fn cross_motion(v: &Vec6, s: &Vec6) -> Vec6 {
    let w = rotation(v);
    join(
        cross(w, rotation(s)),
        add(cross(w, translation(s)), cross(translation(v), rotation(s))),
    )
}

/// Cross product of a motion and a force: MuJoCo's `mju_crossForce`.
#[inline]
pub(crate) fn cross_force(v: &Vec6, f: &Vec6) -> Vec6 {
    let w = rotation(v);
    join(
        add(cross(w, rotation(f)), cross(translation(v), translation(f))),
        cross(w, translation(f)),
    )
}

/// The force that gives an inertia the motion `v`: MuJoCo's `mju_mulInertVec`.
#[inline]
pub(crate) fn mul_inertia(i: &Inertia, v: &Vec6) -> Vec6 {
    [
        i[0] * v[0] + i[3] * v[1] + i[4] * v[2] - i[8] * v[4] + i[7] * v[5],
        i[3] * v[0] + i[1] * v[1] + i[5] * v[2] + i[8] * v[3] - i[6] * v[5],
        i[4] * v[0] + i[5] * v[1] + i[2] * v[2] - i[7] * v[3] + i[6] * v[4],
        i[8] * v[1] - i[7] * v[2] + i[9] * v[3],
        i[6] * v[2] - i[8] * v[0] + i[9] * v[4],
        i[7] * v[0] - i[6] * v[1] + i[9] * v[5],
    ]
}

/// Principal moments about axes `mat`, at an offset from the point of reference: MuJoCo's
/// `mju_inertCom`.
#[inline]
pub(crate) fn inertia_at(moments: Vec3, mat: &Mat3, offset: Vec3, mass: f64) -> Inertia {
    // the moments multiply the second factor
    let r = |i: usize, j: usize| {
        mat[3 * i] * (mat[3 * j] * moments[0])
            + mat[3 * i + 1] * (mat[3 * j + 1] * moments[1])
            + mat[3 * i + 2] * (mat[3 * j + 2] * moments[2])
    };
    let d = offset;
    [
        r(0, 0) + mass * (d[1] * d[1] + d[2] * d[2]),
        r(1, 1) + mass * (d[0] * d[0] + d[2] * d[2]),
        r(2, 2) + mass * (d[0] * d[0] + d[1] * d[1]),
        r(0, 1) - mass * d[0] * d[1],
        r(0, 2) - mass * d[0] * d[2],
        r(1, 2) - mass * d[1] * d[2],
        mass * d[0],
        mass * d[1],
        mass * d[2],
        mass,
    ]
}

/// A motion about another point: MuJoCo's `mju_transformSpatial`.
#[inline]
pub(crate) fn transform_motion(v: &Vec6, to: Vec3, from: Vec3) -> Vec6 {
    let across = cross(sub(to, from), rotation(v));
    join(rotation(v), sub(translation(v), across))
}

/// A force about another point: MuJoCo's `mju_transformSpatial`.
#[inline]
pub(crate) fn transform_force(f: &Vec6, to: Vec3, from: Vec3) -> Vec6 {
    let across = cross(sub(to, from), translation(f));
    join(sub(rotation(f), across), translation(f))
}

/// The velocity of a point, given the velocity about a reference point and the offset between them.
#[inline]
pub(crate) fn velocity_at(v: &Vec6, offset: Vec3) -> Vec3 {
    add(translation(v), cross(rotation(v), offset))
}
