//! `a * b + c`, rounded once: by the CPU's instruction, or emulated by sums and products.

use std::fmt;

/// A source of fused multiply-adds. All sources give the same bits.
pub trait Fma: Copy + fmt::Debug + 'static {
    /// `a * b + c`, rounded once.
    fn fma(a: f64, b: f64, c: f64) -> f64;
}

/// The CPU's instruction, in functions compiled for a CPU that has it. On other CPUs this is a slow
/// function call.
#[derive(Clone, Copy, Debug)]
pub struct Hardware;

impl Fma for Hardware {
    #[expect(
        clippy::disallowed_methods,
        reason = "this is where it is used as it is meant"
    )]
    #[inline(always)]
    fn fma(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }
}

/// Emulation by sums and products. Source: Boldo and Melquiond (2008), "Emulation of a FMA and
/// correctly rounded sums: proved algorithms using rounding to odd".
///
/// It is exact unless a product exceeds 2^996, or the product's rounding error or the result is
/// below the smallest normal number. The functions of this module do not reach these cases.
#[derive(Clone, Copy, Debug)]
pub struct Emulated;

impl Fma for Emulated {
    /// Not inlined: the code is long and used often.
    #[inline(never)]
    fn fma(a: f64, b: f64, c: f64) -> f64 {
        let (high, low) = exact_product(a, b);
        let (middle, lowest) = exact_sum(c, low);
        let (sum, rest) = exact_sum(high, middle);
        let result = sum + sum_to_odd(lowest, rest);
        // if a part overflows or is NaN, the other parts are meaningless; a sum of 0 is exact
        // already
        if result.is_finite() && result != 0.0 {
            result
        } else {
            a * b + c
        }
    }
}

/// Returns a product and its rounding error. Source: Dekker (1971).
#[inline(always)]
pub(super) fn exact_product(a: f64, b: f64) -> (f64, f64) {
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    let product = a * b;
    (product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2)
}

/// Splits a number into two halves of 26 bits. Source: Veltkamp (1968).
#[inline(always)]
fn split(x: f64) -> (f64, f64) {
    const SPLIT: f64 = 134_217_729.0; // 2^27 + 1
    let scaled = SPLIT * x;
    let high = scaled - (scaled - x);
    (high, x - high)
}

/// Returns a sum and its rounding error. Source: Knuth, "The art of computer programming", volume
/// 2, 4.2.2.
#[inline(always)]
fn exact_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let from_b = sum - a;
    (sum, (a - (sum - from_b)) + (b - from_b))
}

/// Returns the sum rounded to odd: if the sum is not exact, the result is the adjacent number whose
/// last bit is 1.
#[inline(always)]
fn sum_to_odd(a: f64, b: f64) -> f64 {
    let (sum, rest) = exact_sum(a, b);
    let bits = sum.to_bits();
    if rest == 0.0 || bits & 1 == 1 {
        return sum;
    }
    // away from zero if the rounding error has the sum's sign, otherwise towards zero
    let away = (rest > 0.0) == (sum > 0.0);
    f64::from_bits(if away { bits + 1 } else { bits - 1 })
}

/// Returns `a * b + c` in single precision, rounded once: the product is exact in `f64`, and
/// rounding to odd makes the second rounding to `f32` correct.
#[inline]
pub(super) fn fma_f32(a: f32, b: f32, c: f32) -> f32 {
    sum_to_odd(f64::from(a) * f64::from(b), f64::from(c)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Generator;

    #[test]
    fn both_give_the_same_bits() {
        let mut rng = Generator::from(0);
        let mut random = |exponents: i64| {
            let bits = (rng.integers(0, 1 << 52) | rng.integers(0, 2) << 63).cast_unsigned();
            f64::from_bits(
                bits | (1023 + rng.integers(-exponents, exponents + 1)).cast_unsigned() << 52,
            )
        };
        for i in 0..400_000 {
            let (a, b) = (random(30), random(30));
            let c = match i % 4 {
                0 => random(60),
                1 => -a * b * random(0).signum(),
                // within a few bits of a tie
                2 => (a * b) * 2f64.powi(53) * random(1),
                _ => -(a * b) * (1.0 + f64::EPSILON * random(3)),
            };
            assert_eq!(
                Emulated::fma(a, b, c).to_bits(),
                Hardware::fma(a, b, c).to_bits(),
                "{a:e} {b:e} {c:e}"
            );
        }
        for (a, b, c) in [
            (0.0, 1.0, 0.0),
            (1e308, 10.0, 0.0),
            (f64::INFINITY, 1.0, 1.0),
            (2.0, 3.0, -6.0),
        ] {
            assert_eq!(Emulated::fma(a, b, c), Hardware::fma(a, b, c));
        }
        assert!(Emulated::fma(f64::NAN, 1.0, 1.0).is_nan());
    }

    /// A product that is a little less or more than half a unit of the other number's last place.
    #[test]
    fn a_sum_beside_the_middle_is_rounded_to_its_side() {
        for (i, sign) in (1..=50).flat_map(|i| [(i, 1.0), (i, -1.0)]) {
            let small = 2f64.powi(-i);
            for c in [1.0, 1.0 + f64::EPSILON, 1.5, 2.0 - f64::EPSILON] {
                let half = sign * f64::EPSILON / 2.0;
                let fma = |b: f64| sign * Emulated::fma(half * (1.0 + small), b, sign * c);
                assert_eq!(fma(1.0 - small), c, "{c:?} and less, {i}");
                assert_eq!(fma(1.0 + small), c + f64::EPSILON, "{c:?} and more, {i}");
            }
            if i > 22 {
                continue;
            }
            let (small, sign) = (small as f32, sign as f32);
            for c in [1.0, 1.0 + f32::EPSILON, 1.5, 2.0 - f32::EPSILON] {
                let half = sign * f32::EPSILON / 2.0;
                let fma = |b: f32| sign * fma_f32(half * (1.0 + small), b, sign * c);
                assert_eq!(fma(1.0 - small), c, "{c:?} and less, {i}");
                assert_eq!(fma(1.0 + small), c + f32::EPSILON, "{c:?} and more, {i}");
            }
        }
    }
}
