//! The number type of equations: one number, or a SIMD register of them.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

use super::{Fma, pow, trig};

/// An `f64`, or several that are computed with at once.
///
/// Each operation rounds as that of `f64`, so the same equations give the same bits for one number
/// and for several. Comparisons return masks; use [`select`](Self::select) instead of `if`.
pub trait Real:
    Copy
    + fmt::Debug
    + Add<Output = Self>
    + Add<f64, Output = Self>
    + Sub<Output = Self>
    + Sub<f64, Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
    + Div<f64, Output = Self>
    + Neg<Output = Self>
{
    /// A yes or no for each number.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

    /// Proof that the CPU has the needed instructions.
    type Token: Copy;

    /// How many numbers these are.
    const LANES: usize;

    /// `x`, as often as there are numbers here.
    fn same(self, x: f64) -> Self;

    /// `self * b + c`, rounded once.
    fn fma(self, b: Self, c: Self) -> Self;

    /// The magnitudes.
    fn abs(self) -> Self;

    /// These magnitudes with the signs of others.
    fn copysign(self, sign: Self) -> Self;

    /// Rounded to the precision of `f32`.
    fn single(self) -> Self;

    /// Whether the numbers are less than others.
    fn lt(self, other: Self) -> Self::Mask;

    /// Whether the numbers are less than others or equal.
    fn le(self, other: Self) -> Self::Mask;

    /// `yes` where the mask is set, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Where the mask is set and another is not.
    fn but_not(mask: Self::Mask, other: Self::Mask) -> Self::Mask;

    /// Whether the mask is set anywhere.
    fn any(mask: Self::Mask) -> bool;

    /// Whether the mask is set everywhere.
    fn all(mask: Self::Mask) -> bool;

    /// The mask as bits, the lowest for the first number.
    fn bits(mask: Self::Mask) -> u64;

    /// Where the mask is not set, `f` of the number of `of` instead, one by one: for rare cases.
    fn repair_unless(self, mask: Self::Mask, of: Self, f: impl Fn(f64) -> f64) -> Self;

    /// The greatest powers of two that are not above the magnitudes, for normal numbers.
    fn exponent(self) -> Self;

    /// Whether this bit of the numbers' representation is set.
    fn bit(self, bit: u32) -> Self::Mask;

    /// The negative ones of these where the mask is set.
    #[inline(always)]
    fn negate_if(self, mask: Self::Mask) -> Self {
        Self::select(mask, -self, self)
    }

    /// The columns of the rows that the lowest 7 bits of the numbers' representation give.
    fn rows(self, table: &[[f64; 4]; 128]) -> [Self; 4];

    /// The first numbers of a slice, which has as many at least.
    fn get(token: Self::Token, numbers: &[f64]) -> Self;

    /// Overwrites the first numbers of a slice, which has as many at least.
    fn put(self, numbers: &mut [f64]);

    /// The sine and the cosine of angles in rad.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        trig::sin_cos(self)
    }

    /// The sine of angles in rad.
    #[inline(always)]
    fn sin(self) -> Self {
        trig::sin(self)
    }

    /// The cosine of angles in rad.
    #[inline(always)]
    fn cos(self) -> Self {
        trig::cos(self)
    }

    /// Python's `x ** 2`, which is the C library's `pow`: not `x * x` for about one number in a
    /// thousand.
    #[inline(always)]
    fn square(self) -> Self {
        pow::square(self)
    }

    /// `x ** 2` of numbers of numpy's `float32`: the C library's `powf`.
    #[inline(always)]
    fn square_f32(self) -> Self {
        pow::square_f32(self)
    }

    /// Python's `x % b` for `b` above 0: in `[0, b)`, or `b` itself where a tiny negative number
    /// rounds up to it.
    #[inline(always)]
    fn modulo(self, b: f64) -> Self {
        // beyond this many times `b`, the quotient is not found by adding
        const MOST: f64 = 2_251_799_813_685_248.0; // 2^51
        const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52
        let magnitude = self.abs();
        let quotient = magnitude * (1.0 / b);
        let quotient = (quotient + ROUND) - ROUND;
        // exact, as all remainders are
        let rest = (-quotient).fma(self.same(b), magnitude);
        let zero = self.same(0.0);
        let rest = Self::select(rest.lt(zero), rest + b, rest);
        let rest = Self::select(Self::but_not(self.lt(zero), rest.le(zero)), -rest + b, rest);
        let possible = magnitude.lt(self.same(MOST * b.min(1.0)));
        if Self::all(possible) {
            return rest;
        }
        rest.repair_unless(possible, self, |x| {
            let rest = x % b;
            if rest < 0.0 { rest + b } else { rest.abs() }
        })
    }

    /// Whether the numbers are greater than others.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// Brought between two bounds, as `f64::clamp` and `np.clip` do.
    #[inline(always)]
    fn clamp(self, low: f64, high: f64) -> Self {
        let (low, high) = (self.same(low), self.same(high));
        let x = Self::select(self.lt(low), low, self);
        Self::select(x.gt(high), high, x)
    }
}

/// The bits of an exponent.
pub(super) const EXPONENT: u64 = 0x7ff << 52;

/// One number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct One<F> {
    x: f64,
    fma: PhantomData<F>,
}

impl<F> One<F> {
    /// That number.
    #[inline(always)]
    pub fn new(x: f64) -> Self {
        Self {
            x,
            fma: PhantomData,
        }
    }

    /// That number.
    #[inline(always)]
    pub fn value(self) -> f64 {
        self.x
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<F> $trait for One<F> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self::new($trait::$method(self.x, other.x))
            }
        }

        impl<F> $trait<f64> for One<F> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                Self::new($trait::$method(self.x, other))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<F> Neg for One<F> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x)
    }
}

impl<F: Fma> Real for One<F> {
    type Mask = bool;
    type Token = ();

    const LANES: usize = 1;

    #[inline(always)]
    fn same(self, x: f64) -> Self {
        Self::new(x)
    }

    #[inline(always)]
    fn fma(self, b: Self, c: Self) -> Self {
        Self::new(F::fma(self.x, b.x, c.x))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self::new(self.x.abs())
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self::new(self.x.copysign(sign.x))
    }

    #[inline(always)]
    fn single(self) -> Self {
        Self::new(f64::from(self.x as f32))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self.x < other.x
    }

    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self.x <= other.x
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn but_not(mask: bool, other: bool) -> bool {
        mask & !other
    }

    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }

    #[inline(always)]
    fn all(mask: bool) -> bool {
        mask
    }

    #[inline(always)]
    fn bits(mask: bool) -> u64 {
        u64::from(mask)
    }

    #[inline(always)]
    fn repair_unless(self, mask: bool, of: Self, f: impl Fn(f64) -> f64) -> Self {
        if mask { self } else { Self::new(f(of.x)) }
    }

    #[inline(always)]
    fn exponent(self) -> Self {
        Self::new(f64::from_bits(self.x.to_bits() & EXPONENT))
    }

    #[inline(always)]
    fn bit(self, bit: u32) -> bool {
        self.x.to_bits() >> bit & 1 == 1
    }

    #[inline(always)]
    fn rows(self, table: &[[f64; 4]; 128]) -> [Self; 4] {
        let [a, b, c, d] = table[self.x.to_bits() as usize & 127];
        [Self::new(a), Self::new(b), Self::new(c), Self::new(d)]
    }

    #[inline(always)]
    fn get((): (), numbers: &[f64]) -> Self {
        Self::new(numbers[0])
    }

    #[inline(always)]
    fn put(self, numbers: &mut [f64]) {
        numbers[0] = self.x;
    }
}
