//! One number, or one number for each of several worlds: the smooth stages are generic over both.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

use super::libm;

/// An `f64`, or a vector register with one number per world.
///
/// Each operation rounds like `f64`, so a world has the same bits alone and among others. Model
/// constants are `f64`; write them as the second operand.
pub trait Number:
    Copy
    + Debug
    + Add<Output = Self>
    + Add<f64, Output = Self>
    + Sub<Output = Self>
    + Sub<f64, Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Selects the worlds of a register.
    type At: Copy;

    /// A number in memory.
    type Cell: Copy;

    /// A boolean for each number.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

    /// `x` in each world.
    fn of(place: Self::At, x: f64) -> Self;

    /// Reads numbers.
    fn get(place: Self::At, cell: &Self::Cell) -> Self;

    /// Writes numbers.
    fn put(self, place: Self::At, cell: &mut Self::Cell);

    /// `vector` in each world.
    #[inline(always)]
    fn all_of<const K: usize>(place: Self::At, vector: [f64; K]) -> [Self; K] {
        vector.map(
            #[inline(always)]
            |x| Self::of(place, x),
        )
    }

    /// Reads a vector.
    #[inline(always)]
    fn get_all<const K: usize>(place: Self::At, cells: &[Self::Cell; K]) -> [Self; K] {
        std::array::from_fn(
            #[inline(always)]
            |k| Self::get(place, &cells[k]),
        )
    }

    /// Writes a vector.
    #[inline(always)]
    fn put_all<const K: usize>(vector: [Self; K], place: Self::At, cells: &mut [Self::Cell; K]) {
        for (x, cell) in vector.into_iter().zip(cells) {
            x.put(place, cell);
        }
    }

    /// The magnitudes.
    fn abs(self) -> Self;

    /// The square roots.
    fn sqrt(self) -> Self;

    /// `1 / x`.
    fn inverse(self) -> Self;

    /// The sines and cosines of angles in rad.
    fn sin_cos(self) -> (Self, Self);

    /// Whether each number is less than `x`.
    fn is_below(self, x: f64) -> Self::Mask;

    /// Whether each number is less than `other`.
    fn is_less(self, other: Self) -> Self::Mask;

    /// Whether each number is less than or equal to `other`.
    fn is_at_most(self, other: Self) -> Self::Mask;

    /// Whether each number differs from `from` by more than `by`.
    fn is_off(self, from: f64, by: f64) -> Self::Mask;

    /// Whether each number is zero.
    fn is_zero(self) -> Self::Mask;

    /// Whether the mask is set for all numbers.
    fn all(mask: Self::Mask) -> bool;

    /// `yes` where the mask is set, else `no`. For an `f64`, only the chosen operand is computed.
    fn choose<const K: usize>(
        mask: Self::Mask,
        yes: impl FnOnce() -> [Self; K],
        no: impl FnOnce() -> [Self; K],
    ) -> [Self; K];
}

impl Number for f64 {
    type At = ();
    type Cell = f64;
    type Mask = bool;

    #[inline(always)]
    fn of((): (), x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn get((): (), cell: &f64) -> Self {
        *cell
    }

    #[inline(always)]
    fn put(self, (): (), cell: &mut f64) {
        *cell = self;
    }

    // no loop: the compiler does not turn a loop over the elements into a copy

    #[inline(always)]
    fn all_of<const K: usize>((): (), vector: [f64; K]) -> [Self; K] {
        vector
    }

    #[inline(always)]
    fn get_all<const K: usize>((): (), cells: &[f64; K]) -> [Self; K] {
        *cells
    }

    #[inline(always)]
    fn put_all<const K: usize>(vector: [Self; K], (): (), cells: &mut [f64; K]) {
        *cells = vector;
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        1.0 / self
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        libm::sin_cos(self)
    }

    #[inline(always)]
    fn is_below(self, x: f64) -> bool {
        self < x
    }

    #[inline(always)]
    fn is_less(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn is_at_most(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn is_off(self, from: f64, by: f64) -> bool {
        (self - from).abs() > by
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self == 0.0
    }

    #[inline(always)]
    fn all(mask: bool) -> bool {
        mask
    }

    #[inline(always)]
    fn choose<const K: usize>(
        mask: bool,
        yes: impl FnOnce() -> [Self; K],
        no: impl FnOnce() -> [Self; K],
    ) -> [Self; K] {
        if mask { yes() } else { no() }
    }
}

/// Reads a vector.
#[inline(always)]
pub(crate) fn get<N: Number, const K: usize>(place: N::At, cells: &[N::Cell; K]) -> [N; K] {
    N::get_all(place, cells)
}

/// Writes a vector.
#[inline(always)]
pub(crate) fn put<N: Number, const K: usize>(
    place: N::At,
    vector: [N; K],
    cells: &mut [N::Cell; K],
) {
    N::put_all(vector, place, cells);
}

/// The constants `vector` in each world.
#[inline(always)]
pub(crate) fn of<N: Number, const K: usize>(place: N::At, vector: [f64; K]) -> [N; K] {
    N::all_of(place, vector)
}
