//! The windows of a wide row: the pixels that are reduced to each pixel of a narrow row.

use std::ops::Range;

use super::MOST_SHRUNK;

/// The colour value that marks an expanded window; no colour has this value.
pub(super) const WRITTEN_OUT: u32 = u32::MAX;

/// The first and the last pixel of a window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) first: u16,
    pub(super) last: u16,
}

/// The windows of a row.
#[derive(Debug, Default)]
pub(super) struct Layout {
    /// The sizes of the surface and of the frame.
    pub(super) from: (usize, usize),
    pub(super) to: (usize, usize),
    /// One window per pixel of the narrow row.
    pub(super) windows: Vec<Window>,
    /// For the border left of each pixel: the window that contains it; at the row's ends the
    /// nearest one.
    pub(super) border: Vec<u16>,
    /// The number of pixels of the widest window.
    pub(super) widest: usize,
}

/// Space for the pixels of any window, in complete vector registers.
pub(super) const MOST: usize = MOST_SHRUNK + 16;

/// The pixels of an expanded window: all reds, all greens and all blues. Entries beyond the
/// window's end are unused.
pub(super) type Written<const N: usize> = [[u8; N]; 3];

/// Returns a mask that is 255 for some pixels of a window and 0 for the others. It has no branch,
/// which could be mispredicted.
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
    // (a loop, because `array::from_fn` is not inlined)
    let mut marks = [0; N];
    for (mark, (in_start, in_end)) in marks.iter_mut().zip(from_start.iter().zip(from_end)) {
        *mark = in_start & !in_end;
    }
    marks
}
