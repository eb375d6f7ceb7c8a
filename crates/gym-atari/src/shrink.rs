//! Shrinking a picture in gray as OpenCV's `resize` with `INTER_AREA`, to the bit.
//!
//! Each number is the mean of what it covers of the picture: first of the columns of each row, then of the rows, in
//! `f32` and in that order. A row that equals the one above it, as most rows of these pictures do, is not added up again.

/// The columns that a number can cover at most, and the rows likewise.
const TAPS: usize = 16;

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
    width: usize,
    /// The sums over columns, for each row of the source.
    across: Vec<f32>,
}

impl Shrink {
    /// From `(height, width)` to `(height, width)`, no larger and at most 14 times smaller; otherwise `None`.
    pub(crate) fn new(source: (usize, usize), target: (usize, usize)) -> Option<Self> {
        let rows = covers(source.0, target.0)?;
        let columns = covers(source.1, target.1)?;
        Some(Self { rows, columns, width: source.1, across: vec![0.0; source.0 * target.1] })
    }

    /// Fills `out` from a picture, both row by row.
    pub(crate) fn shrink(&mut self, picture: &[u8], out: &mut [u8]) {
        let columns = self.columns.len();
        let source = picture.chunks_exact(self.width);
        for (y, row) in source.clone().enumerate() {
            let (above, here) = self.across.split_at_mut(y * columns);
            let here = &mut here[..columns];
            if y > 0 && row == &picture[(y - 1) * self.width..y * self.width] {
                here.copy_from_slice(&above[(y - 1) * columns..]);
                continue;
            }
            for (sum, cover) in here.iter_mut().zip(&self.columns) {
                let covered = &row[cover.first..cover.first + cover.count];
                *sum = covered
                    .iter()
                    .zip(&cover.shares)
                    .fold(0.0, |sum, (&shade, share)| sum + f32::from(shade) * share);
            }
        }
        for (out, cover) in out.chunks_exact_mut(columns).zip(&self.rows) {
            for (x, out) in out.iter_mut().enumerate() {
                let covered = self.across[cover.first * columns + x..].iter().step_by(columns);
                let sum = covered
                    .zip(&cover.shares[..cover.count])
                    .fold(0.0, |sum, (part, share)| sum + share * part);
                *out = f32::round_ties_even(sum) as u8;
            }
        }
    }
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
            shrink.shrink(&noise, &mut out);
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
