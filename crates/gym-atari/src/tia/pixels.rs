//! A set of pixels of one line.

use serde::{Deserialize, Serialize};

/// The visible pixels of a line.
pub(crate) const WIDTH: usize = 160;

/// Which of a line's 160 pixels are set: bit `x % 64` of word `x / 64`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Pixels(pub(crate) [u64; 3]);

impl Pixels {
    /// The whole line.
    pub(crate) const ALL: Self = Self([u64::MAX, u64::MAX, u32::MAX as u64]);

    /// These pixels ahead of `x`, and others from there on.
    #[inline]
    pub(crate) fn until(self, x: u8, others: Self) -> Self {
        let Self(ahead) = window(0, usize::from(x));
        Self([0, 1, 2].map(|word| self.0[word] & ahead[word] | others.0[word] & !ahead[word]))
    }

    /// Sets a pattern of up to 32 pixels, its lowest bit at `x < 160`; what leaves the line on the right enters it
    /// again on the left.
    #[inline]
    pub(crate) fn stamp(&mut self, x: u8, pattern: u32) {
        let (word, shift) = (usize::from(x >> 6) % 3, u32::from(x & 63));
        let pattern = u64::from(pattern);
        self.0[word] |= pattern << shift;
        if shift > 32 && word < 2 {
            self.0[word + 1] |= pattern >> (64 - shift);
        }
        self.0[0] |= self.0[2] >> 32;
        self.0[2] &= 0xffff_ffff;
    }

    /// Eight pixels in each byte.
    #[inline]
    pub(crate) fn bytes(&self) -> [u8; WIDTH / 8] {
        let mut bytes = [0; WIDTH / 8];
        let words = self.0.map(u64::to_le_bytes);
        bytes.copy_from_slice(&words.as_flattened()[..WIDTH / 8]);
        bytes
    }
}

/// The pixels `from..to`.
#[inline]
pub(crate) fn window(from: usize, to: usize) -> Pixels {
    let below = |x: usize, word: usize| match x.checked_sub(64 * word) {
        Some(bits @ 0..64) => (1 << bits) - 1,
        Some(_) => u64::MAX,
        None => 0,
    };
    Pixels([0, 1, 2].map(|word| below(to, word) & !below(from, word)))
}
