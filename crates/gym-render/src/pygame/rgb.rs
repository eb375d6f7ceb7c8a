//! A frame as a pygame surface.

use std::ops::Range;

use gym_core::canvas::Color;
use gym_core::render::Frame;

use super::Pixels;
use crate::pixels::{self, RGB};

/// A frame as a pygame surface. Row 0 is the top row or, if flipped as in Gymnasium, the bottom
/// row.
///
/// The surface can be wider than the frame. The frame then shows the surface's right part.
pub(crate) struct RgbPixels<'a> {
    pub(crate) frame: &'a mut Frame,
    /// The columns of the surface left of the frame.
    pub(crate) left: i32,
    /// Whether row 0 is the lowest.
    pub(crate) flipped: bool,
    /// The last long run: its bytes in the frame, and its colour. Other drawings empty the range.
    last: (Range<usize>, Color),
    /// Pixels of one colour, from which short runs are copied, and the colour.
    short: ([u8; SHORT], Option<Color>),
}

/// The longest run (a row of equal pixels), in bytes, that counts as short.
const SHORT: usize = 32 * RGB;

impl<'a> RgbPixels<'a> {
    pub(crate) fn new(frame: &'a mut Frame, left: i32, flipped: bool) -> Self {
        Self {
            frame,
            left,
            flipped,
            last: (0..0, Color::BLACK),
            short: ([0; SHORT], None),
        }
    }

    fn row(&mut self, y: i32) -> &mut [u8] {
        let y = if self.flipped {
            self.height() - 1 - y
        } else {
            y
        };
        pixels::row(self.frame, y as usize)
    }
}

impl Pixels for RgbPixels<'_> {
    fn width(&self) -> i32 {
        self.left + self.frame.width() as i32
    }

    fn height(&self) -> i32 {
        self.frame.height() as i32
    }

    fn rows(&self) -> Range<i32> {
        0..self.height()
    }

    fn run(&mut self, x1: i32, x2: i32, y: i32, color: Color) {
        let (x1, x2) = (x1 - self.left, x2 - self.left);
        if x2 < 0 {
            return;
        }
        let columns = x1.max(0) as usize..(x2 + 1) as usize;
        let bytes = columns.len() * RGB;
        let row = if self.flipped {
            self.height() - 1 - y
        } else {
            y
        } as usize;
        let start = (row * self.frame.width() as usize + columns.start) * RGB;
        if bytes <= SHORT {
            let (run, run_color) = &mut self.short;
            if *run_color != Some(color) {
                pixels::fill_run(run, 0..SHORT / RGB, color);
                *run_color = Some(color);
            }
            return self.frame.pixels_mut()[start..start + bytes].copy_from_slice(&run[..bytes]);
        }
        // polygons consist of similar runs: copying the last run is faster than filling
        let (last, last_color) = &self.last;
        if bytes <= last.len() && *last_color == color {
            let first = last.start;
            self.frame
                .pixels_mut()
                .copy_within(first..first + bytes, start);
        } else {
            pixels::fill_run(self.row(y), columns, color);
        }
        self.last = (start..start + bytes, color);
    }

    fn vline(&mut self, x: i32, y1: i32, y2: i32, color: Color) {
        let (low, high) = (y1.min(y2).max(0), y1.max(y2).min(self.height() - 1));
        let column = x - self.left;
        if column < 0 || x >= self.width() || low > high {
            return;
        }
        let top = if self.flipped {
            self.height() - 1 - high
        } else {
            low
        };
        self.last.0 = 0..0;
        let bytes = self.frame.width() as usize * RGB;
        let first = top as usize * bytes + column as usize * RGB;
        let rows = self.frame.pixels_mut()[first..].chunks_mut(bytes);
        for row in rows.take((high - low + 1) as usize) {
            row[..RGB].copy_from_slice(&[color.r, color.g, color.b]);
        }
    }

    fn change(&mut self, x: i32, y: i32, color: Color, f: impl Fn(u8, u8) -> u8) {
        let Ok(x) = usize::try_from(x - self.left) else {
            return;
        };
        self.last.0 = 0..0;
        let pixel = &mut self.row(y)[x * RGB..][..RGB];
        for (d, s) in pixel.iter_mut().zip([color.r, color.g, color.b]) {
            *d = f(*d, s);
        }
    }
}
