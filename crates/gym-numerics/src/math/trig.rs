//! Sine and cosine, as glibc computes them on x86-64 with FMA: a reduction to ±π/4 with its
//! rounding error, a table in steps of 1/128, and short polynomials between the steps.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

use super::fma::{Emulated, exact_product};
use super::tables::{SIN_COS, TWO_OVER_PI};
use super::{One, Real};

/// Adding this number puts the nearest multiple of 1/128 into the lowest bits: 1.5 * 2^45.
const BIG: f64 = 52_776_558_133_248.0;
/// Adding and subtracting this number rounds to the nearest integer, which is in the lowest bits of
/// the sum: 1.5 * 2^52.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// Angles below this are not reduced.
const UNREDUCED: f64 = 0.855_468_75;
/// Angles below this are reduced by at most one quarter turn.
const ONE_TURN: f64 = f64::from_bits(0x4003_68fd_0000_0000);
/// Angles from here on are reduced with all digits of π.
const HUGE: f64 = 105_414_350.0;
/// Below this, the sine of a reduced angle needs no table.
const SMALL: f64 = 0.126;

/// π/2 in two parts.
const QUARTER: [f64; 2] = [FRAC_PI_2, 6.123_233_995_736_766e-17];
/// π/2 in four parts. The first two have few bits, so that small multiples of them are exact.
const PARTS: [f64; 4] = [
    1.570_796_340_703_964_2,
    -1.390_906_756_437_715_3e-8,
    -4.978_996_231_479_91e-17,
    -1.903_488_962_019_326_6e-25,
];

/// An angle exactly between two table rows, and its sine. For this angle and its negative alone,
/// glibc's `sin` chooses another row than this reduction and glibc's `sincos`.
const HALF_WAY: f64 = f64::from_bits(0x3ffa_d1fb_5444_2d18);
const SIN_HALF_WAY: f64 = f64::from_bits(0x3fef_d27a_cee5_50dc);

/// Coefficients of x^3 and x^5 of the sine, and x^2, x^4 and x^6 of 1 minus the cosine, for |x| <=
/// 1/256.
const S3: f64 = -0.166_666_666_666_664_88;
const S5: f64 = 0.008_333_332_142_857_223;
const C2: f64 = 0.5;
const C4: f64 = -0.041_666_666_666_666_44;
const C6: f64 = 0.001_388_888_740_079_376;

/// Coefficients of x^11, x^9, ... x^3 of the sine, for |x| < 0.126.
const SINE: [f64; 5] = [
    -2.502_201_484_831_839_8e-8,
    2.755_729_806_860_771e-6,
    -0.000_198_412_698_344_146_42,
    0.008_333_333_333_332_329,
    -0.166_666_666_666_666_66,
];

/// An angle without its quarter turns: its value in two parts, and the number of quarter turns in
/// the lowest bits of `turns`.
struct Reduced<R> {
    a: R,
    da: R,
    turns: R,
    /// Whether any angle is at least [`HUGE`], for which the reduction fails.
    huge: bool,
}

impl<R: Real> Reduced<R> {
    /// Reduces `x` by the fastest formula that is correct for all its numbers.
    #[inline(always)]
    fn new(x: R) -> Self {
        let magnitude = x.abs();
        let unreduced = magnitude.lt(x.same(UNREDUCED));
        if R::LANES == 1 && R::all(unreduced) {
            return Self {
                a: x,
                da: x.same(0.0),
                turns: x.same(ROUND),
                huge: false,
            };
        }
        let near = magnitude.lt(x.same(ONE_TURN));
        let one = R::select(unreduced, x.same(0.0), x.same(1.0).copysign(x));
        if R::all(near) {
            Self::of_near(x, one)
        } else {
            Self::of_any(x, near, one)
        }
    }

    /// Reduces by `n` quarter turns (-1, 0 or 1), with the parts of [`QUARTER`].
    #[inline(always)]
    fn of_near(x: R, n: R) -> Self {
        let (minus_n, rest) = (-n, x.same(QUARTER[1]));
        let y = minus_n.fma(x.same(QUARTER[0]), x);
        let a = minus_n.fma(rest, y);
        Self {
            a,
            da: minus_n.fma(rest, y - a),
            turns: n + ROUND,
            huge: false,
        }
    }

    /// Reduces angles to at most an eighth turn: angles in `near` by `one` quarter turns, others by
    /// the nearest number of quarter turns, with the parts of [`PARTS`].
    #[inline(always)]
    fn of_any(x: R, near: R::Mask, one: R) -> Self {
        let shifted = x.fma(x.same(FRAC_2_PI), x.same(ROUND));
        let n = R::select(near, one, shifted - ROUND);
        let part = |of_near: f64, k: usize| R::select(near, x.same(of_near), x.same(PARTS[k]));
        let minus_n = -n;
        let y = minus_n.fma(part(0.0, 1), minus_n.fma(part(QUARTER[0], 0), x));
        let p3 = part(QUARTER[1], 2);
        let t2 = minus_n.fma(p3, y);
        let da = minus_n.fma(p3, y - t2);
        let p4 = part(0.0, 3);
        let a = minus_n.fma(p4, t2);
        let da = da + minus_n.fma(p4, t2 - a);
        let huge = !R::all(x.abs().lt(x.same(HUGE)));
        Self {
            a,
            da,
            turns: n + ROUND,
            huge,
        }
    }
}

/// For the magnitude of a reduced angle: returns its distance from the nearest multiple of 1/128,
/// and the table row of that multiple.
#[inline(always)]
fn nearest<R: Real>(magnitude: R) -> (R, [R; 4]) {
    let u = magnitude + BIG;
    (magnitude - (u - BIG), u.rows(&SIN_COS))
}

/// Returns the polynomials of the sine and of 1 minus the cosine; `square` is the square of a small
/// angle.
#[inline(always)]
fn polynomials<R: Real>(square: R) -> (R, R) {
    let sin = square.fma(square.same(S5), square.same(S3));
    let cos = square
        .fma(square.same(C6), square.same(C4))
        .fma(square, square.same(C2));
    (sin, cos)
}

/// Returns `a cos(s) + b sin(s)`, where `c` is 1 - cos(s), and `a_rest` and `b_rest` are second
/// parts.
#[inline(always)]
fn turn<R: Real>([a, a_rest, b, b_rest]: [R; 4], s: R, c: R) -> R {
    a + s.fma(b, (-c).fma(a, b_rest.fma(s, a_rest)))
}

/// Returns the sine of an angle below [`SMALL`].
#[inline(always)]
fn sin_of_small<R: Real>(a: R, da: R) -> R {
    let square = a * a;
    let [first, rest @ ..] = SINE;
    let p = rest
        .iter()
        .fold(a.same(first), |p, c| p.fma(square, a.same(*c)));
    a + square.fma(p.fma(a, da * -0.5), da)
}

/// Returns sine and cosine of a reduced angle.
#[inline(always)]
fn both<R: Real>(a: R, da: R) -> (R, R) {
    let (r, row @ [sin, sin_rest, cos, cos_rest]) = nearest(a.abs());
    let dx = da.negate_if(a.lt(a.same(0.0)));

    let whole = r + dx;
    let square = whole * whole;
    let (p, q) = polynomials(square);
    let s = (whole * square).fma(p, whole);
    let cos = turn([cos, cos_rest, -sin, -sin_rest], s, square * q);

    let sin = or_small(
        a,
        da,
        #[inline(always)]
        || {
            let square = r * r;
            let (p, q) = polynomials(square);
            let s = r + (r * square).fma(p, dx);
            turn(row, s, r.fma(dx, square * q))
        },
    );
    (sin, cos)
}

/// Returns sine and cosine of a reduced angle without a second part.
#[inline(always)]
fn both_exact<R: Real>(a: R) -> (R, R) {
    let (r, row @ [sin, sin_rest, cos, cos_rest]) = nearest(a.abs());
    let square = r * r;
    let (p, q) = polynomials(square);
    let (cube, c) = (r * square, square * q);
    let cos = turn([cos, cos_rest, -sin, -sin_rest], cube.fma(p, r), c);
    let sin = or_small(
        a,
        a.same(0.0),
        #[inline(always)]
        || turn(row, r + cube * p, c),
    );
    (sin, cos)
}

/// Returns the sine of a reduced angle. If the magnitude of the angle is at least [`SMALL`],
/// `large` computes the sine of the magnitude.
#[inline(always)]
fn or_small<R: Real>(a: R, da: R, large: impl FnOnce() -> R) -> R {
    let small = a.abs().lt(a.same(SMALL));
    let sin = if R::all(small) {
        sin_of_small(a, da)
    } else {
        let large = large();
        if R::any(small) {
            R::select(small, sin_of_small(a, da), large)
        } else {
            large
        }
    };
    sin.copysign(a)
}

/// Returns the sine if `turns` is even, the cosine if it is odd.
#[inline(always)]
fn one_of_both<R: Real>(a: R, da: R, turns: R) -> R {
    let odd = turns.bit(0);
    let small = R::but_not(a.abs().lt(a.same(SMALL)), odd);
    let value = if R::all(small) {
        sin_of_small(a, da).copysign(a)
    } else {
        let (r, [sin, sin_rest, cos, cos_rest]) = nearest(a.abs());
        let dx = da.negate_if(a.lt(a.same(0.0)));
        // the cosine uses the whole angle, the sine its first part and a correction
        let whole = R::select(odd, r + dx, r);
        let square = whole * whole;
        let (p, q) = polynomials(square);
        let s = (whole * square).fma(p, R::select(odd, whole, dx));
        let s = R::select(odd, s, r + s);
        let c = square * q;
        let c = R::select(odd, c, r.fma(dx, c));
        let pick = |odd_one: R, even_one: R| R::select(odd, odd_one, even_one);
        let row = [
            pick(cos, sin),
            pick(cos_rest, sin_rest),
            pick(-sin, cos),
            pick(-sin_rest, cos_rest),
        ];
        let value = turn(row, s, c);
        let value = if R::any(small) {
            R::select(small, sin_of_small(a, da), value)
        } else {
            value
        };
        R::select(odd, value, value.copysign(a))
    };
    value.negate_if(turns.bit(1))
}

/// Returns sine and cosine in the quadrant given by `turns`.
#[inline(always)]
fn both_in_quadrant<R: Real>(a: R, da: R, turns: R) -> (R, R) {
    let (sin, cos) = both(a, da);
    let odd = turns.bit(0);
    let (sin, cos) = (R::select(odd, cos, sin), R::select(odd, sin, cos));
    (
        sin.negate_if(turns.bit(1)),
        cos.negate_if((turns + 1.0).bit(1)),
    )
}

/// Replaces the sines for which the formula fails: of [`HALF_WAY`], and from [`HUGE`] on. Both are
/// rare.
#[inline(always)]
fn repair_sin<R: Real>(x: R, sin: R, huge: bool) -> R {
    let (magnitude, half_way) = (x.abs(), x.same(HALF_WAY));
    let unlucky = magnitude.le(half_way) & half_way.le(magnitude);
    if !R::any(unlucky) && !huge {
        return sin;
    }
    sin.repair_unless(
        R::but_not(magnitude.lt(x.same(HUGE)), unlucky),
        x,
        sin_of_unusual,
    )
}

/// Replaces the cosines for which the formula fails: from [`HUGE`] on.
#[inline(always)]
fn repair_cos<R: Real>(x: R, cos: R, huge: bool) -> R {
    if huge {
        cos.repair_unless(x.abs().lt(x.same(HUGE)), x, |x| sin_cos_of_huge(x).1)
    } else {
        cos
    }
}

/// Returns the sine and the cosine of angles in rad.
#[inline(always)]
pub(super) fn sin_cos<R: Real>(x: R) -> (R, R) {
    if R::all(x.abs().lt(x.same(UNREDUCED))) {
        return both_exact(x);
    }
    let Reduced { a, da, turns, huge } = Reduced::new(x);
    let (sin, cos) = both_in_quadrant(a, da, turns);
    (repair_sin(x, sin, huge), repair_cos(x, cos, huge))
}

/// Returns the sine of angles in rad.
#[inline(always)]
pub(super) fn sin<R: Real>(x: R) -> R {
    let Reduced { a, da, turns, huge } = Reduced::new(x);
    repair_sin(x, one_of_both(a, da, turns), huge)
}

/// Returns the cosine of angles in rad.
#[inline(always)]
pub(super) fn cos<R: Real>(x: R) -> R {
    // the sine of the angle plus a quarter turn
    let Reduced { a, da, turns, huge } = Reduced::new(x);
    repair_cos(x, one_of_both(a, da, turns + 1.0), huge)
}

#[cold]
#[inline(never)]
fn sin_of_unusual(x: f64) -> f64 {
    if x.abs() == HALF_WAY {
        SIN_HALF_WAY.copysign(x)
    } else {
        sin_cos_of_huge(x).0
    }
}

/// Computes angles from [`HUGE`] on, which no environment reaches.
#[cold]
#[inline(never)]
fn sin_cos_of_huge(x: f64) -> (f64, f64) {
    if !x.is_finite() {
        return (f64::NAN, f64::NAN);
    }
    let Reduced { a, da, turns, .. } = reduce_huge(x);
    let (sin, cos) = both_in_quadrant(a, da, turns);
    (sin.value(), cos.value())
}

/// Reduces an angle from [`HUGE`] on, after Payne and Hanek (1983): digits of 2/π that only give
/// whole turns are skipped.
fn reduce_huge(x: f64) -> Reduced<One<Emulated>> {
    // x = mantissa * 2^exponent
    let exponent = (x.to_bits() >> 52 & 0x7ff).cast_signed() - 1075;
    let mantissa = x.to_bits() & ((1 << 52) - 1) | 1 << 52;

    // 256 digits of 2/π. The digits before `start` contribute only multiples of 4 quarter turns.
    let start = (exponent - 2).max(0) as usize;
    let word = |i: usize| TWO_OVER_PI.get(i).copied().unwrap_or(0);
    let digits = |i: usize| {
        let (i, shift) = (start / 64 + i, start % 64);
        if shift == 0 {
            word(i)
        } else {
            word(i) << shift | word(i + 1) >> (64 - shift)
        }
    };
    // the product of these digits and the mantissa, lowest word first
    let mut product = [0u64; 5];
    let mut carry = 0u128;
    for (i, word) in product.iter_mut().take(4).enumerate() {
        carry += u128::from(mantissa) * u128::from(digits(3 - i));
        *word = carry as u64;
        carry >>= 64;
    }
    product[4] = carry as u64;
    let shift = (2 - exponent).max(0) as u32; // below 64
    let shifted = |i: usize| (u128::from(product[i + 1]) << 64 | u128::from(product[i])) >> shift;
    let [low, high] =
        [0, 2].map(|i| shifted(i) as u64 as u128 | (shifted(i + 1) as u64 as u128) << 64);

    // the highest two digits are quarter turns; the fraction is brought into ±1/2 quarter turn
    let mut turns = (high >> 126) as i32;
    let fraction = [low, high << 2 >> 2].map(|word| word);
    let above = fraction[1] >> 125 & 1 == 1;
    let (low, high) = if above {
        turns += 1;
        let (low, borrow) = 0u128.overflowing_sub(fraction[0]);
        (low, (1u128 << 126) - fraction[1] - u128::from(borrow))
    } else {
        (fraction[0], fraction[1])
    };
    let sign = if above == (x < 0.0) { 1.0 } else { -1.0 };

    // in two parts: 126 digits of the first word, then the digits of the second
    let leading = high.leading_zeros().min(127);
    let joined = if leading == 0 {
        high
    } else {
        high << leading | low >> (128 - leading)
    };
    let top = (joined >> 75) as f64;
    let rest = (joined & ((1 << 75) - 1)) as f64;
    let unit = 2f64.powi(-126 - leading as i32);
    let (top, rest) = (top * 2f64.powi(75) * unit, rest * unit);
    let (a, low) = exact_product(top, QUARTER[0]);
    let low = low + (top * QUARTER[1] + rest * QUARTER[0]);
    let sum = a + low;
    let turns = if x < 0.0 { -turns } else { turns };
    Reduced {
        a: One::new(sign * sum),
        da: One::new(sign * (a - sum + low)),
        turns: One::new(f64::from(turns) + ROUND),
        huge: false,
    }
}
