//! A set of pixels of one line.

use serde::{Deserialize, Serialize};

/// The visible pixels of a line.
pub(crate) const WIDTH: usize = 160;

/// Which of a line's 160 pixels are set: bit `x % 64` of word `x / 64`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Pixels(pub(crate) [u64; 3]);

impl Pixels {
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
}
