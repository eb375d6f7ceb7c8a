//! The transcendental functions of the engine, in one place: their bits decide whether two platforms agree.

/// Sine and cosine of an angle in radians.
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    x.sin_cos()
}

/// The angle whose tangent is `y / x`, in the quadrant of the point.
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    y.atan2(x)
}

/// `x` to the power `y`.
pub(crate) fn pow(x: f64, y: f64) -> f64 {
    x.powf(y)
}
