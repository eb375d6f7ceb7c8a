//! Numbers, vectors, quaternions and matrices, with the roundings of libmujoco.
//!
//! A quaternion is `w, x, y, z`. A matrix is row-major.

pub(crate) mod axes;
pub(crate) mod dense;
pub(crate) mod libm;
pub(crate) mod number;
pub(crate) mod spatial;

pub use spatial::{
    IDENTITY, Mat3, Quat, Vec3, add, add_scaled, column, cross, dot, norm, normalize, rotate,
    rotate_back, scale, sub,
};

use spatial::{InTurn, Order};

/// The largest size of positions, velocities and forces: MuJoCo's `mjMAXVAL`. A state beyond it
/// counts as diverged.
pub const MAXVAL: f64 = 1e10;

/// The product of two quaternions, with the terms added from first to last.
#[must_use]
pub fn mul_quat(a: Quat, b: Quat) -> Quat {
    InTurn::mul_quat(a, b)
}

/// A quaternion scaled to length 1; `1, 0, 0, 0` if it is shorter than 1e-15.
#[must_use]
pub fn normalize_quat(quat: Quat) -> Quat {
    InTurn::normalize_quat((), quat)
}

/// The rotation matrix of a quaternion of length 1.
#[must_use]
pub fn quat_to_mat(quat: Quat) -> Mat3 {
    InTurn::quat_to_mat(quat)
}
