//! Vectors of `f32` with one world in each lane.
//!
//! Each operation rounds like the same operation on one `f32`. Every function called under
//! `fearless_simd` is `#[inline(always)]`: otherwise the compiler would not use the CPU's vector
//! instructions in the function.

use std::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};

use fearless_simd::prelude::*;

/// The largest number of worlds that are solved together.
pub(crate) const LANES: usize = 32;

/// The value of one variable in every world, one world per lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct PerWorld(pub(super) [f32; LANES]);

impl PerWorld {
    pub(super) const ZERO: Self = Self([0.0; LANES]);

    /// Copies lane 0 to the lanes from `len` on.
    pub(super) fn pad(&mut self, len: usize) {
        let first = self.0[0];
        self.0[len..].fill(first);
    }
}

/// The values in `R` registers. With two registers, the CPU works on one register while the other
/// waits for a result.
#[derive(Clone, Copy)]
pub(super) struct Wide<S: Simd, const R: usize>([S::f32s; R]);

#[derive(Clone, Copy)]
pub(super) struct Mask<S: Simd, const R: usize>([S::mask32s; R]);

/// The lanes that fit into `R` registers, from lane `at` on.
#[derive(Clone, Copy)]
pub(super) struct Chunk<S: Simd, const R: usize> {
    pub(super) simd: S,
    pub(super) at: usize,
}

impl<S: Simd, const R: usize> Chunk<S, R> {
    #[inline(always)]
    pub(super) fn same(self, x: f32) -> Wide<S, R> {
        Wide([S::f32s::splat(self.simd, x); R])
    }

    #[inline(always)]
    pub(super) fn load(self, row: &PerWorld) -> Wide<S, R> {
        let mut wide = self.same(0.0);
        for i in 0..R {
            let at = self.at + i * S::f32s::LEN;
            wide.0[i] = S::f32s::from_slice(self.simd, &row.0[at..at + S::f32s::LEN]);
        }
        wide
    }

    #[inline(always)]
    pub(super) fn pair(self, x: &PerWorld, y: &PerWorld) -> Pair<S, R> {
        Pair {
            x: self.load(x),
            y: self.load(y),
        }
    }

    #[inline(always)]
    pub(super) fn store(self, row: &mut PerWorld, wide: Wide<S, R>) {
        for i in 0..R {
            let at = self.at + i * S::f32s::LEN;
            wide.0[i].store_slice(&mut row.0[at..at + S::f32s::LEN]);
        }
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<S: Simd, const R: usize> $trait for Wide<S, R> {
            type Output = Self;

            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for i in 0..R {
                    self.0[i] = $trait::$method(self.0[i], other.0[i]);
                }
                self
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);

impl<S: Simd, const R: usize> Neg for Wide<S, R> {
    type Output = Self;

    #[inline(always)]
    fn neg(mut self) -> Self {
        for i in 0..R {
            self.0[i] = -self.0[i];
        }
        self
    }
}

impl<S: Simd, const R: usize> Wide<S, R> {
    #[inline(always)]
    pub(super) fn lt(self, other: Self) -> Mask<S, R> {
        let mut mask = Mask([self.0[0].simd_lt(other.0[0]); R]);
        for i in 1..R {
            mask.0[i] = self.0[i].simd_lt(other.0[i]);
        }
        mask
    }

    #[inline(always)]
    pub(super) fn ge(self, other: Self) -> Mask<S, R> {
        let mut mask = Mask([self.0[0].simd_ge(other.0[0]); R]);
        for i in 1..R {
            mask.0[i] = self.0[i].simd_ge(other.0[i]);
        }
        mask
    }

    /// Returns the minimum, by comparison like [`math::min`](super::math::min).
    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        self.lt(other).select(self, other)
    }

    /// Returns the maximum, by comparison like [`math::max`](super::math::max).
    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        other.lt(self).select(self, other)
    }

    #[inline(always)]
    pub(super) fn clamp(self, low: Self, high: Self) -> Self {
        low.max(self.min(high))
    }
}

impl<S: Simd, const R: usize> Mask<S, R> {
    #[inline(always)]
    pub(super) fn select(self, yes: Wide<S, R>, mut no: Wide<S, R>) -> Wide<S, R> {
        for i in 0..R {
            no.0[i] = self.0[i].select(yes.0[i], no.0[i]);
        }
        no
    }

    #[inline(always)]
    pub(super) fn choose(self, yes: Pair<S, R>, no: Pair<S, R>) -> Pair<S, R> {
        Pair {
            x: self.select(yes.x, no.x),
            y: self.select(yes.y, no.y),
        }
    }

    #[inline(always)]
    pub(super) fn any(self) -> bool {
        let mut any = false;
        for i in 0..R {
            any |= self.0[i].any_true();
        }
        any
    }
}

impl<S: Simd, const R: usize> BitAnd for Mask<S, R> {
    type Output = Self;

    #[inline(always)]
    fn bitand(mut self, other: Self) -> Self {
        for i in 0..R {
            self.0[i] &= other.0[i];
        }
        self
    }
}

impl<S: Simd, const R: usize> BitOr for Mask<S, R> {
    type Output = Self;

    #[inline(always)]
    fn bitor(mut self, other: Self) -> Self {
        for i in 0..R {
            self.0[i] |= other.0[i];
        }
        self
    }
}

impl<S: Simd, const R: usize> Not for Mask<S, R> {
    type Output = Self;

    #[inline(always)]
    fn not(mut self) -> Self {
        for i in 0..R {
            self.0[i] = !self.0[i];
        }
        self
    }
}

/// Two-dimensional vectors.
#[derive(Clone, Copy)]
pub(super) struct Pair<S: Simd, const R: usize> {
    pub(super) x: Wide<S, R>,
    pub(super) y: Wide<S, R>,
}

impl<S: Simd, const R: usize> Pair<S, R> {
    #[inline(always)]
    pub(super) fn dot(self, other: Self) -> Wide<S, R> {
        self.x * other.x + self.y * other.y
    }

    #[inline(always)]
    pub(super) fn cross(self, other: Self) -> Wide<S, R> {
        self.x * other.y - self.y * other.x
    }

    #[inline(always)]
    pub(super) fn times(self, s: Wide<S, R>) -> Self {
        Self {
            x: s * self.x,
            y: s * self.y,
        }
    }

    /// Returns the velocity, due to the angular velocity `w`, of a point at this lever arm:
    /// [`math::cross_scalar`](super::math::cross_scalar).
    #[inline(always)]
    pub(super) fn turned_by(self, w: Wide<S, R>) -> Self {
        Self {
            x: -w * self.y,
            y: w * self.x,
        }
    }

    /// Returns the vector, turned clockwise by 90°: [`math::cross_one`](super::math::cross_one).
    #[inline(always)]
    pub(super) fn cross_one(self) -> Self {
        Self {
            x: self.y,
            y: -self.x,
        }
    }
}

impl<S: Simd, const R: usize> Add for Pair<S, R> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
        }
    }
}

impl<S: Simd, const R: usize> Sub for Pair<S, R> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
        }
    }
}

impl<S: Simd, const R: usize> Neg for Pair<S, R> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            x: -self.x,
            y: -self.y,
        }
    }
}

/// Declares a struct of [`PerWorld`]s and the methods that all of them need.
macro_rules! per_world {
    ($(#[$doc:meta])* struct $name:ident { $($field:ident),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Debug)]
        pub(in crate::physics::box2d) struct $name {
            $($field: $crate::physics::box2d::wide::PerWorld,)+
        }

        impl $name {
            pub(in crate::physics::box2d) const ZERO: Self =
                Self { $($field: $crate::physics::box2d::wide::PerWorld::ZERO,)+ };

            /// Copies lane 0 to the lanes from `len` on.
            pub(in crate::physics::box2d) fn pad(&mut self, len: usize) {
                $(self.$field.pad(len);)+
            }
        }
    };
}
pub(super) use per_world;
