//! The transcendental functions of the engine, all in one file: the same bits on every platform.

pub(crate) use gym_numerics::math::{atan2, exp, pow, sin_cos, with as wide};

/// The arc cosine.
pub(crate) fn acos(x: f64) -> f64 {
    atan2(((1.0 - x) * (1.0 + x)).max(0.0).sqrt(), x)
}

/// The arc sine.
pub(crate) fn asin(x: f64) -> f64 {
    atan2(x, ((1.0 - x) * (1.0 + x)).max(0.0).sqrt())
}
