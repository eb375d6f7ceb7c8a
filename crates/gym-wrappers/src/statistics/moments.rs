//! Mean and variance of the rows of an array, bit for bit like numpy's `mean` and `var` over axis
//! 0.

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
    /// The moments of a single sample: variance 0, or NaN if the sample is not finite.
    pub(crate) fn of_one(x: T) -> Self {
        let mean = x;
        Self {
            mean,
            m2: (x - mean) * (x - mean),
            n: 1,
        }
    }
}

impl Batch<f32> {
    pub(crate) fn widen(self) -> Batch<f64> {
        Batch {
            mean: self.mean.into(),
            m2: self.m2.into(),
            n: self.n,
        }
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

/// Rows of numbers, `float32` or `float64`, for computing moments, with scratch space.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    pub(crate) f32s: Samples<f32>,
    pub(crate) f64s: Samples<f64>,
}

impl Rows {
    /// Restarts with the selected rows of an array of `n` rows.
    pub(crate) fn collect(&mut self, array: &Array, n: usize, selects: impl Fn(usize) -> bool) {
        let len = array.len() / n.max(1);
        let rows = (0..n)
            .filter(|index| selects(*index))
            .map(|index| index * len..(index + 1) * len);
        if let Some(numbers) = array.as_slice::<f32>() {
            self.f32s.begin(len);
            rows.for_each(|row| self.f32s.extend(numbers[row].iter().copied()));
        } else {
            self.f64s.begin(len);
            rows.for_each(|row| self.f64s.extend(row.map(|i| array.data().get_f64(i))));
        }
    }
}

/// Rows of numbers of one type, and scratch space.
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

    /// Computes mean and variance of each column, and returns the number of rows. Overwrites the
    /// rows.
    pub(crate) fn moments(&mut self) -> usize {
        let Self {
            row_len,
            values,
            mean,
            var,
        } = self;
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
        moments.map(move |(mean, var)| Batch {
            mean: *mean,
            m2: *var * T::from_f64(n as f64),
            n,
        })
    }
}

/// The sum of each column, like `numpy.add.reduce` over axis 0: row after row, but pairwise if each
/// row is a single number.
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

    type Moments<const N: usize> = ([u64; N], [u64; N]);

    /// Mean and variance of `1 / (i + 3)`, alone and beside `i * i % 17` and `-1 / (2 * i + 1)`,
    /// after another batch, which must not affect the result.
    fn moments<T: Real>(n: usize, bits: impl Fn(T) -> u64) -> (Moments<1>, Moments<3>) {
        let row = |i: usize| {
            let x = i as f64;
            [1.0 / (x + 3.0), (i * i % 17) as f64, -1.0 / (2.0 * x + 1.0)].map(T::from_f64)
        };
        let mut samples = Samples::<T>::default();
        let mut of = |len: usize| {
            samples.begin(2);
            samples.extend([7.0, 9.0].map(T::from_f64));
            samples.moments();
            samples.begin(len);
            (0..n).for_each(|i| samples.extend(row(i).into_iter().take(len)));
            assert_eq!(samples.moments(), n);
            assert!(samples.batches().all(|batch| batch.n == n));
            let bits = |numbers: &[T]| numbers.iter().map(|x| bits(*x)).collect::<Vec<_>>();
            (bits(&samples.mean), bits(&samples.var))
        };
        let ((mean, var), (means, vars)) = (of(1), of(3));
        let one = |bits: Vec<u64>| bits.try_into().unwrap();
        let three = |bits: Vec<u64>| bits.try_into().unwrap();
        ((one(mean), one(var)), (three(means), three(vars)))
    }

    /// `mean(0)` and `var(0)` by numpy 2.4.6.
    #[test]
    fn moments_are_numpys() {
        let of_f64 = [
            (
                1,
                [0x3fd5555555555555],
                [0x0],
                [0x3fd5555555555555, 0x0, 0xbff0000000000000],
                [0x0, 0x0, 0x0],
            ),
            (
                9,
                [0x3fc59db45c90c675],
                [0x3f77602a92c9b900],
                [0x3fc59db45c90c676, 0x401e38e38e38e38e, 0xbfcd9752148a642c],
                [0x3f77602a92c9b900, 0x4040ca4587e6b74f, 0x3fb49eefdc6d0092],
            ),
            (
                129,
                [0x3f9f678a2caebfef],
                [0x3f60e455888ce0b9],
                [0x3f9f678a2caebfe9, 0x402003f80fe03f81, 0xbf9b14ebd957050e],
                [0x3f60e455888ce0b7, 0x404008ec2ba0ce43, 0x3f821f7a913adf0d],
            ),
            (
                300,
                [0x3f9058f3b140d988],
                [0x3f513666c049af63],
                [0x3f9058f3b140d982, 0x40200da740da740e, 0xbf8a2bc8670928c1],
                [0x3f513666c049af65, 0x40400b00977602af, 0x3f7029f3dd1f6e77],
            ),
        ];
        for (n, mean, var, means, vars) in of_f64 {
            assert_eq!(
                moments::<f64>(n, f64::to_bits),
                ((mean, var), (means, vars)),
                "{n} rows"
            );
        }
        let of_f32 = [
            (
                1,
                [0x3eaaaaab],
                [0x0],
                [0x3eaaaaab, 0x0, 0xbf800000],
                [0x0, 0x0, 0x0],
            ),
            (
                9,
                [0x3e2ceda4],
                [0x3bbb0155],
                [0x3e2ceda4, 0x40f1c71c, 0xbe6cba94],
                [0x3bbb0154, 0x4206522c, 0x3da4f77f],
            ),
            (
                129,
                [0x3cfb3c53],
                [0x3b0722ae],
                [0x3cfb3c54, 0x41001fc0, 0xbcd8a762],
                [0x3b0722ae, 0x42004760, 0x3c10fbd5],
            ),
            (
                300,
                [0x3c82c79e],
                [0x3a89b337],
                [0x3c82c7a0, 0x41006d3a, 0xbc515e45],
                [0x3a89b332, 0x420057ff, 0x3b814fa1],
            ),
        ];
        for (n, mean, var, means, vars) in of_f32 {
            assert_eq!(
                moments::<f32>(n, |x| x.to_bits().into()),
                ((mean, var), (means, vars)),
                "{n} rows"
            );
        }
    }
}
