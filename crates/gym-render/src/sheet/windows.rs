//! The windows of a wide row: the pixels that each pixel of a narrow row is made of.

use std::ops::Range;

use super::MOST_SHRUNK;

/// Stands for the colour of a window that is written out in pixels; no colour is like it.
pub(super) const WRITTEN_OUT: u32 = u32::MAX;

/// The first and the last pixel that a pixel of the narrow row is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) first: u16,
    pub(super) last: u16,
}

/// The windows of the pixels of a row.
#[derive(Debug, Default)]
pub(super) struct Layout {
    /// The size of the surface, and of the frame.
    pub(super) from: (usize, usize),
    pub(super) to: (usize, usize),
    /// One for each pixel of the narrow row.
    pub(super) windows: Vec<Window>,
    /// For the border left of each pixel, the window that it lies in; at the ends of the row, the
    /// nearest.
    pub(super) border: Vec<u16>,
    /// Pixels of the widest window.
    pub(super) widest: usize,
}

/// Room for the pixels of any window, in whole vector registers.
pub(super) const MOST: usize = MOST_SHRUNK + 16;

/// The pixels of a window that is written out: all reds, all greens and all blues. Pixels beyond
/// the end of the window mean nothing.
pub(super) type Written<const N: usize> = [[u8; N]; 3];

/// Marks some pixels of a window with 255, the others with 0. It takes no branch that the processor
/// would have to guess.
#[inline]
pub(super) fn mark<const N: usize>(pixels: Range<usize>) -> [u8; N] {
    static STEP: [u8; 2 * MOST] = {
        let mut step = [0; 2 * MOST];
        let mut i = MOST;
        while i < step.len() {
            step[i] = u8::MAX;
            i += 1;
        }
        step
    };
    let [from_start, from_end] =
        [pixels.start, pixels.end].map(|first| &STEP[MOST - first.min(N)..][..N]);
    // (a loop, as `array::from_fn` is not inlined)
    let mut marks = [0; N];
    for (mark, (in_start, in_end)) in marks.iter_mut().zip(from_start.iter().zip(from_end)) {
        *mark = in_start & !in_end;
    }
    marks
}
