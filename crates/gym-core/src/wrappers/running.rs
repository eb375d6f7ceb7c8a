//! Running mean and variance by Chan's parallel update: Gymnasium's `RunningMeanStd`, in its order of
//! operations.

use serde::{Deserialize, Serialize};

use super::moments::{Batch, Rows};
use crate::{DType, Error, Result};

/// The weight of the initial mean 0 and variance 1.
pub(crate) const INITIAL_COUNT: f64 = 1e-4;

/// Mean and variance of each element of a row of numbers.
///
/// numpy computes in the type of its operands, so Gymnasium's statistics begin as `float32`. They
/// stay so for `float32` observations and become `float64` with the first update by any other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunningMeanStd {
    moments: Moments,
    count: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Moments {
    F32 { mean: Vec<f32>, var: Vec<f32> },
    F64 { mean: Vec<f64>, var: Vec<f64> },
}

impl RunningMeanStd {
    pub(crate) fn new(len: usize) -> Self {
        Self { moments: Moments::F32 { mean: vec![0.0; len], var: vec![1.0; len] }, count: INITIAL_COUNT }
    }

    /// Whether this can be the state for so many numbers.
    pub(crate) fn is_valid(&self, len: usize) -> bool {
        let lens = match &self.moments {
            Moments::F32 { mean, var } => [mean.len(), var.len()],
            Moments::F64 { mean, var } => [mean.len(), var.len()],
        };
        lens == [len, len] && self.count > 0.0
    }

    /// Takes in one observation whose numbers were of type `dtype`.
    pub(crate) fn update(&mut self, dtype: DType, values: impl Iterator<Item = f64>) {
        let count = self.count;
        if dtype != DType::F32
            && let Some((scaled, mean, var)) = self.widen()
        {
            for (((mean, var), scaled), x) in mean.iter_mut().zip(var).zip(scaled).zip(values) {
                update_f64(mean, var, scaled, count, Batch::of_one(x));
            }
            self.count += 1.0;
            return;
        }
        match &mut self.moments {
            Moments::F32 { mean, var } => {
                for ((mean, var), x) in mean.iter_mut().zip(var).zip(values) {
                    update_f32(mean, var, *var * count as f32, count, Batch::of_one(x as f32));
                }
            }
            Moments::F64 { mean, var } => {
                for ((mean, var), x) in mean.iter_mut().zip(var).zip(values) {
                    update_f64(mean, var, *var * count, count, Batch::of_one(x));
                }
            }
        }
        self.count += 1.0;
    }

    /// Makes `float32` statistics `float64`, and returns them with the product of variance and count,
    /// which in the update that does this is still `float32`. `None` if they were `float64` already.
    fn widen(&mut self) -> Option<(Vec<f64>, &mut [f64], &mut [f64])> {
        let Moments::F32 { mean, var } = &self.moments else { return None };
        let count = self.count as f32;
        let scaled = var.iter().map(|var| f64::from(var * count)).collect();
        let [mean, var] = [mean, var].map(|numbers| numbers.iter().map(|x| f64::from(*x)).collect());
        self.moments = Moments::F64 { mean, var };
        match &mut self.moments {
            Moments::F64 { mean, var } => Some((scaled, mean, var)),
            Moments::F32 { .. } => None,
        }
    }

    /// Takes in some observations at once, one per row, whose numbers were of type `dtype`.
    pub(crate) fn update_rows(&mut self, dtype: DType, rows: &mut Rows) {
        let count = self.count;
        let n = match dtype {
            DType::F32 => rows.f32s.moments(),
            _ => rows.f64s.moments(),
        };
        if n == 0 {
            return;
        }
        if dtype != DType::F32
            && let Some((scaled, mean, var)) = self.widen()
        {
            for (((mean, var), scaled), batch) in
                mean.iter_mut().zip(var).zip(scaled).zip(rows.f64s.batches())
            {
                update_f64(mean, var, scaled, count, batch);
            }
        } else {
            match &mut self.moments {
                Moments::F32 { mean, var } => {
                    for ((mean, var), batch) in mean.iter_mut().zip(var).zip(rows.f32s.batches()) {
                        update_f32(mean, var, *var * count as f32, count, batch);
                    }
                }
                Moments::F64 { mean, var } if dtype == DType::F32 => {
                    for ((mean, var), batch) in mean.iter_mut().zip(var).zip(rows.f32s.batches()) {
                        update_f64(mean, var, *var * count, count, batch.widen());
                    }
                }
                Moments::F64 { mean, var } => {
                    for ((mean, var), batch) in mean.iter_mut().zip(var).zip(rows.f64s.batches()) {
                        update_f64(mean, var, *var * count, count, batch);
                    }
                }
            }
        }
        self.count += n as f64;
    }

    /// `(x - mean) / sqrt(var + epsilon)` of each number into `out`.
    pub(crate) fn normalize(
        &self,
        dtype: DType,
        values: impl Iterator<Item = f64>,
        epsilon: f64,
        out: &mut [f32],
    ) {
        match &self.moments {
            Moments::F32 { mean, var } => {
                for (((mean, var), x), out) in mean.iter().zip(var).zip(values).zip(out) {
                    let std = (var + epsilon as f32).sqrt();
                    *out = match dtype {
                        DType::F32 => (x as f32 - mean) / std,
                        _ => ((x - f64::from(*mean)) / f64::from(std)) as f32,
                    };
                }
            }
            Moments::F64 { mean, var } => {
                for (((mean, var), x), out) in mean.iter().zip(var).zip(values).zip(out) {
                    *out = ((x - mean) / (var + epsilon).sqrt()) as f32;
                }
            }
        }
    }
}

macro_rules! update {
    ($name:ident, $float:ty) => {
        /// Takes a batch into the moments of `count` samples; `scaled` is the variance times the count.
        pub(crate) fn $name(
            mean: &mut $float,
            var: &mut $float,
            scaled: $float,
            count: f64,
            batch: Batch<$float>,
        ) {
            let (total, n) = ((count + batch.n as f64) as $float, batch.n as $float);
            let delta = batch.mean - *mean;
            let m2 = scaled + batch.m2 + delta * delta * count as $float * n / total;
            *mean += delta * n / total;
            *var = m2 / total;
        }
    };
}
update!(update_f32, f32);
update!(update_f64, f64);

pub(crate) fn check_epsilon(wrapper: &str, epsilon: f64) -> Result<()> {
    if epsilon > 0.0 && epsilon.is_finite() {
        return Ok(());
    }
    Err(Error::argument(wrapper, format!("epsilon is {epsilon}: it must be above 0")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_approach_those_of_the_samples() {
        let samples: Vec<f64> = (0..1000).map(|i| f64::from(i % 10)).collect();
        for dtype in [DType::F32, DType::F64] {
            let mut running = RunningMeanStd::new(1);
            samples.iter().for_each(|x| running.update(dtype, std::iter::once(*x)));
            let mut out = [0.0; 2];
            running.normalize(dtype, std::iter::once(4.5), 1e-8, &mut out[..1]);
            running.normalize(dtype, std::iter::once(4.5 + 8.25f64.sqrt()), 1e-8, &mut out[1..]);
            assert!(out[0].abs() < 1e-4 && (out[1] - 1.0).abs() < 1e-3, "{out:?}");
        }
    }
}
