//! Drawing on some rows of a surface, which are kept in windows.

use std::ops::Range;

use gym_core::canvas::Color;

use super::shrink::{Layout, WRITTEN_OUT, Window};
use crate::pygame::Pixels;

/// Some rows of the surface, with room for `N` pixels in each window.
///
/// `N` is a constant so that work on all pixels of a window is a few instructions without a loop.
pub(super) struct Band<'a, const N: usize> {
    pub(super) rows: Range<i32>,
    pub(super) origin: isize,
    pub(super) step: isize,
    pub(super) color: u32,
    /// The colours of the windows, row by row, or [`WRITTEN_OUT`].
    pub(super) flat: &'a mut [u32],
    /// Their pixels, where they are written out.
    pub(super) pixels: &'a mut [[u32; N]],
    pub(super) layout: &'a Layout,
}

impl<const N: usize> Band<'_, N> {
    /// Which row of the band it is.
    fn place(&self, y: i32) -> usize {
        (self.origin + self.step * y as isize) as usize
    }

    /// The windows of a pixel: two where neighbours share it, else the same one twice.
    #[inline]
    fn windows_of(&self, x: i32) -> [usize; 2] {
        [x, x + 1].map(|x| usize::from(self.layout.border[x as usize]))
    }

    /// The number of a window among those of all rows.
    #[inline]
    fn index(&self, row: usize, window: usize) -> usize {
        row * self.layout.windows.len() + window
    }

    /// Writes out a window in which the colour is to appear beside others, if it is not; `false` if it has that
    /// colour already.
    #[inline]
    fn takes_color(&mut self, index: usize, Window { first, last }: Window) -> bool {
        let flat = self.flat[index];
        if flat == self.color {
            return false;
        }
        if flat != WRITTEN_OUT {
            self.flat[index] = WRITTEN_OUT;
            fill(&mut self.pixels[index], 0..i32::from(last - first) + 1, flat);
        }
        true
    }

    /// Colours those of the pixels `x1..x2` that lie in a window.
    #[inline]
    fn fill_part(&mut self, row: usize, window: usize, x1: usize, x2: usize) {
        let (index, window) = (self.index(row, window), self.layout.windows[window]);
        if self.takes_color(index, window) {
            let Window { first, last } = window;
            let [x1, x2, len] = [x1 as i32, x2 as i32, i32::from(last) + 1].map(|x| x - i32::from(first));
            fill(&mut self.pixels[index], x1.max(0)..x2.min(len), self.color);
        }
    }

    /// Makes windows one colour.
    #[inline]
    fn flatten(&mut self, row: usize, windows: Range<usize>) {
        let start = self.index(row, 0);
        let flat = &mut self.flat[start..][windows];
        // quads, of which the last may overlap with the one before, are faster than any number of windows
        if let Some(end) = flat.last_chunk_mut() {
            *end = [self.color; 4];
            flat.as_chunks_mut().0.fill([self.color; 4]);
        } else {
            flat.iter_mut().for_each(|flat| *flat = self.color);
        }
    }
}

/// Colours some pixels of a window. Which ones takes no branch that the processor would have to guess.
#[inline]
fn fill<const N: usize>(window: &mut [u32; N], pixels: Range<i32>, color: u32) {
    for (pixel, i) in window.iter_mut().zip(0..) {
        let inside = u32::from((pixels.start <= i) & (i < pixels.end)).wrapping_neg();
        *pixel = *pixel & !inside | color & inside;
    }
}

/// `(d * (256 - weight) + s * weight) >> 8` of all channels at once, which stays below 2^16 in each.
#[inline]
fn mix(d: u32, s: u32, weight: i32) -> u32 {
    let apart = |pixel: u32| u64::from(pixel & 0x00ff_00ff) | u64::from(pixel & 0xff00) << 24;
    let sum = apart(d) * (256 - weight) as u64 + apart(s) * weight as u64;
    let sum = sum >> 8 & 0x00ff_00ff_00ff;
    sum as u32 | (sum >> 24) as u32 & 0xff00
}

impl<const N: usize> Pixels for Band<'_, N> {
    fn width(&self) -> i32 {
        self.layout.from.0 as i32
    }

    fn height(&self) -> i32 {
        self.layout.from.1 as i32
    }

    fn rows(&self) -> Range<i32> {
        self.rows.clone()
    }

    fn run(&mut self, x1: i32, x2: i32, y: i32, _: Color) {
        let (row, x1, x2) = (self.place(y), x1 as usize, x2 as usize + 1);
        let [left, right] = [x1, x2].map(|x| usize::from(self.layout.border[x]));
        let (mut whole, width) = (0..self.layout.windows.len(), self.layout.from.0);
        if x1 > 0 {
            self.fill_part(row, left, x1, x2);
            whole.start = left + 1;
        }
        if x2 < width {
            if x1 == 0 || right != left {
                self.fill_part(row, right, x1, x2);
            }
            whole.end = right;
        }
        if !whole.is_empty() {
            self.flatten(row, whole);
        }
    }

    fn change(&mut self, x: i32, y: i32, color: Color, f: impl Fn(u8, u8) -> u8) {
        let (row, [left, right]) = (self.place(y), self.windows_of(x));
        for window in left..=right {
            let (index, Window { first, last }) = (self.index(row, window), self.layout.windows[window]);
            let flat = std::mem::replace(&mut self.flat[index], WRITTEN_OUT);
            if flat != WRITTEN_OUT {
                fill(&mut self.pixels[index], 0..i32::from(last - first) + 1, flat);
            }
            if let Some(pixel) = self.pixels[index].get_mut(x as usize - usize::from(first)) {
                let [r, g, b, _] = pixel.to_le_bytes();
                *pixel = u32::from_le_bytes([f(r, color.r), f(g, color.g), f(b, color.b), 0]);
            }
        }
    }

    #[inline]
    fn blend(&mut self, x: i32, y: i32, _: Color, weight: i32) {
        let (row, color, [left, right]) = (self.place(y), self.color, self.windows_of(x));
        for window in left..=right {
            let (index, window) = (self.index(row, window), self.layout.windows[window]);
            // (a colour blended with itself is that colour)
            if self.takes_color(index, window)
                && let Some(pixel) = self.pixels[index].get_mut(x as usize - usize::from(window.first))
            {
                *pixel = mix(*pixel, color, weight);
            }
        }
    }

    #[inline]
    fn blend_span(&mut self, x1: i32, x2: i32, y: i32, _: Color, weight: impl Fn(i32) -> i32) {
        let (row, color) = (self.place(y), self.color);
        let ([left, _], [_, right]) = (self.windows_of(x1), self.windows_of(x2));
        for window in left..=right {
            let (index, window) = (self.index(row, window), self.layout.windows[window]);
            if self.takes_color(index, window) {
                let [first, last] = [window.first, window.last].map(i32::from);
                let (x1, x2) = (x1.max(first), x2.min(last));
                let pixels = self.pixels[index].iter_mut().skip((x1 - first) as usize);
                for (pixel, x) in pixels.zip(x1..=x2) {
                    *pixel = mix(*pixel, color, weight(x));
                }
            }
        }
    }
}
