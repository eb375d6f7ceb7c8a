//! Powers, after ARM's optimized routines (`pow.c`, `powf.c`, MIT), which glibc uses.

use super::exp::{Parts, large, small};
use super::log::LN2;
use super::tables::{EXP2F, POW_LOG, POWF_LOG2};
use super::{Fma, Real};

/// The start of the octave to which arguments are reduced.
const START: u64 = 0x3fe6_9555_0000_0000;
/// Coefficients of x^2 to x^8 of ln(1 + x), for |x| <= 1 / 128, scaled by powers of -2.
const A: [f64; 7] = [
    -0.5,
    f64::from_bits(0x3fd5_5555_5555_5560) * -2.0,
    f64::from_bits(0xbfd0_0000_0000_0006) * -2.0,
    f64::from_bits(0x3fc9_9999_9959_554e) * 4.0,
    f64::from_bits(0xbfc5_5555_5529_a47a) * 4.0,
    f64::from_bits(0x3fc2_495b_9b48_45e9) * -8.0,
    f64::from_bits(0xbfc0_002b_8b26_3fc3) * -8.0,
];

/// Returns the logarithm, in two parts, of the positive normal number with the given bits. (A
/// subnormal argument is normalized first, so its exponent is 0 or negative.)
#[inline(always)]
fn ln<F: Fma>(bits: u64) -> (f64, f64) {
    let offset = bits.wrapping_sub(START);
    let [reciprocal, log, log_rest] = POW_LOG[(offset >> 45) as usize & 127];
    let k = (offset.cast_signed() >> 52) as f64;
    let z = f64::from_bits(bits.wrapping_sub(offset & 0xfff << 52));
    let r = F::fma(z, reciprocal, -1.0);
    let t1 = F::fma(k, LN2[0], log);
    let t2 = t1 + r;
    let low1 = F::fma(k, LN2[1], log_rest);
    let low2 = t1 - t2 + r;
    let ar = A[0] * r;
    let ar2 = r * ar;
    let ar3 = r * ar2;
    let high = t2 + ar2;
    let low3 = F::fma(ar, r, -ar2);
    let low4 = t2 - high + ar2;
    let pair = |i: usize| F::fma(r, A[i + 1], A[i]);
    let p = F::fma(ar2, F::fma(ar2, pair(5), pair(3)), pair(1));
    let low = F::fma(ar3, p, low1 + low2 + low3 + low4);
    let sum = high + low;
    (sum, high - sum + low)
}

/// Returns e^(x + rest), or its negative.
#[inline(always)]
fn exp<F: Fma>(x: f64, rest: f64, negative: bool) -> f64 {
    let sign = if negative { -1.0 } else { 1.0 };
    let magnitude = x.abs();
    if magnitude < 2f64.powi(-54) {
        return sign * (1.0 + x);
    }
    if magnitude >= 1024.0 {
        return sign * if x < 0.0 { 0.0 } else { f64::INFINITY };
    }
    let Parts { scale, k, fraction } = Parts::new::<F>(x, rest);
    // an exponent that overflows changes the sign bit
    let scale = scale.wrapping_add(u64::from(negative) << 63);
    if magnitude < 512.0 {
        let scale = f64::from_bits(scale);
        F::fma(scale, fraction, scale)
    } else if k < 0 {
        small(scale, fraction)
    } else {
        large::<F>(scale, fraction)
    }
}

/// Returns x^y.
#[inline(always)]
pub(super) fn pow<F: Fma>(x: f64, y: f64) -> f64 {
    let magnitude = y.abs();
    let plain = (f64::MIN_POSITIVE..f64::INFINITY).contains(&x)
        && (2f64.powi(-65)..2f64.powi(63)).contains(&magnitude);
    if plain {
        positive::<F>(x.to_bits(), y, false)
    } else {
        special::<F>(x, y)
    }
}

#[inline(always)]
fn positive<F: Fma>(bits: u64, y: f64, negative: bool) -> f64 {
    let (high, low) = ln::<F>(bits);
    let product = y * high;
    let rest = F::fma(y, low, F::fma(y, high, -product));
    exp::<F>(product, rest, negative)
}

/// Handles all arguments except two normal numbers of which `x` is positive.
#[cold]
#[inline(never)]
fn special<F: Fma>(x: f64, y: f64) -> f64 {
    if y == 0.0 || x == 1.0 {
        return 1.0;
    }
    if x.is_nan() || y.is_nan() {
        return x + y;
    }
    let magnitude = x.abs();
    if y.is_infinite() {
        return match magnitude.partial_cmp(&1.0) {
            Some(std::cmp::Ordering::Equal) => 1.0,
            Some(order) if (order == std::cmp::Ordering::Greater) == (y > 0.0) => f64::INFINITY,
            _ => 0.0,
        };
    }
    let odd = y % 2.0 != 0.0 && y % 1.0 == 0.0;
    let sign = if odd { 1f64.copysign(x) } else { 1.0 };
    if x == 0.0 || x.is_infinite() {
        let grows = x.is_infinite() == (y > 0.0);
        return sign * if grows { f64::INFINITY } else { 0.0 };
    }
    if x < 0.0 && y % 1.0 != 0.0 {
        return f64::NAN;
    }
    if y.abs() >= 2f64.powi(63) {
        // such a `y` is an even number
        return if magnitude == 1.0 {
            1.0
        } else if (magnitude > 1.0) == (y > 0.0) {
            f64::INFINITY
        } else {
            0.0
        };
    }
    if y.abs() < 2f64.powi(-65) {
        return if x > 1.0 { 1.0 + y } else { 1.0 - y };
    }
    let bits = if magnitude < f64::MIN_POSITIVE {
        (magnitude * 2f64.powi(52)).to_bits().wrapping_sub(52 << 52)
    } else {
        magnitude.to_bits()
    };
    positive::<F>(bits, y, sign < 0.0)
}

/// Returns the C library's `pow(x, 2)`, whose error is at most 0.511 ulp. The result is the rounded
/// product, unless the exact square is so close to a tie that `pow` may return the other adjacent
/// number.
#[inline(always)]
pub(super) fn square<R: Real>(x: R) -> R {
    /// The largest error of the product, in ulp, for which `pow` is certain to return the product.
    const SURE: f64 = 0.489 * f64::EPSILON;
    let product = x * x;
    let rest = x.fma(x, -product).abs();
    let sure = rest.lt(product.exponent() * SURE)
        & product.same(1e-280).lt(product)
        & product.lt(product.same(f64::INFINITY));
    if R::all(sure) {
        product
    } else {
        product.repair_unless(sure, x, square_in_full)
    }
}

/// Returns the C library's `powf(x, 2)`; `x` must be representable in `f32`, and so is the result.
#[inline(always)]
pub(super) fn square_f32<R: Real>(x: R) -> R {
    /// The largest error of the product, in ulp of `f32`, for which `powf` is certain to return the
    /// product.
    const SURE: f64 = 0.495 * f32::EPSILON as f64;
    let exact = x * x;
    let product = exact.single();
    let rest = (exact - product).abs();
    let sure = rest.lt(product.exponent() * SURE)
        & product.same(1e-30).lt(product)
        & product.lt(product.same(1e30));
    if R::all(sure) {
        product
    } else {
        product.repair_unless(sure, x, square_f32_in_full)
    }
}

#[cold]
#[inline(never)]
fn square_in_full(x: f64) -> f64 {
    super::pow(x, 2.0)
}

#[cold]
#[inline(never)]
fn square_f32_in_full(x: f64) -> f64 {
    f64::from(super::square_f32(x as f32))
}

/// Coefficients of x^5 to x^1 of log2(1 + x), for |x| <= 1 / 16.
const LOG2: [f64; 5] = [
    f64::from_bits(0x3fd2_7616_c949_6e0b),
    f64::from_bits(0xbfd7_1969_a075_c67a),
    f64::from_bits(0x3fde_c70a_6ca7_badd),
    f64::from_bits(0xbfe7_1547_48be_f6c8),
    f64::from_bits(0x3ff7_1547_652a_b82b),
];
/// Coefficients of x^3 to x^1 of 2^x, for |x| <= 1 / 64.
const EXP2: [f64; 3] = [
    f64::from_bits(0x3fac_6af8_4b91_2394),
    f64::from_bits(0x3fce_bfce_50fa_c4f3),
    f64::from_bits(0x3fe6_2e42_ff0c_52d6),
];
/// Adding and subtracting this number rounds to the nearest 32nd: 1.5 * 2^47.
const ROUND_32: f64 = 211_106_232_532_992.0;

/// Returns `powf(x, 2)`.
#[inline(always)]
pub(super) fn powf_2<F: Fma>(x: f32) -> f32 {
    const START: u32 = 0x3f33_0000;
    let x = x.abs();
    if !(x > 0.0 && x < f32::INFINITY) {
        return x * x;
    }
    let bits = if x < f32::MIN_POSITIVE {
        (x * 8_388_608.0).to_bits().wrapping_sub(23 << 23)
    } else {
        x.to_bits()
    };
    let offset = bits.wrapping_sub(START);
    let [reciprocal, log] = POWF_LOG2[(offset >> 19) as usize & 15];
    let top = offset & 0xff80_0000;
    let z = f64::from(f32::from_bits(bits.wrapping_sub(top)));
    let r = F::fma(z, reciprocal, -1.0);
    let y0 = log + f64::from(top.cast_signed() >> 23);
    let r2 = r * r;
    let y = F::fma(LOG2[0], r, LOG2[1]);
    let p = F::fma(LOG2[2], r, LOG2[3]);
    let q = F::fma(p, r2, F::fma(LOG2[4], r, y0));
    let log2 = 2.0 * F::fma(y, r2 * r2, q);

    if log2 >= 128.0 {
        return f32::INFINITY;
    }
    if log2 <= -150.0 {
        return 0.0;
    }
    let shifted = log2 + ROUND_32;
    let bits = shifted.to_bits();
    let r = log2 - (shifted - ROUND_32);
    let scale = f64::from_bits(EXP2F[bits as usize & 31].wrapping_add(bits << 47));
    let z = F::fma(EXP2[0], r, EXP2[1]);
    let y = F::fma(z, r * r, F::fma(EXP2[2], r, 1.0));
    (y * scale) as f32
}
