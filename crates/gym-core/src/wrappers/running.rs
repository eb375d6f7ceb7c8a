//! Running mean and variance by Chan's parallel update, one sample at a time: Gymnasium's
//! `RunningMeanStd`, in its order of operations.

use serde::{Deserialize, Serialize};

use crate::{DType, Error, Result};

/// The weight of the initial mean 0 and variance 1.
pub(super) const INITIAL_COUNT: f64 = 1e-4;

/// Mean and variance of each element of a row of numbers.
///
/// numpy computes in the type of its operands, so Gymnasium's statistics begin as `float32`. They
/// stay so for `float32` observations and become `float64` with the first update by any other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RunningMeanStd {
    moments: Moments,
    count: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Moments {
    F32 { mean: Vec<f32>, var: Vec<f32> },
    F64 { mean: Vec<f64>, var: Vec<f64> },
}

impl RunningMeanStd {
    pub(super) fn new(len: usize) -> Self {
        Self { moments: Moments::F32 { mean: vec![0.0; len], var: vec![1.0; len] }, count: INITIAL_COUNT }
    }

    /// Whether this can be the state for so many numbers.
    pub(super) fn is_valid(&self, len: usize) -> bool {
        let lens = match &self.moments {
            Moments::F32 { mean, var } => [mean.len(), var.len()],
            Moments::F64 { mean, var } => [mean.len(), var.len()],
        };
        lens == [len, len] && self.count > 0.0
    }

    /// Takes in one observation whose numbers were of type `dtype`.
    pub(super) fn update(&mut self, dtype: DType, values: impl Iterator<Item = f64>) {
        let count = self.count;
        if dtype != DType::F32
            && let Moments::F32 { mean, var } = &self.moments
        {
            // In the first update the product of variance and count is still float32.
            let scaled: Vec<_> = var.iter().map(|var| f64::from(var * count as f32)).collect();
            let mut mean: Vec<_> = mean.iter().map(|x| f64::from(*x)).collect();
            let mut var = vec![0.0; scaled.len()];
            for (((mean, var), scaled), x) in mean.iter_mut().zip(&mut var).zip(scaled).zip(values) {
                update_f64(mean, var, scaled, count, x);
            }
            self.moments = Moments::F64 { mean, var };
            self.count += 1.0;
            return;
        }
        match &mut self.moments {
            Moments::F32 { mean, var } => {
                for ((mean, var), x) in mean.iter_mut().zip(var).zip(values) {
                    update_f32(mean, var, *var * count as f32, count, x as f32);
                }
            }
            Moments::F64 { mean, var } => {
                for ((mean, var), x) in mean.iter_mut().zip(var).zip(values) {
                    update_f64(mean, var, *var * count, count, x);
                }
            }
        }
        self.count += 1.0;
    }

    /// `(x - mean) / sqrt(var + epsilon)` of each number into `out`.
    pub(super) fn normalize(
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
        /// Takes one sample, a batch of variance 0, into the moments of `count` samples; `scaled` is the
        /// variance times the count.
        pub(super) fn $name(mean: &mut $float, var: &mut $float, scaled: $float, count: f64, x: $float) {
            let (count, total) = (count as $float, (count + 1.0) as $float);
            let delta = x - *mean;
            let batch_var = (x - x) * (x - x); // 0, or NaN where the sample is not finite
            let m2 = scaled + batch_var + delta * delta * count / total;
            *mean += delta / total;
            *var = m2 / total;
        }
    };
}
update!(update_f32, f32);
update!(update_f64, f64);

pub(super) fn check_epsilon(wrapper: &str, epsilon: f64) -> Result<()> {
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
