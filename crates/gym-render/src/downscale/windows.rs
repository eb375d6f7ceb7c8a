//! The windows of a wide row: the pixels that are reduced to each pixel of a narrow row.

use std::ops::Range;

use super::MAX_FACTOR;

/// The value that marks an expanded window instead of a colour. No packed colour has this value.
pub(super) const EXPANDED: u32 = u32::MAX;

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
    /// For the left border of each pixel, and the right end of the row: the window that contains
    /// the border, or the nearest window at the ends of the row.
    pub(super) border: Vec<u16>,
    /// The number of pixels of the widest window.
    pub(super) widest: usize,
}

/// The space for the pixels of the widest window, in complete vector registers.
pub(super) const MOST: usize = MAX_FACTOR + 16;

/// The pixels of an expanded window: all reds, all greens and all blues. Entries beyond the
/// window's end are unused.
pub(super) type Expanded<const N: usize> = [[u8; N]; 3];

/// Returns a mask: 255 for the window's pixels in `pixels`, 0 for the others. The code has no
/// branch, because the CPU would often mispredict it.
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
