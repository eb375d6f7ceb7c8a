use gym_core::registry::WrapperConfig;
use gym_core::{Array, DType, Error, Result};

use super::RunningMeanStd;
use super::moments::{Batch, Rows, Samples};

/// The state of both normalizing wrappers.
#[derive(Clone, Debug)]
pub(crate) struct Normalizer {
    pub(crate) statistics: RunningMeanStd,
    pub(crate) updates: bool,
    epsilon: f64,
    rows: Rows,
}

impl Normalizer {
    pub(crate) fn new<C: WrapperConfig>(
        statistics: RunningMeanStd,
        epsilon: f64,
        updates: bool,
    ) -> Result<Self> {
        match epsilon > 0.0 && epsilon.is_finite() {
            true => Ok(Self {
                statistics,
                updates,
                epsilon,
                rows: Rows::default(),
            }),
            false => Err(C::refuse(format!(
                "epsilon is {epsilon}: it must be above 0"
            ))),
        }
    }

    /// Replaces the statistics by `statistics`, which must have the same length.
    pub(crate) fn set_statistics(&mut self, statistics: RunningMeanStd) -> Result<()> {
        statistics.expect_len(self.statistics.len())?;
        self.statistics = statistics;
        Ok(())
    }

    /// Refuses statistics of a snapshot that have another length.
    pub(crate) fn check(&self, statistics: &RunningMeanStd) -> Result<()> {
        statistics
            .expect_len(self.statistics.len())
            .map_err(|error| Error::Snapshot(error.to_string()))
    }

    /// Updates the statistics with the numbers of one observation, and normalizes them.
    pub(crate) fn row<I: Iterator<Item = f64> + Clone>(
        &mut self,
        dtype: DType,
        row: I,
        out: &mut [f32],
    ) {
        if self.updates {
            self.statistics.update_row(dtype, row.clone());
        }
        self.statistics.normalize(dtype, row, self.epsilon, out);
    }

    /// Updates the statistics with one batch: the rows of `array` for which `selects` is true.
    /// `array` has `n` rows.
    pub(crate) fn take_in(&mut self, array: &Array, n: usize, selects: impl Fn(usize) -> bool) {
        if self.updates {
            self.rows.collect(array, n, selects);
            self.statistics.update_rows(array.dtype(), &mut self.rows);
        }
    }

    /// Normalizes those of the `n` rows for which `selects` is true.
    pub(crate) fn normalize(
        &self,
        array: &Array,
        n: usize,
        out: &mut [f32],
        selects: impl Fn(usize) -> bool,
    ) {
        let len = array.len() / n;
        for (i, out) in out
            .chunks_exact_mut(len.max(1))
            .enumerate()
            .filter(|(i, _)| selects(*i))
        {
            let row = (i * len..(i + 1) * len).map(|j| array.data().get_f64(j));
            self.statistics
                .normalize(array.dtype(), row, self.epsilon, out);
        }
    }

    /// Updates statistics of one `float64` number with a batch of `float32` numbers.
    pub(crate) fn take_in_numbers(&mut self, numbers: impl Iterator<Item = f32>) {
        let samples: &mut Samples<f32> = &mut self.rows.f32s;
        samples.begin(1);
        samples.extend(numbers);
        let n = samples.moments();
        self.statistics
            .update_f64(self.rows.f32s.batches().map(Batch::widen), n);
    }

    /// Returns the standard deviation of the first number, for statistics of a single number.
    pub(crate) fn deviation(&self) -> f64 {
        (self.statistics.scalar_variance() + self.epsilon).sqrt()
    }
}
