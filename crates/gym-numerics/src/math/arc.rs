//! The arc tangent of a quotient, and the arc sine and cosine, computed with twice the precision of
//! their results.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::Fma;
use super::tables::SIN_COS;

/// The rounding errors of the constants π and π/2.
const PI_REST: f64 = 1.224_646_799_147_353_2e-16;
const HALF_PI_REST: f64 = PI_REST / 2.0;

/// Returns a product and its rounding error.
#[inline(always)]
fn product<F: Fma>(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, F::fma(a, b, -product))
}

/// Returns the sum and its rounding error; `a` must not be smaller than `b`.
#[inline(always)]
fn sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, a - sum + b)
}

#[inline(always)]
pub(super) fn atan2<F: Fma>(y: f64, x: f64) -> f64 {
    if x.is_nan() || y.is_nan() {
        return x + y;
    }
    let (angle, rest) = angle_of::<F>(y, x);
    (angle + rest).copysign(y)
}

#[inline(always)]
pub(super) fn acos<F: Fma>(x: f64) -> f64 {
    let (root, root_rest) = other_side::<F>(x);
    let (angle, rest) = angle_of::<F>(root, x);
    angle + (rest + x * root_rest)
}

#[inline(always)]
pub(super) fn asin<F: Fma>(x: f64) -> f64 {
    let (root, root_rest) = other_side::<F>(x);
    let (angle, rest) = angle_of::<F>(x, root);
    (angle + (rest - x.abs() * root_rest)).copysign(x)
}

/// Returns the square root of `1 - x * x` in two parts; NaN outside of ±1.
#[inline(always)]
fn other_side<F: Fma>(x: f64) -> (f64, f64) {
    let (square, square_rest) = product::<F>(x, x);
    let (difference, low) = sum(1.0, -square);
    let (difference, low) = sum(difference, low - square_rest);
    let root = difference.sqrt();
    if root == 0.0 {
        return (0.0, 0.0);
    }
    (root, (F::fma(-root, root, difference) + low) / (2.0 * root))
}

/// Returns the angle of the point `(x, |y|)` in two parts.
#[inline(always)]
fn angle_of<F: Fma>(y: f64, x: f64) -> (f64, f64) {
    let (ax, ay) = (x.abs(), y.abs());
    let steep = ay > ax;
    let (low, high) = if steep { (ax, ay) } else { (ay, ax) };
    let (angle, rest) = if low == 0.0 {
        (0.0, 0.0)
    } else if high == f64::INFINITY {
        (
            if low == f64::INFINITY { FRAC_PI_4 } else { 0.0 },
            HALF_PI_REST / 2.0 * f64::from(low == high),
        )
    } else {
        slope::<F>(low, high)
    };
    let (angle, rest) = if steep {
        turned(FRAC_PI_2, HALF_PI_REST, angle, rest)
    } else {
        (angle, rest)
    };
    if x.is_sign_negative() {
        turned(PI, PI_REST, angle, rest)
    } else {
        (angle, rest)
    }
}

/// Returns `(from + from_rest) - (angle + rest)` as a sum of two numbers.
#[inline(always)]
fn turned(from: f64, from_rest: f64, angle: f64, rest: f64) -> (f64, f64) {
    let (difference, low) = sum(from, -angle);
    (difference, low + (from_rest - rest))
}

/// Returns the arc tangent of `low / high`, which is in (0, 1], in two parts. A rotation by a
/// multiple of 1/128 leaves a small angle, for which a short series suffices.
#[inline(always)]
fn slope<F: Fma>(low: f64, high: f64) -> (f64, f64) {
    // scale both near 1, so that no product overflows or underflows
    let scale = 2f64.powi(1023 - ((high.to_bits() >> 52) as i32).clamp(1, 2045));
    let (low, high) = (low * scale, high * scale);
    let q = low / high;
    let near = q * (FRAC_PI_4 + 0.273 * (1.0 - q));
    let k = (near * 128.0) as usize & 127;
    let [sin, sin_rest, cos, cos_rest] = SIN_COS[k];
    // across / along is the tangent of the remaining angle
    let ((a, a_low), (b, b_low)) = (product::<F>(low, cos), product::<F>(high, sin));
    let across = a - b;
    let across_low = (a - across - b) + (a_low - b_low) + (low * cos_rest - high * sin_rest);
    let ((c, c_low), (d, d_low)) = (product::<F>(high, cos), product::<F>(low, sin));
    let (along, along_low) = sum(c, d);
    let along_low = along_low + c_low + d_low + high * cos_rest + low * sin_rest;
    let (across, across_low) = sum(across, across_low);
    let t = across / along;
    let t_low = (F::fma(-t, along, across) + (across_low - t * along_low)) / along;
    let square = t * t;
    let series = [1.0 / 11.0, -1.0 / 9.0, 1.0 / 7.0, -0.2, 1.0 / 3.0];
    let cubic = -t
        * square
        * series
            .iter()
            .fold(-1.0 / 13.0, |sum: f64, c| F::fma(sum, square, *c));
    if k == 0 {
        return (t, t_low + cubic);
    }
    let (angle, rest) = sum(k as f64 / 128.0, t);
    (angle, rest + (t_low + cubic))
}
