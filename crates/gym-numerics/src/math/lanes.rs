//! [`Real`](super::Real) for a SIMD register.

use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

use fearless_simd::prelude::*;

use super::Real;
use super::real::EXPONENT;

/// A vector register of `f64`, for a CPU with fused multiply-add.
#[derive(Clone, Copy)]
pub struct Lanes<S: Simd>(S::f64s);

impl<S: Simd> fmt::Debug for Lanes<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Lanes").field(&self.0.as_slice()).finish()
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }

        impl<S: Simd> $trait<f64> for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(self.same(other))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<S: Simd> Real for Lanes<S> {
    type Mask = S::mask64s;
    type Token = S;

    const LANES: usize = S::f64s::LEN;

    #[inline(always)]
    fn same(self, x: f64) -> Self {
        Self(S::f64s::splat(self.0.token(), x))
    }

    #[inline(always)]
    fn fma(self, b: Self, c: Self) -> Self {
        Self(self.0.mul_add_precise(b.0, c.0))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self(self.0.copysign(sign.0))
    }

    #[inline(always)]
    fn single(self) -> Self {
        Self(self.0.narrow(self.0).widen().0)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        self.0.simd_lt(other.0)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        self.0.simd_le(other.0)
    }

    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(mask.select(yes.0, no.0))
    }

    #[inline(always)]
    fn but_not(mask: Self::Mask, other: Self::Mask) -> Self::Mask {
        mask & !other
    }

    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        mask.any_true()
    }

    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        mask.all_true()
    }

    #[inline(always)]
    fn bits(mask: Self::Mask) -> u64 {
        mask.to_bitmask()
    }

    #[inline(always)]
    fn repair_unless(mut self, mask: Self::Mask, of: Self, f: impl Fn(f64) -> f64) -> Self {
        let mut left = (!mask).to_bitmask();
        while left != 0 {
            let lane = left.trailing_zeros() as usize % Self::LANES;
            self.0[lane] = f(of.0[lane]);
            left &= left - 1;
        }
        self
    }

    #[inline(always)]
    fn exponent(self) -> Self {
        Self(S::f64s::from_bits(self.0.to_bits() & EXPONENT))
    }

    #[inline(always)]
    fn bit(self, bit: u32) -> Self::Mask {
        // shift the bit to the sign and test the sign
        S::mask64s::from_vector(((self.0.to_bits() << (63 - bit)).bitcast::<S::i64s>()) >> 63)
    }

    #[inline(always)]
    fn rows(self, table: &[[f64; 4]; 128]) -> [Self; 4] {
        // loads one row per lane, and transposes the rows in two rounds
        let bits = self.0.to_bits();
        let row = |lane: usize| &table[bits[lane] as usize & 127];
        let part = |i: usize| {
            let mut part = [0.0; 8];
            if Self::LANES >= 4 {
                let per_part = Self::LANES / 4;
                for j in 0..per_part {
                    part[4 * j..][..4].copy_from_slice(row(i * per_part + j));
                }
            } else {
                part[..2].copy_from_slice(&row(i / 2)[2 * (i % 2)..][..2]);
            }
            Self::get(self.0.token(), &part).0
        };
        let (a, b, c, d) = (part(0), part(1), part(2), part(3));
        let (even, odd) = (a.unzip_low(b), a.unzip_high(b));
        let (later_even, later_odd) = (c.unzip_low(d), c.unzip_high(d));
        [
            Self(even.unzip_low(later_even)),
            Self(odd.unzip_low(later_odd)),
            Self(even.unzip_high(later_even)),
            Self(odd.unzip_high(later_odd)),
        ]
    }

    #[inline(always)]
    fn get(simd: S, numbers: &[f64]) -> Self {
        Self(S::f64s::from_slice(simd, &numbers[..Self::LANES]))
    }

    #[inline(always)]
    fn put(self, numbers: &mut [f64]) {
        self.0.store_slice(&mut numbers[..Self::LANES]);
    }
}
