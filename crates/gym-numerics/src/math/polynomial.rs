//! Straight-line versions, for loops that the compiler turns into vector instructions: no branch, no
//! call, no table, no fused multiply-add, so that each CPU computes the same bits.

use std::f64::consts::{FRAC_2_PI, TAU};

use super::Math;

/// Polynomials instead of the C library: the same bits on every CPU, and fit for vector
/// instructions.
///
/// | function | differs from the exact value by |
/// |---|---|
/// | `sin_cos` | less than 1 ulp up to ±[`MAX_ANGLE`](Self::MAX_ANGLE); beyond, it is exact for an angle within 1 ulp of `x` |
/// | `square`, `square_f32` | half an ulp: they are correctly rounded |
/// | `modulo`, `wrap` | nothing and half an ulp of π, for up to 2^26 divisors or turns |
#[derive(Clone, Copy, Debug)]
pub struct Polynomial;

/// Adding and subtracting 1.5 * 2^52 rounds to the nearest whole number, which is then in the low
/// bits of the sum.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// π/2 in four parts. The first three have 33 bits each, so that their products with a number of
/// quarter turns below 2^20 are exact. Source: fdlibm, `e_rem_pio2.c`.
const PI_2: [f64; 4] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_711_166_5e-21,
    8.478_427_660_368_9e-32,
];

/// Coefficients of x^3, x^5, ... of the sine within ±π/4. Source: fdlibm, `k_sin.c`.
const SIN: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

/// Coefficients of x^4, x^6, ... of the cosine within ±π/4. Source: fdlibm, `k_cos.c`.
const COS: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

impl Polynomial {
    /// The largest angle whose sine and cosine are exact within 1 ulp, in rad: 2^20 quarter turns,
    /// rounded down.
    pub const MAX_ANGLE: f64 = 1.6e6;
}

impl Math for Polynomial {
    #[inline(always)]
    fn sin_cos(x: f64) -> (f64, f64) {
        // the rest after whole quarter turns, and what that rounds away (Cody and Waite)
        let shifted = x * FRAC_2_PI + ROUND;
        let turns = shifted - ROUND;
        let high = x - turns * PI_2[0];
        let part = turns * PI_2[1];
        let middle = high - part;
        let low = turns * PI_2[2] - ((high - middle) - part);
        let r = middle - low;
        let rest = ((middle - r) - low) - turns * PI_2[3];

        let r2 = r * r;
        let half = 0.5 * r2;
        let unit = 1.0 - half;
        let sum = horner(&SIN, r2);
        let sin = r + (r * r2 * sum + rest * unit);
        let sum = horner(&COS, r2);
        let cos = unit + (((1.0 - unit) - half) + (r2 * r2 * sum - r * rest));

        // each quarter turn swaps both and turns a sign
        let quadrant = shifted.to_bits();
        let (sin, cos) = if quadrant & 1 == 0 { (sin, cos) } else { (cos, sin) };
        let sign = |bit: u64| (bit & 2) << 62;
        let flip = |x: f64, sign: u64| f64::from_bits(x.to_bits() ^ sign);
        (flip(sin, sign(quadrant)), flip(cos, sign(quadrant.wrapping_add(1))))
    }

    #[inline(always)]
    fn square(x: f64) -> f64 {
        x * x
    }

    #[inline(always)]
    fn square_f32(x: f32) -> f32 {
        x * x
    }

    #[inline(always)]
    fn modulo(a: f64, b: f64) -> f64 {
        let rest = subtract(a, floor(a * (1.0 / b)), b);
        // the rounded quotient can be one off
        let rest = if rest >= b { rest - b } else { rest };
        if rest < 0.0 { rest + b } else { rest }
    }

    #[inline(always)]
    fn wrap(x: f64) -> f64 {
        let turns = (x * (1.0 / TAU) + ROUND) - ROUND;
        subtract(x, turns, TAU)
    }
}

/// `c[0] + c[1] x + c[2] x^2 + ...`
#[inline(always)]
fn horner(coefficients: &[f64; 6], x: f64) -> f64 {
    let [c0, c1, c2, c3, c4, c5] = *coefficients;
    c0 + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * c5))))
}

/// The largest whole number that is not above `x`.
#[inline(always)]
fn floor(x: f64) -> f64 {
    let nearest = (x + ROUND) - ROUND;
    if nearest > x { nearest - 1.0 } else { nearest }
}

/// `a - n * b`, rounded once: `b` is split so that both products are exact for `n` below 2^26.
#[inline(always)]
fn subtract(a: f64, n: f64, b: f64) -> f64 {
    let high = f64::from_bits(b.to_bits() & !((1 << 26) - 1));
    (a - n * high) - n * (b - high)
}

#[cfg(test)]
mod tests {
    use num_bigint::BigInt;
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::Generator;
    use crate::math::Libm;

    /// Binary digits behind the point of the numbers that results are compared with.
    const DIGITS: u32 = 300;

    fn exact(x: f64) -> BigInt {
        let (mantissa, exponent) = split(x);
        BigInt::from(mantissa) << DIGITS >> -exponent
    }

    /// `x` as a whole number and the power of two that it is multiplied with, which is not positive
    /// below 2^52.
    fn split(x: f64) -> (i64, i32) {
        let exponent = ((x.to_bits() >> 52) & 0x7ff) as i32;
        let mantissa = (x.to_bits() & ((1 << 52) - 1)) | (1 << 52);
        (if x < 0.0 { -(mantissa as i64) } else { mantissa as i64 }, exponent - 1075)
    }

    /// Twice the arc tangent of 1 / n, by its series.
    fn atan(n: i64) -> BigInt {
        let mut power = (BigInt::from(1) << DIGITS) / n;
        let mut sum = power.clone();
        for k in 1.. {
            power /= -n * n;
            if power == BigInt::ZERO {
                break;
            }
            sum += &power / (2 * k + 1);
        }
        sum
    }

    /// The sine and the cosine by their series, far more exact than `f64`.
    struct Reference {
        quarter_turn: BigInt,
    }

    impl Reference {
        fn new() -> Self {
            Self { quarter_turn: 8 * atan(5) - 2 * atan(239) } // Machin's formula
        }

        fn sin_cos(&self, x: f64) -> (BigInt, BigInt) {
            let x = exact(x);
            let half: BigInt = &self.quarter_turn / 2;
            let shifted: BigInt = &x + &half + (&self.quarter_turn << 40u32);
            let turns = &shifted / &self.quarter_turn - (BigInt::from(1) << 40u32);
            let r = x - &turns * &self.quarter_turn;
            let square: BigInt = (&r * &r) >> DIGITS;
            let [mut sin, mut cos] = [BigInt::ZERO, BigInt::ZERO];
            let (mut term, mut k) = (BigInt::from(1) << DIGITS, 0);
            while term != BigInt::ZERO {
                cos += &term;
                sin += ((&term * &r) >> DIGITS) / (k + 1);
                term = -((term * &square) >> DIGITS) / ((k + 1) * (k + 2));
                k += 2;
            }
            match u8::try_from((turns % 4 + 4) % BigInt::from(4)).unwrap() {
                0 => (sin, cos),
                1 => (cos, -sin),
                2 => (-sin, -cos),
                _ => (-cos, sin),
            }
        }
    }

    /// By how many units in the last place of `exact` both differ.
    fn ulps(x: f64, reference: &BigInt) -> f64 {
        let difference: BigInt = if x == 0.0 { -reference } else { exact(x) - reference };
        let exponent = reference.bits() as i32 - DIGITS as i32 - 53;
        // scaled so that it fits an integer and keeps fractions of an ulp
        let scaled = difference >> (DIGITS as i32 + exponent - 10);
        i64::try_from(scaled).unwrap().unsigned_abs() as f64 / 1024.0
    }

    /// The worst error over these angles.
    fn worst(angles: impl Iterator<Item = f64>) -> f64 {
        let reference = Reference::new();
        let error = |x: f64| {
            let (sin, cos) = Polynomial::sin_cos(x);
            let (exact_sin, exact_cos) = reference.sin_cos(x);
            ulps(sin, &exact_sin).max(ulps(cos, &exact_cos))
        };
        angles.map(error).fold(0.0, f64::max)
    }

    #[test]
    fn the_reference_is_exact() {
        let reference = Reference::new();
        for x in [0.1, -0.7, 1.0, 2.0, 3.0, -5.0, 100.0, 1e6] {
            let (sin, cos) = reference.sin_cos(x);
            assert!(ulps(x.sin(), &sin) < 0.6 && ulps(x.cos(), &cos) < 0.6, "{x}");
        }
    }

    #[test]
    fn sines_and_cosines_are_within_one_ulp() {
        const N: usize = 20_000;
        let mut rng = Generator::from(0);
        let mut random = |bound: f64| (0..N).map(|_| rng.uniform(-bound, bound)).collect::<Vec<_>>();
        for bound in [1e-9, 0.01, 0.21, 0.8, 3.2, 7.0, 100.0, 1e4, Polynomial::MAX_ANGLE] {
            let worst = worst(random(bound).into_iter());
            println!("within {bound:e}: {worst} ulp");
            assert!(worst < 1.0, "{worst} ulp within {bound}");
        }
        let dense = (1..40_000).map(|i| f64::from(i) * 1e-4);
        assert!(worst(dense) < 1.0);
    }

    /// Next to multiples of π/2 almost all digits cancel.
    #[test]
    fn sines_and_cosines_are_within_one_ulp_where_they_vanish() {
        let quarters = (1..1 << 20).step_by(97).chain(1..2000).map(f64::from);
        let near = quarters.flat_map(|n| {
            let x = n * FRAC_PI_2;
            [x.next_down(), x, x.next_up(), -x]
        });
        let worst = worst(near.filter(|x| x.abs() < Polynomial::MAX_ANGLE));
        println!("{worst} ulp");
        assert!(worst < 1.0, "{worst} ulp");
    }

    /// Beyond the range that is reduced exactly, results are those of an angle next to it.
    #[test]
    fn huge_angles_lose_no_more_than_their_own_rounding() {
        let reference = Reference::new();
        for x in (0..3000).map(|i| 1.7e6 * 1.01f64.powi(i % 1000) + f64::from(i)) {
            let (sin, cos) = Polynomial::sin_cos(x);
            let ulp = x.next_up() - x;
            for (value, reference) in [(sin, reference.sin_cos(x).0), (cos, reference.sin_cos(x).1)] {
                let difference = exact(value) - reference;
                assert!(difference.magnitude() <= exact(ulp).magnitude(), "{x}");
            }
        }
    }

    #[test]
    fn what_is_not_finite_stays_so() {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (sin, cos) = Polynomial::sin_cos(x);
            assert!(sin.is_nan() && cos.is_nan());
        }
        assert_eq!(Polynomial::sin_cos(0.0), (0.0, 1.0));
    }

    #[test]
    fn remainders_are_those_of_the_c_library() {
        let mut rng = Generator::from(1);
        for bound in [1.0, 10.0, 1e3, 1e6] {
            for x in (0..100_000).map(|_| rng.uniform(-bound, bound)) {
                assert_eq!(Polynomial::modulo(x, TAU), Libm::modulo(x, TAU), "{x}");
                let [fast, exact] = [Polynomial::wrap(x), Libm::wrap(x)];
                assert!(fast.abs() <= PI.next_up(), "{x}");
                // turn by turn, each rounding counts
                let turns = x.abs() / TAU + 2.0;
                let difference = (fast - exact).abs();
                let difference = difference.min(TAU - difference);
                assert!(difference <= turns * x.abs().max(1.0) * f64::EPSILON, "{x}: {fast} for {exact}");
                assert!(x.abs() > PI || fast == x, "{x}");
            }
        }
        for n in -2000..2000 {
            let x = f64::from(n) * TAU;
            for x in [x.next_down(), x, x.next_up()] {
                assert_eq!(Polynomial::modulo(x, TAU), Libm::modulo(x, TAU), "{x}");
            }
        }
    }
}
