//! Shrinking a picture in gray as OpenCV's `resize` with `INTER_AREA`, to the bit.
//!
//! Each number is the mean of what it covers of the picture: first of the columns of each row, then of the rows, in
//! `f32` and in that order. Where a row equals the one above it, as most of most rows do, it is not added up again.

use std::ops::Range;

/// The columns that a number can cover at most, and the rows likewise.
const TAPS: usize = 16;
/// As many are added up without counting: shares beyond the last are 0.
const FEW: usize = 4;
/// The columns of the picture that are compared at a time.
const CELL: usize = 8;

/// What one number covers along one axis: the first of the source, and the share of each from there on.
#[derive(Clone, Copy, Debug)]
struct Cover {
    first: usize,
    shares: [f32; TAPS],
    count: usize,
}

/// From pictures of one size to a smaller one.
#[derive(Clone, Debug)]
pub(crate) struct Shrink {
    rows: Vec<Cover>,
    columns: Vec<Cover>,
    /// The numbers that cover some of each cell of a row.
    cells: Vec<Range<usize>>,
    width: usize,
    /// Whether no number covers more than a few columns.
    few_columns: bool,
    /// A row's shades, and zeros behind them.
    shades: Vec<f32>,
    /// The sums over columns, for each row of the source.
    across: Vec<f32>,
    /// The sums over rows, of a row of the target.
    down: Vec<f32>,
}

impl Shrink {
    /// From `(height, width)` to `(height, width)`, no larger and at most 14 times smaller; otherwise `None`.
    pub(crate) fn new(source: (usize, usize), target: (usize, usize)) -> Option<Self> {
        let rows = covers(source.0, target.0)?;
        let columns = covers(source.1, target.1)?;
        let cells = (0..source.1.div_ceil(CELL)).map(|cell| {
            let (start, end) = (cell * CELL, (cell + 1) * CELL);
            let first = columns.partition_point(|cover| cover.first + cover.count <= start);
            first..columns.partition_point(|cover| cover.first < end)
        });
        Some(Self {
            cells: cells.collect(),
            few_columns: columns.iter().all(|cover| cover.count <= FEW),
            rows,
            columns,
            width: source.1,
            shades: vec![0.0; source.1 + TAPS],
            across: vec![0.0; source.0 * target.1],
            down: vec![0.0; target.1],
        })
    }

    /// Fills `out` from a picture, both row by row, of which each byte stands for a shade.
    pub(crate) fn shrink(&mut self, picture: &[u8], shades: &[u8; 256], out: &mut [u8]) {
        let columns = self.columns.len();
        let mut above: &[u8] = &[];
        for (y, row) in picture.chunks_exact(self.width).enumerate() {
            let start = y * columns;
            if y > 0 {
                self.across.copy_within(start - columns..start, start);
            }
            // the numbers that cover something else than in the row above
            let mut changed = 0..0;
            for (cell, pixels) in row.chunks(CELL).enumerate() {
                let first = cell * CELL;
                if above.get(first..first + pixels.len()) != Some(pixels) {
                    for (shade, &byte) in self.shades[first..].iter_mut().zip(pixels) {
                        *shade = f32::from(shades[usize::from(byte)]);
                    }
                    let covering = self.cells[cell].clone();
                    if covering.start > changed.end {
                        self.add_up(start, changed);
                        changed = covering;
                    } else {
                        changed = changed.start.min(covering.start)..covering.end;
                    }
                }
            }
            self.add_up(start, changed);
            above = row;
        }
        for (out, cover) in out.chunks_exact_mut(columns).zip(&self.rows) {
            self.down.fill(0.0);
            let rows = self.across[cover.first * columns..].chunks_exact(columns);
            for (row, share) in rows.zip(&cover.shares[..cover.count]) {
                self.down.iter_mut().zip(row).for_each(|(sum, part)| *sum += share * part);
            }
            out.iter_mut().zip(&self.down).for_each(|(out, &sum)| *out = round(sum));
        }
    }
}

impl Shrink {
    /// Adds up the shades that some numbers of a row cover; the row's first is at `start`.
    #[inline(always)]
    fn add_up(&mut self, start: usize, numbers: Range<usize>) {
        if numbers.is_empty() {
            return;
        }
        let sums = self.across[start..][numbers.clone()].iter_mut().zip(&self.columns[numbers]);
        if self.few_columns {
            sums.for_each(|(sum, cover)| *sum = cover.sum::<FEW>(&self.shades));
        } else {
            sums.for_each(|(sum, cover)| *sum = cover.sum::<TAPS>(&self.shades));
        }
    }
}

impl Cover {
    /// The mean of `N` columns, at least as many as it covers.
    #[inline(always)]
    fn sum<const N: usize>(&self, shades: &[f32]) -> f32 {
        let covered: &[f32; N] = shades[self.first..].first_chunk().expect("zeros follow the shades");
        covered.iter().zip(&self.shares).fold(0.0, |sum, (shade, share)| sum + shade * share)
    }
}

/// The nearest whole number, of two the even one: adding 2^23 leaves no place for digits behind the point.
#[inline(always)]
fn round(shade: f32) -> u8 {
    (shade + 8_388_608.0).to_bits() as u8
}

/// What each number covers, with shares below a thousandth left out.
fn covers(source: usize, target: usize) -> Option<Vec<Cover>> {
    const LEAST: f64 = 1e-3;
    if target == 0 || target > source || source > 14 * target {
        return None;
    }
    let scale = 1.0 / (target as f64 / source as f64);
    let cover = |i: usize| {
        let start = i as f64 * scale;
        let end = start + scale;
        let width = scale.min(source as f64 - start);
        let last = (end.floor() as usize).min(source - 1);
        let first = (start.ceil() as usize).min(last);
        let mut cover = Cover { first, shares: [0.0; TAPS], count: 0 };
        let mut add = |share: f64| {
            cover.shares[cover.count] = share as f32;
            cover.count += 1;
        };
        let cut = first as f64 - start > LEAST;
        if cut {
            add((first as f64 - start) / width);
        }
        (first..last).for_each(|_| add(1.0 / width));
        if end - last as f64 > LEAST {
            add((end - last as f64).min(1.0).min(width) / width);
        }
        cover.first -= usize::from(cut);
        cover
    };
    Some((0..target).map(cover).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checksums of what OpenCV 5.0.0 makes of a picture of noise.
    #[test]
    fn equals_opencvs() {
        let noise: Vec<u8> = (0..210 * 160u32)
            .map(|i| ((i.wrapping_mul(i).wrapping_mul(7).wrapping_add(i * 13)) >> 3) as u8)
            .collect();
        for (target, expected) in OPENCV {
            let mut out = vec![0; target.0 * target.1];
            let mut shrink = Shrink::new((210, 160), *target).expect("smaller");
            shrink.shrink(&noise, &std::array::from_fn(|shade| shade as u8), &mut out);
            assert_eq!(crc32fast::hash(&out), *expected, "{target:?}");
        }
    }

    const OPENCV: &[((usize, usize), u32)] =
        &[((84, 84), 0xaf5ed6c2), ((64, 80), 0xe4afc1fb), ((100, 33), 0xe93511e4)];

    #[test]
    fn other_sizes_are_refused() {
        for target in [(0, 84), (84, 161), (211, 84), (10, 84)] {
            assert!(Shrink::new((210, 160), target).is_none(), "{target:?}");
        }
    }
}
