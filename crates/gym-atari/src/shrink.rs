//! Scales gray pictures down like OpenCV's `resize` with `INTER_AREA`, bit for bit.
//!
//! [`AreaResize`] resizes single pictures; this file resizes a sequence of them. Each output pixel
//! is the weighted mean of the source pixels that it covers: first along the columns of each row,
//! then along the rows, in `f32` and in that order. Most of a picture equals the previous picture,
//! so all sums are kept, and only sums over changed pixels are computed again.

use std::ops::Range;

use gym_wrappers::resize_observation::area::{AreaResize, shares};

use crate::screen::{Row, WIDTH};

/// The most source columns, or rows, that an output pixel can cover.
const TAPS: usize = 16;
/// If no output pixel covers more columns than this, all sums have this length; the weights of
/// columns that are not covered are 0.
const FEW: usize = 4;
/// The number of source columns that are compared at a time.
const CELL: usize = 8;
/// The colour index of black.
const BLACK: u8 = 0;

/// The source pixels of one output pixel along one axis: the first, and the weight of each from
/// there on.
#[derive(Clone, Copy, Debug)]
struct Cover {
    first: usize,
    shares: [f32; TAPS],
    count: usize,
}

/// Scales pictures to one smaller size.
#[derive(Clone, Debug)]
pub(crate) struct Shrink {
    rows: Vec<Cover>,
    columns: Vec<Cover>,
    /// For each cell of source columns: the output columns that cover a part of it.
    cells: Vec<Range<usize>>,
    /// Whether no output pixel covers more than [`FEW`] columns.
    few_columns: bool,
    /// The shade of each byte of a picture.
    pub(crate) shades: &'static [u8; 256],
    /// The previous picture; at first black.
    picture: Vec<Row>,
    /// The weighted sums along the columns of `picture`, row by row.
    across: Vec<f32>,
    /// The output.
    small: Vec<u8>,
    /// For each row of the picture, whether it changed, so that its sums were computed again.
    changed: Vec<bool>,
    /// The shades of a row, followed by zeros.
    row: [f32; WIDTH + TAPS],
    /// The sums along rows, for one output row.
    down: Vec<f32>,
    /// If both sizes shrink by integer factors: the resizer, and the shades of a picture. For these
    /// factors, OpenCV adds in another order.
    whole: Option<(AreaResize, Vec<u8>)>,
}

impl Shrink {
    /// Makes a `Shrink` from pictures with `height` rows to the size `target`, `(height, width)`.
    /// `None` if `target` is larger, or more than 14 times smaller.
    pub(crate) fn new(
        height: usize,
        target: (usize, usize),
        shades: &'static [u8; 256],
    ) -> Option<Self> {
        let rows = covers(height, target.0)?;
        let columns = covers(WIDTH, target.1)?;
        let cells = (0..WIDTH / CELL).map(|cell| {
            let (start, end) = (cell * CELL, (cell + 1) * CELL);
            let first = columns.partition_point(|cover| cover.first + cover.count <= start);
            first..columns.partition_point(|cover| cover.first < end)
        });
        let mut shrink = Self {
            cells: cells.collect(),
            few_columns: columns.iter().all(|cover| cover.count <= FEW),
            rows,
            columns,
            shades,
            picture: vec![[BLACK; WIDTH]; height],
            across: vec![0.0; height * target.1],
            small: vec![0; target.0 * target.1],
            changed: vec![true; height],
            row: [0.0; WIDTH + TAPS],
            down: vec![0.0; target.1],
            whole: (height.is_multiple_of(target.0) && WIDTH.is_multiple_of(target.1)).then(|| {
                let resize = AreaResize::new((height, WIDTH), target, 1);
                (resize, vec![0; height * WIDTH])
            }),
        };
        for y in 0..height {
            shrink.add_across(y, 0..target.1);
        }
        shrink.add_down();
        Some(shrink)
    }

    /// Scales `picture` to `out`, both row by row.
    pub(crate) fn shrink(&mut self, picture: &[u8], out: &mut [u8]) {
        if let Some((resize, shades)) = &mut self.whole {
            for (shade, &byte) in shades.iter_mut().zip(picture) {
                *shade = self.shades[usize::from(byte)];
            }
            resize.resize(shades, out);
            return;
        }
        for (y, row) in picture.as_chunks().0.iter().enumerate() {
            self.changed[y] = self.picture[y] != *row;
            if self.changed[y] {
                self.replace_row(y, row);
            }
        }
        self.add_down();
        out.copy_from_slice(&self.small);
    }

    /// Replaces a row of the stored picture and updates its sums.
    fn replace_row(&mut self, y: usize, row: &Row) {
        let before = std::mem::replace(&mut self.picture[y], *row);
        // the output columns that cover a changed cell
        let mut changed = 0..0;
        let cells = row
            .as_chunks::<CELL>()
            .0
            .iter()
            .zip(before.as_chunks::<CELL>().0);
        for (cell, (pixels, before)) in cells.enumerate() {
            if pixels != before {
                let covering = self.cells[cell].clone();
                if covering.start > changed.end {
                    self.add_across(y, changed);
                    changed = covering;
                } else {
                    changed.end = covering.end;
                }
            }
        }
        self.add_across(y, changed);
    }

    /// Computes the sums of row `y` for the output columns `numbers`.
    fn add_across(&mut self, y: usize, numbers: Range<usize>) {
        let width = self.columns.len();
        let columns = &self.columns[numbers.clone()];
        let (Some(first), Some(last)) = (columns.first(), columns.last()) else {
            return;
        };
        let covered = first.first..last.first + last.count;
        let pixels = &self.picture[y][covered.clone()];
        for (shade, &byte) in self.row[covered].iter_mut().zip(pixels) {
            *shade = f32::from(self.shades[usize::from(byte)]);
        }
        let sums = self.across[y * width..][numbers].iter_mut().zip(columns);
        if self.few_columns {
            sums.for_each(|(sum, cover)| *sum = cover.sum::<FEW>(&self.row));
        } else {
            sums.for_each(|(sum, cover)| *sum = cover.sum::<TAPS>(&self.row));
        }
    }

    /// Computes the output rows that cover a changed row.
    fn add_down(&mut self) {
        let columns = self.columns.len();
        for (out, cover) in self.small.chunks_exact_mut(columns).zip(&self.rows) {
            if !self.changed[cover.first..][..cover.count].contains(&true) {
                continue;
            }
            self.down.fill(0.0);
            let rows = self.across[cover.first * columns..].chunks_exact(columns);
            for (row, share) in rows.zip(&cover.shares[..cover.count]) {
                self.down
                    .iter_mut()
                    .zip(row)
                    .for_each(|(sum, part)| *sum += share * part);
            }
            out.iter_mut()
                .zip(&self.down)
                .for_each(|(out, &sum)| *out = round(sum));
        }
    }
}

impl Cover {
    /// Returns the weighted sum of `N` columns; `N` is at least the number of covered columns.
    #[inline(always)]
    fn sum<const N: usize>(&self, row: &[f32]) -> f32 {
        let covered: &[f32; N] = row[self.first..]
            .first_chunk()
            .expect("zeros follow the shades");
        covered
            .iter()
            .zip(&self.shares)
            .fold(0.0, |sum, (shade, share)| sum + shade * share)
    }
}

/// Rounds half to even: adding 2^23 leaves no mantissa bits for a fraction.
#[inline(always)]
fn round(shade: f32) -> u8 {
    (shade + 8_388_608.0).to_bits() as u8
}

/// Returns the cover of each output pixel. `None` if `target` is larger than `source`, or more than
/// 14 times smaller.
fn covers(source: usize, target: usize) -> Option<Vec<Cover>> {
    if target == 0 || target > source || source > 14 * target {
        return None;
    }
    let cover = |covered: Vec<(usize, f32)>| {
        let mut shares = [0.0; TAPS];
        for (own, (_, share)) in shares.iter_mut().zip(&covered) {
            *own = *share;
        }
        Cover {
            first: covered.first().map_or(0, |(first, _)| *first),
            shares,
            count: covered.len(),
        }
    };
    Some(shares(source, target).into_iter().map(cover).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checksums of OpenCV 5.0.0's results for a picture of noise.
    #[test]
    fn equals_opencvs() {
        let noise: Vec<u8> = (0..210 * 160u32)
            .map(|i| ((i.wrapping_mul(i).wrapping_mul(7).wrapping_add(i * 13)) >> 3) as u8)
            .collect();
        for (target, expected) in OPENCV {
            let mut out = vec![0; target.0 * target.1];
            let mut shrink = Shrink::new(210, *target, &SAME).expect("smaller");
            shrink.shrink(&noise, &mut out);
            assert_eq!(crc32fast::hash(&out), *expected, "{target:?}");
        }
    }

    const OPENCV: &[((usize, usize), u32)] = &[
        ((84, 84), 0xaf5ed6c2),
        ((64, 80), 0xe4afc1fb),
        ((100, 33), 0xe93511e4),
    ];

    /// Maps each byte to itself.
    static SAME: [u8; 256] = {
        let mut shades = [0; 256];
        let mut shade = 0;
        while shade < 256 {
            shades[shade] = shade as u8;
            shade += 1;
        }
        shades
    };

    #[test]
    fn equals_the_resizer_of_single_pictures() {
        let noise: Vec<u8> = (0..210 * 160u32)
            .map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8)
            .collect();
        for target in [
            (84, 84),
            (64, 80),
            (100, 33),
            (15, 12),
            (105, 80),
            (70, 40),
            (210, 160),
        ] {
            let [mut out, mut expected] = [(); 2].map(|()| vec![0; target.0 * target.1]);
            let mut shrink = Shrink::new(210, target, &SAME).expect("smaller");
            shrink.shrink(&noise, &mut out);
            AreaResize::new((210, WIDTH), target, 1).resize(&noise, &mut expected);
            assert!(out == expected, "{target:?}");
        }
    }

    /// The sums stored for earlier pictures do not change the result.
    #[test]
    fn changes_come_out_as_new_pictures_do() {
        for target in [(84, 84), (64, 80), (100, 33), (15, 12), (210, 160)] {
            let new = || Shrink::new(210, target, &SAME).expect("smaller");
            let (mut shrink, mut picture) = (new(), vec![0u8; 210 * WIDTH]);
            let (mut out, mut expected) =
                (vec![0; target.0 * target.1], vec![0; target.0 * target.1]);
            let mut random = 1u32;
            let mut below = |n: usize| {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (random >> 16) as usize % n
            };
            for round in 0..200 {
                for _ in 0..below(4) {
                    let (start, length, shade) =
                        (below(picture.len()), below(400), below(256) as u8);
                    picture[start..]
                        .iter_mut()
                        .take(length)
                        .for_each(|pixel| *pixel = shade);
                }
                shrink.shrink(&picture, &mut out);
                new().shrink(&picture, &mut expected);
                assert!(out == expected, "{target:?}, picture {round}");
            }
        }
    }

    #[test]
    fn other_sizes_are_refused() {
        for target in [(0, 84), (84, 161), (211, 84), (10, 84)] {
            assert!(Shrink::new(210, target, &SAME).is_none(), "{target:?}");
        }
    }
}
