//! A set of pixels of one line.

use serde::{Deserialize, Serialize};

/// A set of a line's 160 pixels: pixel `x` is bit `x % 64` of word `x / 64`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Pixels(pub(crate) [u64; 3]);

impl Pixels {
    #[inline(always)]
    pub(crate) fn is_empty(self) -> bool {
        let [a, b, c] = self.0;
        a | b | c == 0
    }

    /// The whole line.
    pub(crate) const ALL: Self = Self([u64::MAX, u64::MAX, 0xffff_ffff]);

    #[inline(always)]
    pub(crate) fn union(self, other: Self) -> Self {
        Self([0, 1, 2].map(|word| self.0[word] | other.0[word]))
    }

    #[inline(always)]
    pub(crate) fn intersection(self, other: Self) -> Self {
        Self([0, 1, 2].map(|word| self.0[word] & other.0[word]))
    }

    /// Returns the symmetric difference.
    #[inline(always)]
    pub(crate) fn difference(self, other: Self) -> Self {
        Self([0, 1, 2].map(|word| self.0[word] ^ other.0[word]))
    }

    /// Returns these pixels left of `x`, and the pixels of `others` from `x` on.
    #[inline(always)]
    pub(crate) fn until(self, x: u8, others: Self) -> Self {
        let Self(ahead) = window(0, usize::from(x));
        Self([0, 1, 2].map(|word| self.0[word] & ahead[word] | others.0[word] & !ahead[word]))
    }

    /// Adds a pattern of up to 32 pixels, with its lowest bit at `x < 160`. Pixels beyond the right
    /// end wrap to the left.
    #[inline(always)]
    pub(crate) fn stamp(&mut self, x: u8, pattern: u32) {
        let wide = u128::from(pattern) << (x & 63);
        let (low, high) = (wide as u64, (wide >> 64) as u64);
        let [a, b, c] = self.0;
        self.0 = match x >> 6 {
            0 => [a | low, b | high, c],
            1 => [a, b | low, c | high],
            _ => [a | low >> 32, b, c | low & 0xffff_ffff],
        };
    }
}

/// Returns the pixels `from..to`.
#[inline]
pub(crate) fn window(from: usize, to: usize) -> Pixels {
    let below = |x: usize, word: usize| match x.checked_sub(64 * word) {
        Some(bits @ 0..64) => (1 << bits) - 1,
        Some(_) => u64::MAX,
        None => 0,
    };
    Pixels([0, 1, 2].map(|word| below(to, word) & !below(from, word)))
}
