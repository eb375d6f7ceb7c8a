//! The transcendental functions of the engine, all in one file: the same bits on every platform.

use gym_numerics::math;

pub(crate) use gym_numerics::math::{atan2, exp, pow, sin_cos, with as wide};

/// The arc cosine; rounding may have taken the argument out of ±1.
pub(crate) fn acos(x: f64) -> f64 {
    math::acos(x.clamp(-1.0, 1.0))
}

/// The arc sine; rounding may have taken the argument out of ±1.
pub(crate) fn asin(x: f64) -> f64 {
    math::asin(x.clamp(-1.0, 1.0))
}
