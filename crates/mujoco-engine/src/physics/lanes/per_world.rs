//! A number of each world, and the vector registers that hold these numbers.

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use crate::math::number::Number;

/// The largest number of worlds that step together.
pub(crate) const WORLDS: usize = 8;

/// The value of one variable in every world, one world per lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct PerWorld(pub(crate) [f64; WORLDS]);

impl PerWorld {
    pub(super) const ZERO: Self = Self([0.0; WORLDS]);
}

impl Default for PerWorld {
    fn default() -> Self {
        Self::ZERO
    }
}

#[cfg(test)]
impl crate::physics::work::Poison for PerWorld {
    fn poison(&mut self) {
        self.0.poison();
    }
}

/// A register: the SIMD token, and the index of the world in the register's first lane.
pub(super) type At<S> = (S, usize);

impl<S: Simd> Number for Lanes<S> {
    type At = At<S>;
    type Cell = PerWorld;
    type Mask = <Self as Real>::Mask;

    #[inline(always)]
    fn of(place: At<S>, x: f64) -> Self {
        same(place, x)
    }

    #[inline(always)]
    fn get(place: At<S>, cell: &PerWorld) -> Self {
        load(place, cell)
    }

    #[inline(always)]
    fn put(self, place: At<S>, cell: &mut PerWorld) {
        store(place, cell, self);
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Real::abs(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Real::sqrt(self)
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        self.same(1.0) / self
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        Real::sin_cos(self)
    }

    #[inline(always)]
    fn is_below(self, x: f64) -> Self::Mask {
        self.lt(self.same(x))
    }

    #[inline(always)]
    fn is_less(self, other: Self) -> Self::Mask {
        self.lt(other)
    }

    #[inline(always)]
    fn is_at_most(self, other: Self) -> Self::Mask {
        self.le(other)
    }

    #[inline(always)]
    fn is_off(self, from: f64, by: f64) -> Self::Mask {
        Real::abs(self - from).gt(self.same(by))
    }

    #[inline(always)]
    fn is_zero(self) -> Self::Mask {
        Real::abs(self).le(self.same(0.0))
    }

    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        <Self as Real>::all(mask)
    }

    #[inline(always)]
    fn choose<const K: usize>(
        mask: Self::Mask,
        yes: impl FnOnce() -> [Self; K],
        no: impl FnOnce() -> [Self; K],
    ) -> [Self; K] {
        let (yes, mut no) = (yes(), no());
        for (no, yes) in no.iter_mut().zip(yes) {
            *no = Self::select(mask, yes, *no);
        }
        no
    }
}

/// Loads the values of the worlds in the register.
#[inline(always)]
pub(super) fn load<S: Simd>((simd, at): At<S>, row: &PerWorld) -> Lanes<S> {
    // the mask keeps `at` within the row, so the compiler drops the bounds check
    let at = at & (WORLDS - <Lanes<S> as Real>::LANES);
    <Lanes<S> as Real>::get(simd, &row.0[at..at + <Lanes<S> as Real>::LANES])
}

#[inline(always)]
pub(super) fn store<S: Simd>((_, at): At<S>, row: &mut PerWorld, x: Lanes<S>) {
    let at = at & (WORLDS - <Lanes<S> as Real>::LANES);
    Real::put(x, &mut row.0[at..at + <Lanes<S> as Real>::LANES]);
}

#[inline(always)]
pub(super) fn same<S: Simd>((simd, _): At<S>, x: f64) -> Lanes<S> {
    <Lanes<S> as Real>::get(simd, &[x; WORLDS])
}

/// Copies the values of the worlds in the register.
#[inline(always)]
pub(super) fn copy<S: Simd>(at: At<S>, from: &[PerWorld], to: &mut [PerWorld]) {
    for (to, from) in to.iter_mut().zip(from) {
        store(at, to, load::<S>(at, from));
    }
}
