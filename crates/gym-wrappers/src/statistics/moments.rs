//! Mean and variance of the rows of an array, to the bit as numpy's `mean` and `var` over axis 0.

use std::ops::{Add, Div, Mul, Sub};

use gym_core::Array;

/// The moments of one number over a batch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Batch<T> {
    pub(crate) mean: T,
    /// The variance times the number of samples.
    pub(crate) m2: T,
    /// The number of samples.
    pub(crate) n: usize,
}

impl<T: Real> Batch<T> {
    /// A single sample: variance 0, or NaN if the sample is not finite.
    pub(crate) fn of_one(x: T) -> Self {
        let mean = x;
        Self { mean, m2: (x - mean) * (x - mean), n: 1 }
    }
}

impl Batch<f32> {
    pub(crate) fn widen(self) -> Batch<f64> {
        Batch { mean: self.mean.into(), m2: self.m2.into(), n: self.n }
    }
}

/// A float that numpy computes with.
pub(crate) trait Real:
    Copy + Default + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    fn from_f64(x: f64) -> Self;
}

impl Real for f32 {
    fn from_f64(x: f64) -> Self {
        x as f32
    }
}

impl Real for f64 {
    fn from_f64(x: f64) -> Self {
        x
    }
}

/// Rows of numbers whose moments are wanted, as `float32` or as `float64`, and room to work.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    pub(crate) f32s: Samples<f32>,
    pub(crate) f64s: Samples<f64>,
}

impl Rows {
    /// Restarts with the selected rows of an array of `n` rows.
    pub(crate) fn collect(&mut self, array: &Array, n: usize, selects: impl Fn(usize) -> bool) {
        let len = array.len() / n.max(1);
        let rows = (0..n).filter(|index| selects(*index)).map(|index| index * len..(index + 1) * len);
        if let Some(numbers) = array.as_slice::<f32>() {
            self.f32s.begin(len);
            rows.for_each(|row| self.f32s.extend(numbers[row].iter().copied()));
        } else {
            self.f64s.begin(len);
            rows.for_each(|row| self.f64s.extend(row.map(|i| array.data().get_f64(i))));
        }
    }
}

/// Rows of numbers of one type, and room to work.
#[derive(Clone, Debug, Default)]
pub(crate) struct Samples<T> {
    row_len: usize,
    values: Vec<T>,
    mean: Vec<T>,
    var: Vec<T>,
}

impl<T: Real> Samples<T> {
    /// Begins with no rows.
    pub(crate) fn begin(&mut self, row_len: usize) {
        self.row_len = row_len;
        self.values.clear();
    }

    /// Adds the numbers of a row.
    pub(crate) fn extend(&mut self, row: impl IntoIterator<Item = T>) {
        self.values.extend(row);
    }

    /// Computes mean and variance of each column, and returns the number of rows. The rows are used up.
    pub(crate) fn moments(&mut self) -> usize {
        let Self { row_len, values, mean, var } = self;
        let n = values.len().checked_div(*row_len).unwrap_or(0);
        let count = T::from_f64(n as f64);
        mean.resize(*row_len, T::default());
        var.resize(*row_len, T::default());
        sum_columns(values, mean);
        mean.iter_mut().for_each(|x| *x = *x / count);
        for row in values.chunks_exact_mut((*row_len).max(1)) {
            for (x, mean) in row.iter_mut().zip(&*mean) {
                *x = (*x - *mean) * (*x - *mean);
            }
        }
        sum_columns(values, var);
        var.iter_mut().for_each(|x| *x = *x / count);
        n
    }

    /// The result of [`moments`](Self::moments), for each column.
    pub(crate) fn batches(&self) -> impl Iterator<Item = Batch<T>> {
        let n = self.values.len() / self.row_len.max(1);
        let moments = self.mean.iter().zip(&self.var);
        moments.map(move |(mean, var)| Batch { mean: *mean, m2: *var * T::from_f64(n as f64), n })
    }
}

/// The sum of each column, as `numpy.add.reduce` over axis 0: row after row, but pairwise if the rows
/// are single numbers.
fn sum_columns<T: Real>(values: &[T], sums: &mut [T]) {
    if let [sum] = sums {
        *sum = pairwise_sum(values);
        return;
    }
    sums.fill(T::default());
    for row in values.chunks_exact(sums.len().max(1)) {
        for (sum, x) in sums.iter_mut().zip(row) {
            *sum = *sum + *x;
        }
    }
}

/// numpy's pairwise summation (`loops_utils.h.src`).
pub(crate) fn pairwise_sum<T: Real>(values: &[T]) -> T {
    const LANES: usize = 8;
    /// `PW_BLOCKSIZE`
    const BLOCK: usize = 128;
    let n = values.len();
    if n < LANES {
        return values.iter().fold(T::default(), |sum, x| sum + *x);
    }
    if n > BLOCK {
        let half = n / 2;
        let (a, b) = values.split_at(half - half % LANES);
        return pairwise_sum(a) + pairwise_sum(b);
    }
    let mut lanes = [T::default(); LANES];
    lanes.copy_from_slice(&values[..LANES]);
    let mut rest = values[LANES..].chunks_exact(LANES);
    for chunk in &mut rest {
        for (lane, x) in lanes.iter_mut().zip(chunk) {
            *lane = *lane + *x;
        }
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    let sum = ((a + b) + (c + d)) + ((e + f) + (g + h));
    rest.remainder().iter().fold(sum, |sum, x| sum + *x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums by numpy 2.4.6 of `1 / (1 + arange(n))` as `float32`, to the bit.
    #[test]
    fn sums_are_numpys() {
        let cases = [
            (1, 0x3f800000),
            (7, 0x4025f160),
            (8, 0x402df160),
            (9, 0x40350dd2),
            (100, 0x40a5ff01),
            (128, 0x40addc58),
            (129, 0x40ae1bda),
            (300, 0x40c90b97),
            (1000, 0x40ef88fc),
        ];
        for (n, bits) in cases {
            let values: Vec<f32> = (0..n).map(|i| 1.0 / (1.0 + i as f32)).collect();
            assert_eq!(pairwise_sum(&values).to_bits(), bits, "{n}");
        }
    }
}
