//! Reduces windows to pixels of a narrow row, and narrow rows to rows of the frame.

use gym_core::render::Frame;

use super::windows::{EXPANDED, Expanded, Layout, Window, mark};
use crate::pixels::{self, RGB};
use crate::pygame::{Phase, part, phases};

/// The red, green and blue of a pixel or of a sum, and an unused channel.
type Sum = [u16; 4];

/// Reduces rows, and sums them.
///
/// Most windows have the same colour as in the row above, and most pixels of the frame have the
/// colour of the pixel above. If each row of the frame consists of complete rows of the surface,
/// only some windows are *summed*: a window is not summed as long as it has a single colour and had
/// no other colour in the previous row of the frame. The pixel of a window that is not summed is
/// copied from above.
#[derive(Debug, Default)]
pub(super) struct Shrink {
    pub(super) layout: Layout,
    columns: Vec<Phase>,
    rows: Vec<Phase>,
    /// The windows of the previous row: for each its colour or [`EXPANDED`] (`before`), and a bit
    /// for each expanded window (`marks`).
    before: Vec<u32>,
    marks: Vec<u64>,
    /// The last single colour of each window (`colors`), and the pixel to which a window of this
    /// colour is reduced (`solid`).
    colors: Vec<u32>,
    solid: Vec<Sum>,
    /// For each window, the first row whose pixel is not yet added to `sums`.
    since: Vec<u16>,
    /// A row of the surface, reduced horizontally.
    narrow: Vec<Sum>,
    /// The sums of the narrow rows of the current row of the frame.
    sums: Vec<Sum>,
    /// A bit for each window that is summed.
    summed: Vec<u64>,
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
        self.summed.clear();
        self.summed.resize(words, u64::MAX);
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
        // black is reduced to black
        self.colors = vec![0; to.0];
        self.solid = vec![[0; 4]; to.0];
    }

    /// Adds a row of the surface. The last row of the surface that belongs to a row of the frame
    /// completes the row of the frame.
    pub(super) fn row<const N: usize>(
        &mut self,
        flat: &[u32],
        pixels: &[Expanded<N>],
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
            for i in Bits(marks & !self.summed[word]) {
                self.start_sum(64 * word + i, &phase);
            }
            if y < phase.last {
                for i in Bits(marks) {
                    let window = 64 * word + i;
                    let mean = mean(&self.columns[window], &pixels[window]);
                    // `add_solid` will add `solid` for this row too, so subtract it here
                    let (sum, solid) = (&mut self.sums[window], self.solid[window]);
                    for (sum, (mean, solid)) in sum.iter_mut().zip(mean.into_iter().zip(solid)) {
                        *sum = sum.wrapping_add(mean).wrapping_sub(solid);
                    }
                }
            }
        }
        if y < phase.last {
            return;
        }
        self.at.1 += 1;
        if self.is_whole && k > 0 {
            self.complete_summed(pixels, &phase, frame);
        } else {
            let next_share = self.rows.get(k + 1).map_or(0, |next| next.first_share);
            self.complete_all(pixels, &phase, next_share, frame);
        }
        if self.is_whole {
            std::mem::swap(&mut self.summed, &mut self.mixed);
            self.mixed.fill(0);
        }
    }

    /// Starts the sum of a window, if the window is not summed yet.
    #[inline]
    fn start_sum(&mut self, window: usize, phase: &Phase) {
        let (word, bit) = (window / 64, 1 << (window % 64));
        if self.summed[word] & bit == 0 {
            self.summed[word] |= bit;
            self.since[window] = phase.begin as u16;
            self.sums[window] = [0; 4];
        }
    }

    /// Handles the windows whose colour differs from the row above: adds the old colour's pixel to
    /// the sums, for the rows so far.
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
                if color == EXPANDED {
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
        self.start_sum(window, phase);
        self.mixed[window / 64] |= 1 << (window % 64);
        self.colors[window] = color;
        self.add_solid(window, y);
        let columns = &self.columns[window];
        self.solid[window] = apart(color).map(|value| {
            let whole = value.wrapping_mul((columns.last - columns.begin) as u16);
            columns.mean(value, whole, value).into()
        });
    }

    /// Adds `solid` to the sum of a window, for the rows from `since` up to, but excluding, `y`.
    #[inline]
    fn add_solid(&mut self, window: usize, y: u16) {
        let rows = y - std::mem::replace(&mut self.since[window], y);
        let (sum, solid) = (&mut self.sums[window], self.solid[window]);
        for (sum, solid) in sum.iter_mut().zip(solid) {
            *sum = sum.wrapping_add(solid.wrapping_mul(rows));
        }
    }

    /// Completes a row of the frame in which all windows are summed. A part `next_share` of the
    /// surface's last row counts for the next row of the frame.
    fn complete_all<const N: usize>(
        &mut self,
        pixels: &[Expanded<N>],
        phase: &Phase,
        next_share: u16,
        frame: &mut Frame,
    ) {
        for window in 0..self.sums.len() {
            self.add_solid(window, phase.last as u16);
        }
        self.since.fill(phase.last as u16 + 1);
        self.narrow.copy_from_slice(&self.solid);
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

    /// Completes a row of the frame. Copies the pixels of windows that are not summed from the row
    /// above.
    fn complete_summed<const N: usize>(
        &mut self,
        pixels: &[Expanded<N>],
        phase: &Phase,
        frame: &mut Frame,
    ) {
        let bytes = self.layout.to.0 * RGB;
        let (above, row) = frame.pixels_mut()[(self.at.1 - 2) * bytes..].split_at_mut(bytes);
        row[..bytes].copy_from_slice(above);
        for word in 0..self.summed.len() {
            let marks = self.marks[word];
            for i in Bits(self.summed[word]) {
                let window = 64 * word + i;
                let Some(&solid) = self.solid.get(window) else {
                    break;
                };
                let is_marked = marks & 1 << i != 0;
                let values = if is_marked {
                    mean(&self.columns[window], &pixels[window])
                } else {
                    solid
                };
                self.add_solid(window, phase.last as u16);
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

/// Compares up to 64 numbers; returns a bit for each number that changed.
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

/// Unpacks the channels of a packed colour.
#[inline]
fn apart(pixel: u32) -> Sum {
    pixel.to_le_bytes().map(u16::from)
}

/// Returns the pixel to which an expanded window is reduced.
#[inline]
fn mean<const N: usize>(phase: &Phase, window: &Expanded<N>) -> Sum {
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
