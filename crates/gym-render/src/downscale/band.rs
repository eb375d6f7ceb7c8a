//! Draws on some rows of a surface, which are stored as windows.

use std::ops::Range;

use gym_core::canvas::Color;

use super::windows::{EXPANDED, Expanded, Layout, Window, mark};
use crate::pygame::Pixels;

/// Returns the red, green and blue of a packed colour.
#[inline]
fn channels(color: u32) -> [u8; 3] {
    let [r, g, b, _] = color.to_le_bytes();
    [r, g, b]
}

/// Some rows of a surface, with space for `N` pixels per window.
///
/// `N` is a constant, so that work on all pixels of a window compiles to a few instructions without
/// a loop.
pub(super) struct Band<'a, const N: usize> {
    pub(super) rows: Range<i32>,
    pub(super) origin: isize,
    pub(super) step: isize,
    pub(super) color: u32,
    /// For each window, row by row: its colour, or [`EXPANDED`].
    pub(super) flat: &'a mut [u32],
    /// The pixels of the expanded windows.
    pub(super) pixels: &'a mut [Expanded<N>],
    pub(super) layout: &'a Layout,
}

impl<const N: usize> Band<'_, N> {
    /// Returns the index of row `y` in the band.
    fn place(&self, y: i32) -> usize {
        (self.origin + self.step * y as isize) as usize
    }

    /// Returns the first and the last window that contain the pixel `x`.
    #[inline]
    fn windows_of(&self, x: i32) -> [usize; 2] {
        [x, x + 1].map(|x| usize::from(self.layout.border[x as usize]))
    }

    /// Returns the index of a window, counted over all rows.
    #[inline]
    fn index(&self, row: usize, window: usize) -> usize {
        row * self.layout.windows.len() + window
    }

    /// Returns the pixels of a window, and expands the window if it has a single colour. Returns
    /// `None` if this colour is the band's colour, because drawing would then change nothing.
    #[inline]
    fn expand_unless_covered(&mut self, index: usize) -> Option<&mut Expanded<N>> {
        let flat = self.flat[index];
        if flat == self.color {
            return None;
        }
        Some(self.expand(index))
    }

    /// Returns the pixels of a window; expands them if the window has a single colour.
    #[inline]
    fn expand(&mut self, index: usize) -> &mut Expanded<N> {
        let flat = std::mem::replace(&mut self.flat[index], EXPANDED);
        let pixels = &mut self.pixels[index];
        if flat != EXPANDED {
            for (channel, value) in pixels.iter_mut().zip(channels(flat)) {
                *channel = [value; N];
            }
        }
        pixels
    }

    /// Colours the pixels of the window `window` that are in `x1..x2`.
    #[inline]
    fn fill_part(&mut self, row: usize, window: usize, x1: usize, x2: usize) {
        let (index, color) = (self.index(row, window), self.color);
        let first = usize::from(self.layout.windows[window].first);
        if let Some(pixels) = self.expand_unless_covered(index) {
            let marks = mark::<N>(x1.saturating_sub(first)..x2 - first);
            for (channel, value) in pixels.iter_mut().zip(channels(color)) {
                for (pixel, mark) in channel.iter_mut().zip(marks) {
                    *pixel ^= (*pixel ^ value) & mark;
                }
            }
        }
    }

    /// Sets whole windows to the band's colour.
    #[inline]
    fn flatten(&mut self, row: usize, windows: Range<usize>) {
        let start = self.index(row, 0);
        let flat = &mut self.flat[start..][windows];
        // fill groups of four windows; the last group may overlap the others (faster than single
        // windows)
        if let Some(end) = flat.last_chunk_mut() {
            *end = [self.color; 4];
            flat.as_chunks_mut().0.fill([self.color; 4]);
        } else {
            flat.iter_mut().for_each(|flat| *flat = self.color);
        }
    }
}

/// Blends each channel of a pixel: `(d * (256 - weight) + s * weight) >> 8`.
#[inline]
fn mix<const N: usize>(pixels: &mut Expanded<N>, x: usize, color: u32, weight: i32) {
    for (channel, s) in pixels.iter_mut().zip(channels(color)) {
        if let Some(d) = channel.get_mut(x) {
            *d = ((i32::from(*d) * (256 - weight) + i32::from(s) * weight) >> 8) as u8;
        }
    }
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
            let x = x as usize - usize::from(self.layout.windows[window].first);
            let channels = self.expand(self.index(row, window)).iter_mut();
            for (channel, s) in channels.zip([color.r, color.g, color.b]) {
                if let Some(d) = channel.get_mut(x) {
                    *d = f(*d, s);
                }
            }
        }
    }

    #[inline]
    fn blend(&mut self, x: i32, y: i32, _: Color, weight: i32) {
        let (row, color, [left, right]) = (self.place(y), self.color, self.windows_of(x));
        for window in left..=right {
            let first = usize::from(self.layout.windows[window].first);
            // (blending a colour with itself changes nothing)
            if let Some(pixels) = self.expand_unless_covered(self.index(row, window)) {
                mix(pixels, x as usize - first, color, weight);
            }
        }
    }

    #[inline]
    fn blend_span(&mut self, x1: i32, x2: i32, y: i32, _: Color, weight: impl Fn(i32) -> i32) {
        let (row, color) = (self.place(y), self.color);
        let ([left, _], [_, right]) = (self.windows_of(x1), self.windows_of(x2));
        for window in left..=right {
            let Window { first, last } = self.layout.windows[window];
            let [first, last] = [first, last].map(i32::from);
            if let Some(pixels) = self.expand_unless_covered(self.index(row, window)) {
                for x in x1.max(first)..=x2.min(last) {
                    mix(pixels, (x - first) as usize, color, weight(x));
                }
            }
        }
    }
}
