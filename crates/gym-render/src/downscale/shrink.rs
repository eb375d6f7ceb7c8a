//! Reduces windows to pixels of a narrow row, and narrow rows to rows of the frame.

use gym_core::render::Frame;

use super::windows::{Layout, WRITTEN_OUT, Window, Written, mark};
use crate::pixels::{self, RGB};
use crate::pygame::{Phase, part, phases};

/// The red, green and blue of a pixel or of a sum, and an unused channel.
type Sum = [u16; 4];

/// Reduces rows, and sums them.
///
/// Most windows have the same colour as in the row above, and most pixels of the frame the colour
/// of the pixel above. If the frame's rows consist of complete surface rows, a window is *loose* as
/// long as it has a single colour and had no other colour in the previous row of the frame: it has
/// no sum, and its pixel is copied from above.
#[derive(Debug, Default)]
pub(super) struct Shrink {
    pub(super) layout: Layout,
    columns: Vec<Phase>,
    rows: Vec<Phase>,
    /// The windows of the previous row: their colours (or [`WRITTEN_OUT`]), and a bit for each
    /// expanded window.
    before: Vec<u32>,
    marks: Vec<u64>,
    /// The last single colour of each window, and its reduced pixel. Few change from row to row.
    colors: Vec<u32>,
    plain: Vec<Sum>,
    /// The row from which on `plain` is not yet added to `sums`.
    since: Vec<u16>,
    /// A narrow row.
    narrow: Vec<Sum>,
    /// The sums of the rows so far.
    sums: Vec<Sum>,
    /// A bit for each window that is not loose.
    tight: Vec<u64>,
    /// A bit for each window that had more than one colour in the current row of the frame.
    mixed: Vec<u64>,
    /// Whether each row of the frame consists of complete surface rows.
    is_whole: bool,
    /// The next rows of the surface and of the frame.
    at: (usize, usize),
}

impl Shrink {
    /// Prepares for a surface of the size `from` and a frame of the size `to`.
    pub(super) fn start(&mut self, from: (usize, usize), to: (usize, usize)) {
        self.at = (0, 0);
        self.sums.clear();
        self.sums.resize(to.0, [0; 4]);
        self.since.clear();
        self.since.resize(to.0, 0);
        let words = to.0 / 64 + 1;
        self.tight.clear();
        self.tight.resize(words, u64::MAX);
        self.mixed.clear();
        self.mixed.resize(words, 0);
        if (self.layout.from, self.layout.to) == (from, to) {
            return;
        }
        self.is_whole = from.1.is_multiple_of(to.1.max(1));
        (self.columns, self.rows) = (phases(from.0, to.0), phases(from.1, to.1));
        self.narrow.resize(to.0, [0; 4]);
        let end = to.0.saturating_sub(1) as u16;
        let mut border = vec![end; from.0 + 1];
        border[0] = 0;
        let mut windows = Vec::new();
        for (i, phase) in self.columns.iter().enumerate() {
            windows.push(Window {
                first: phase.first as u16,
                last: phase.last as u16,
            });
            border[phase.first + 1..=phase.last].fill(i as u16);
        }
        let widest = self
            .columns
            .iter()
            .map(|phase| phase.last - phase.first + 1)
            .max();
        let widest = widest.unwrap_or_default();
        self.layout = Layout {
            from,
            to,
            windows,
            border,
            widest,
        };
        self.before = vec![0; to.0];
        self.marks = vec![0; words];
        // black, which stays black
        self.colors = vec![0; to.0];
        self.plain = vec![[0; 4]; to.0];
    }

    /// Adds a row of the surface; completes a row of the frame with its last row.
    pub(super) fn row<const N: usize>(
        &mut self,
        flat: &[u32],
        pixels: &[Written<N>],
        frame: &mut Frame,
    ) {
        let (y, k) = self.at;
        self.at.0 += 1;
        let Some(&phase) = self.rows.get(k) else {
            return;
        };
        self.change_colors(flat, &phase);
        for word in 0..self.marks.len() {
            let marks = self.marks[word];
            self.mixed[word] |= marks;
            for i in Bits(marks & !self.tight[word]) {
                self.tighten(64 * word + i, &phase);
            }
            if y < phase.last {
                for i in Bits(marks) {
                    let window = 64 * word + i;
                    let mean = mean(&self.columns[window], &pixels[window]);
                    // `add_plain` will add the plain pixel, so it is subtracted here
                    let (sum, plain) = (&mut self.sums[window], self.plain[window]);
                    for (sum, (mean, plain)) in sum.iter_mut().zip(mean.into_iter().zip(plain)) {
                        *sum = sum.wrapping_add(mean).wrapping_sub(plain);
                    }
                }
            }
        }
        if y < phase.last {
            return;
        }
        self.at.1 += 1;
        if self.is_whole && k > 0 {
            self.complete_tight(pixels, &phase, frame);
        } else {
            let next_share = self.rows.get(k + 1).map_or(0, |next| next.first_share);
            self.complete_all(pixels, &phase, next_share, frame);
        }
        if self.is_whole {
            std::mem::swap(&mut self.tight, &mut self.mixed);
            self.mixed.fill(0);
        }
    }

    /// Starts the sum of a loose window, which is then no longer loose.
    #[inline]
    fn tighten(&mut self, window: usize, phase: &Phase) {
        let (word, bit) = (window / 64, 1 << (window % 64));
        if self.tight[word] & bit == 0 {
            self.tight[word] |= bit;
            self.since[window] = phase.begin as u16;
            self.sums[window] = [0; 4];
        }
    }

    /// Handles the windows whose colour differs from the row above: adds their old pixel to the
    /// sums.
    fn change_colors(&mut self, flat: &[u32], phase: &Phase) {
        const MANY: usize = 32;
        for (flat, start) in flat.chunks(MANY).zip((0..).step_by(MANY)) {
            let before = &mut self.before[start..][..flat.len()];
            if is_equal(flat, before) {
                continue;
            }
            let changed = changes(flat, before);
            before.copy_from_slice(flat);
            for i in Bits(changed) {
                let (window, color) = (start + i, flat[i]);
                let bit = 1 << (window % 64);
                if color == WRITTEN_OUT {
                    self.marks[window / 64] |= bit;
                    continue;
                }
                self.marks[window / 64] &= !bit;
                if self.colors[window] != color {
                    self.change_color(window, color, phase);
                }
            }
        }
    }

    fn change_color(&mut self, window: usize, color: u32, phase: &Phase) {
        let y = self.at.0 as u16 - 1;
        self.tighten(window, phase);
        self.mixed[window / 64] |= 1 << (window % 64);
        self.colors[window] = color;
        self.add_plain(window, y);
        let columns = &self.columns[window];
        self.plain[window] = apart(color).map(|value| {
            let whole = value.wrapping_mul((columns.last - columns.begin) as u16);
            columns.mean(value, whole, value).into()
        });
    }

    /// Adds the plain pixel of a window to its sum, for the rows from `since` up to `y`.
    #[inline]
    fn add_plain(&mut self, window: usize, y: u16) {
        let rows = y - std::mem::replace(&mut self.since[window], y);
        let (sum, plain) = (&mut self.sums[window], self.plain[window]);
        for (sum, plain) in sum.iter_mut().zip(plain) {
            *sum = sum.wrapping_add(plain.wrapping_mul(rows));
        }
    }

    /// Completes a row of the frame without loose windows. The last row of the surface may also
    /// count for the next row of the frame.
    fn complete_all<const N: usize>(
        &mut self,
        pixels: &[Written<N>],
        phase: &Phase,
        next_share: u16,
        frame: &mut Frame,
    ) {
        for window in 0..self.sums.len() {
            self.add_plain(window, phase.last as u16);
        }
        self.since.fill(phase.last as u16 + 1);
        self.narrow.copy_from_slice(&self.plain);
        for word in 0..self.marks.len() {
            for i in Bits(self.marks[word]) {
                let window = 64 * word + i;
                self.narrow[window] = mean(&self.columns[window], &pixels[window]);
            }
        }
        for (sum, v) in self
            .sums
            .as_flattened_mut()
            .iter_mut()
            .zip(self.narrow.as_flattened_mut())
        {
            let total = u32::from(sum.wrapping_add(part(*v, phase.last_share)));
            *sum = part(*v, next_share);
            *v = ((total * u32::from(phase.reciprocal)) >> 16) as u16;
        }
        let row = pixels::row(frame, self.at.1 - 1).chunks_exact_mut(RGB);
        for (pixel, [r, g, b, _]) in row.zip(&self.narrow) {
            pixel.copy_from_slice(&[*r as u8, *g as u8, *b as u8]);
        }
    }

    /// Completes a row of the frame; copies its loose windows from the row above.
    fn complete_tight<const N: usize>(
        &mut self,
        pixels: &[Written<N>],
        phase: &Phase,
        frame: &mut Frame,
    ) {
        let bytes = self.layout.to.0 * RGB;
        let (above, row) = frame.pixels_mut()[(self.at.1 - 2) * bytes..].split_at_mut(bytes);
        row[..bytes].copy_from_slice(above);
        for word in 0..self.tight.len() {
            let marks = self.marks[word];
            for i in Bits(self.tight[word]) {
                let window = 64 * word + i;
                let Some(&plain) = self.plain.get(window) else {
                    break;
                };
                let is_marked = marks & 1 << i != 0;
                let values = if is_marked {
                    mean(&self.columns[window], &pixels[window])
                } else {
                    plain
                };
                self.add_plain(window, phase.last as u16);
                self.since[window] += 1;
                let sum = std::mem::take(&mut self.sums[window]);
                for (pixel, (sum, v)) in row[window * RGB..][..RGB]
                    .iter_mut()
                    .zip(sum.into_iter().zip(values))
                {
                    *pixel = phase.of(sum, v);
                }
            }
        }
    }
}

/// Whether two slices are equal. (A comparison of slices would call a function of the C library.)
#[inline]
fn is_equal(a: &[u32], b: &[u32]) -> bool {
    a.iter().zip(b).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

/// Returns a bit for each of up to 64 numbers that changed.
#[inline]
fn changes(now: &[u32], before: &[u32]) -> u64 {
    let bits = now.iter().zip(before).zip(0..);
    bits.fold(0, |changes, ((now, before), i)| {
        changes | u64::from(now != before) << i
    })
}

/// Iterates over the indices of the set bits, from the lowest.
struct Bits(u64);

impl Iterator for Bits {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        let bits = self.0;
        self.0 &= bits.wrapping_sub(1);
        (bits != 0).then_some(bits.trailing_zeros() as usize)
    }
}

/// Unpacks the channels of a pixel.
#[inline]
fn apart(pixel: u32) -> Sum {
    pixel.to_le_bytes().map(u16::from)
}

/// Returns the mean of an expanded window.
#[inline]
fn mean<const N: usize>(phase: &Phase, window: &Written<N>) -> Sum {
    let last = phase.last - phase.first;
    let marks = mark::<N>(phase.begin - phase.first..last);
    let mut mean = [0; 4];
    for (mean, channel) in mean.iter_mut().zip(window) {
        let whole: u32 = channel
            .iter()
            .zip(marks)
            .map(|(value, mark)| u32::from(value & mark))
            .sum();
        *mean = phase
            .mean(channel[0].into(), whole as u16, channel[last].into())
            .into();
    }
    mean
}
