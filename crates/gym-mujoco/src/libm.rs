//! The transcendental functions of the engine, in one place: the same bits on every platform.

pub(crate) use gym_core::math::{atan2, exp, pow, sin_cos, with as wide};

/// The angle of a cosine.
pub(crate) fn acos(x: f64) -> f64 {
    atan2(((1.0 - x) * (1.0 + x)).max(0.0).sqrt(), x)
}

/// The angle of a sine.
pub(crate) fn asin(x: f64) -> f64 {
    atan2(x, ((1.0 - x) * (1.0 + x)).max(0.0).sqrt())
}
