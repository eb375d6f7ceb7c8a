//! The exponential function, after ARM's optimized routines (`exp.c`, MIT), which glibc uses.

use super::Fma;
use super::tables::EXP;

/// 128 / ln 2.
const INVERSE: f64 = f64::from_bits(0x3ff7_1547_652b_82fe) * 128.0;
/// -ln 2 / 128 in two parts.
const MINUS_LN2: [f64; 2] = [
    f64::from_bits(0xbf76_2e42_fefa_0000),
    f64::from_bits(0xbd0c_f79a_bc9e_3b3a),
];
/// Adding and subtracting this number rounds to the nearest integer: 1.5 * 2^52.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// The coefficients of x^2 to x^5 in the approximation of e^x for |x| <= ln 2 / 256.
const C: [f64; 4] = [
    f64::from_bits(0x3fdf_ffff_ffff_fdbd),
    f64::from_bits(0x3fc5_5555_5555_543c),
    f64::from_bits(0x3fa5_5555_cf17_2b91),
    f64::from_bits(0x3f81_1111_67a4_d017),
];

/// Returns e^x.
#[inline(always)]
pub(super) fn exp<F: Fma>(x: f64) -> f64 {
    let magnitude = x.abs();
    if magnitude >= 1024.0 || magnitude.is_nan() {
        return beyond(x);
    }
    if magnitude < 2f64.powi(-54) {
        return 1.0 + x;
    }
    let Parts { scale, k, fraction } = Parts::new::<F>(x, 0.0);
    if magnitude < 512.0 {
        let scale = f64::from_bits(scale);
        return F::fma(scale, fraction, scale);
    }
    if k < 0 {
        small(scale, fraction)
    } else {
        large::<F>(scale, fraction)
    }
}

/// Returns e^x for `x` with a magnitude of 1024 or more, and for NaN.
#[cold]
fn beyond(x: f64) -> f64 {
    if x < 0.0 { 0.0 } else { x + f64::INFINITY }
}

/// e^(x + rest) as 2^(k / 128) (1 + fraction). `scale` has the bits of 2^(k / 128); its exponent
/// may overflow.
pub(super) struct Parts {
    pub(super) scale: u64,
    pub(super) k: i64,
    pub(super) fraction: f64,
}

impl Parts {
    #[inline(always)]
    pub(super) fn new<F: Fma>(x: f64, rest: f64) -> Self {
        let shifted = INVERSE * x + ROUND;
        let bits = shifted.to_bits();
        let k = shifted - ROUND;
        let r = F::fma(k, MINUS_LN2[1], F::fma(k, MINUS_LN2[0], x)) + rest;
        let [tail, high] = EXP[bits as usize & 127];
        let r2 = r * r;
        let low = F::fma(r2, F::fma(r, C[1], C[0]), f64::from_bits(tail) + r);
        Self {
            scale: high.wrapping_add(bits << 45),
            k: k as i64,
            fraction: F::fma(r2 * r2, F::fma(r, C[3], C[2]), low),
        }
    }
}

/// Returns `scale * (1 + fraction)`, for results that may overflow.
#[cold]
pub(super) fn large<F: Fma>(scale: u64, fraction: f64) -> f64 {
    let scale = f64::from_bits(scale.wrapping_sub(1009 << 52));
    2f64.powi(1009) * F::fma(scale, fraction, scale)
}

/// Returns `scale * (1 + fraction)`, for results that may be subnormal; `scale` may be negative.
/// The result is rounded once, to its final number of digits. (glibc's compiler does not use FMA
/// here.)
#[cold]
pub(super) fn small(scale: u64, fraction: f64) -> f64 {
    let scale = f64::from_bits(scale.wrapping_add(1022 << 52));
    let part = scale * fraction;
    let mut y = scale + part;
    if y.abs() < 1.0 {
        let one = 1f64.copysign(y);
        let low = scale - y + part;
        let high = one + y;
        let low = one - high + y + low;
        y = (high + low) - one;
        if y == 0.0 {
            y = 0f64.copysign(scale);
        }
    }
    f64::MIN_POSITIVE * y
}
