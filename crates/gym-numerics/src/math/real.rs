//! The number type of equations: one number, or a SIMD register of numbers.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

use super::{Fma, pow, trig};

/// An `f64`, or a register of several.
///
/// Each operation rounds like the operation of `f64`, so equations give the same bits for one
/// number and for several. Comparisons return masks: use [`select`](Self::select) instead of `if`.
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
    /// One boolean per number.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

    /// Proof that the CPU has the required instructions.
    type Token: Copy;

    /// The number of lanes.
    const LANES: usize;

    /// Returns a register in which every number is `x`.
    fn same(self, x: f64) -> Self;

    /// Returns `self * b + c`, rounded once.
    fn fma(self, b: Self, c: Self) -> Self;

    /// Returns the magnitudes.
    fn abs(self) -> Self;

    /// Returns the square roots.
    fn sqrt(self) -> Self;

    /// Returns the magnitudes with the signs of `sign`.
    fn copysign(self, sign: Self) -> Self;

    /// Rounds to the precision of `f32`.
    fn single(self) -> Self;

    /// Whether each number is less than `other`.
    fn lt(self, other: Self) -> Self::Mask;

    /// Whether each number is less than or equal to `other`.
    fn le(self, other: Self) -> Self::Mask;

    /// Returns `yes` where `mask` is set, otherwise `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Returns `mask` without the numbers of `other`.
    fn but_not(mask: Self::Mask, other: Self::Mask) -> Self::Mask;

    /// Whether `mask` is set for any number.
    fn any(mask: Self::Mask) -> bool;

    /// Whether `mask` is set for all numbers.
    fn all(mask: Self::Mask) -> bool;

    /// Returns `mask` as bits; the first number has the lowest bit.
    fn bits(mask: Self::Mask) -> u64;

    /// Replaces each number outside of `mask` by `f` of the number in `of`, one by one: for rare
    /// cases.
    fn repair_unless(self, mask: Self::Mask, of: Self, f: impl Fn(f64) -> f64) -> Self;

    /// Returns the largest power of two not above each magnitude, for normal numbers.
    fn exponent(self) -> Self;

    /// Whether bit `bit` of each number's representation is set.
    fn bit(self, bit: u32) -> Self::Mask;

    /// Negates the numbers where `mask` is set.
    #[inline(always)]
    fn negate_if(self, mask: Self::Mask) -> Self {
        Self::select(mask, -self, self)
    }

    /// Looks up the row given by the lowest 7 bits of each number's representation; returns the
    /// columns.
    fn rows(self, table: &[[f64; 4]; 128]) -> [Self; 4];

    /// Loads the first numbers of `numbers`, which must have enough.
    fn get(token: Self::Token, numbers: &[f64]) -> Self;

    /// Stores to the first numbers of `numbers`, which must have enough.
    fn put(self, numbers: &mut [f64]);

    /// Returns the sine and the cosine of angles in rad.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        trig::sin_cos(self)
    }

    /// Returns the sine of angles in rad.
    #[inline(always)]
    fn sin(self) -> Self {
        trig::sin(self)
    }

    /// Returns the cosine of angles in rad.
    #[inline(always)]
    fn cos(self) -> Self {
        trig::cos(self)
    }

    /// Python's `x ** 2`, which is the C library's `pow(x, 2)`: it differs from `x * x` for about
    /// one number in a thousand.
    #[inline(always)]
    fn square(self) -> Self {
        pow::square(self)
    }

    /// `x ** 2` of numpy's `float32`, which is the C library's `powf(x, 2)`.
    #[inline(always)]
    fn square_f32(self) -> Self {
        pow::square_f32(self)
    }

    /// Python's `x % b` for a positive `b`: in `[0, b)`, or `b` itself if a tiny negative number
    /// rounds up to it.
    #[inline(always)]
    fn modulo(self, b: f64) -> Self {
        // the largest quotient that can be rounded by adding and subtracting [`ROUND`]
        const MOST: f64 = 2_251_799_813_685_248.0; // 2^51
        const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52
        let magnitude = self.abs();
        let quotient = magnitude * (1.0 / b);
        let quotient = (quotient + ROUND) - ROUND;
        // exact, like every remainder
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

    /// Whether each number is greater than `other`.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// Limits the numbers to `[low, high]`, like `f64::clamp` and `np.clip`.
    #[inline(always)]
    fn clamp(self, low: f64, high: f64) -> Self {
        let (low, high) = (self.same(low), self.same(high));
        let x = Self::select(self.lt(low), low, self);
        Self::select(x.gt(high), high, x)
    }
}

/// The exponent's bits of an `f64`.
pub(super) const EXPONENT: u64 = 0x7ff << 52;

/// A single number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct One<F> {
    x: f64,
    fma: PhantomData<F>,
}

impl<F> One<F> {
    /// Wraps a number.
    #[inline(always)]
    pub fn new(x: f64) -> Self {
        Self {
            x,
            fma: PhantomData,
        }
    }

    /// Returns the number.
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
    fn sqrt(self) -> Self {
        Self::new(self.x.sqrt())
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
