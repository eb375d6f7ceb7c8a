//! Running mean and variance by Chan's parallel update: Gymnasium's `RunningMeanStd`, in its order
//! of operations.

mod moments;
mod normalizer;

use gym_core::{Array, DType, Data, Error, Result};
use serde::{Deserialize, Serialize};

use moments::{Batch, Real, Rows};
pub(crate) use normalizer::Normalizer;

/// The weight of the initial mean 0 and variance 1.
const INITIAL_COUNT: f64 = 1e-4;

/// A running estimate of mean and variance of each element of rows of numbers: Gymnasium's
/// `RunningMeanStd`.
///
/// [`NormalizeObservation`](crate::NormalizeObservation) and
/// [`NormalizeReward`](crate::NormalizeReward) have one each, around environments and vectors. It
/// is plain data: take it from a training, store it as JSON, and set it in an environment for
/// evaluation.
///
/// ```
/// use gym_wrappers::RunningMeanStd;
///
/// let mut statistics = RunningMeanStd::new(1);
/// for x in [1.0_f32, 2.0, 3.0] {
///     statistics.update(&[x].into())?;
/// }
/// assert!((statistics.mean().as_slice::<f32>().unwrap()[0] - 2.0).abs() < 1e-3);
///
/// let json = serde_json::to_string(&statistics).unwrap();
/// assert_eq!(serde_json::from_str::<RunningMeanStd>(&json).unwrap(), statistics);
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// numpy computes in the type of its operands, so Gymnasium's statistics begin as `float32`. They
/// become `float64` with the first update by rows of another type.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts")]
pub struct RunningMeanStd {
    moments: Moments,
    count: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Moments {
    F32(MeanAndVariance<f32>),
    F64(MeanAndVariance<f64>),
}

/// The mean and variance of each number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct MeanAndVariance<T> {
    mean: Vec<T>,
    var: Vec<T>,
}

impl Moments {
    fn mean(&self) -> Array {
        match self {
            Self::F32(of) => of.mean.clone().into(),
            Self::F64(of) => of.mean.clone().into(),
        }
    }

    fn variance(&self) -> Array {
        match self {
            Self::F32(of) => of.var.clone().into(),
            Self::F64(of) => of.var.clone().into(),
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::F32(of) => of.mean.len(),
            Self::F64(of) => of.mean.len(),
        }
    }
}

/// The unchecked form of [`RunningMeanStd`].
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Parts {
    moments: Moments,
    count: f64,
}

impl TryFrom<Parts> for RunningMeanStd {
    type Error = Error;

    fn try_from(Parts { moments, count }: Parts) -> Result<Self> {
        let variances = moments.variance();
        let (mean, var) = (moments.len(), variances.len());
        let refuse = |reason: String| Err(Error::argument("RunningMeanStd", reason));
        if mean != var {
            return refuse(format!(
                "the mean has {mean} numbers and the variance {var}"
            ));
        }
        if !variances.iter_f64().all(|x| x >= 0.0) {
            return refuse("a variance is negative or NaN".into());
        }
        if !(count > 0.0 && count.is_finite()) {
            return refuse(format!("count is {count}: it must be above 0"));
        }
        Ok(Self { moments, count })
    }
}

impl RunningMeanStd {
    /// The statistics of `len` numbers before the first row: mean 0, variance 1, and a weight close
    /// to 0.
    pub fn new(len: usize) -> Self {
        let moments = Moments::F32(MeanAndVariance {
            mean: vec![0.0; len],
            var: vec![1.0; len],
        });
        Self {
            moments,
            count: INITIAL_COUNT,
        }
    }

    /// As [`new`](Self::new), in `float64` from the start.
    pub fn new_f64(len: usize) -> Self {
        let moments = Moments::F64(MeanAndVariance {
            mean: vec![0.0; len],
            var: vec![1.0; len],
        });
        Self {
            moments,
            count: INITIAL_COUNT,
        }
    }

    /// Statistics with a `mean` and a `variance` of equal length, both `float32` or both
    /// `float64`, of `count` rows.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for other types or lengths, a variance that is negative or NaN,
    /// or a count that is not above 0.
    pub fn from_moments(mean: &Array, variance: &Array, count: f64) -> Result<Self> {
        let moments = match (mean.data(), variance.data()) {
            (Data::F32(mean), Data::F32(var)) => Moments::F32(MeanAndVariance {
                mean: mean.clone(),
                var: var.clone(),
            }),
            (Data::F64(mean), Data::F64(var)) => Moments::F64(MeanAndVariance {
                mean: mean.clone(),
                var: var.clone(),
            }),
            _ => {
                let [mean, variance] = [mean.dtype(), variance.dtype()];
                let reason = format!(
                    "mean and variance are {mean} and {variance}: both must be float32 or float64"
                );
                return Err(Error::argument("RunningMeanStd", reason));
            }
        };
        Parts { moments, count }.try_into()
    }

    /// The mean of each number, of shape `(len,)`.
    pub fn mean(&self) -> Array {
        self.moments.mean()
    }

    /// The variance of each number, of shape `(len,)`.
    pub fn variance(&self) -> Array {
        self.moments.variance()
    }

    /// The number of rows, plus 0.0001 for the initial mean and variance.
    pub fn count(&self) -> f64 {
        self.count
    }

    /// The number of numbers in a row.
    pub fn len(&self) -> usize {
        self.moments.len()
    }

    /// Whether a row has 0 numbers.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Updates the estimate with one row.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a row of another length.
    pub fn update(&mut self, row: &Array) -> Result<()> {
        self.expect_len(row.len())?;
        self.update_row(row.dtype(), row.iter_f64());
        Ok(())
    }

    /// Returns an error unless a row has `len` numbers.
    pub(crate) fn expect_len(&self, len: usize) -> Result<()> {
        if self.len() == len {
            return Ok(());
        }
        let reason = format!(
            "the statistics are of {} numbers, and a row has {len}",
            self.len()
        );
        Err(Error::argument("RunningMeanStd", reason))
    }

    /// Returns the variance of the first number, for statistics of a single number.
    pub(crate) fn scalar_variance(&self) -> f64 {
        match &self.moments {
            Moments::F32(of) => of.var.first().map_or(1.0, |var| f64::from(*var)),
            Moments::F64(of) => of.var.first().copied().unwrap_or(1.0),
        }
    }

    /// Updates the estimate with one observation of type `dtype`.
    pub(crate) fn update_row(&mut self, dtype: DType, values: impl Iterator<Item = f64>) {
        match dtype {
            DType::F32 => self.update_f32(values.map(|x| Batch::of_one(x as f32)), 1),
            _ => self.update_f64(values.map(Batch::of_one), 1),
        }
    }

    /// Updates the estimate with several observations of type `dtype`, one per row.
    pub(crate) fn update_rows(&mut self, dtype: DType, rows: &mut Rows) {
        match dtype {
            DType::F32 => {
                let n = rows.f32s.moments();
                self.update_f32(rows.f32s.batches(), n);
            }
            _ => {
                let n = rows.f64s.moments();
                self.update_f64(rows.f64s.batches(), n);
            }
        }
    }

    /// Merges the moments of `n` rows of `float32`.
    fn update_f32(&mut self, batches: impl Iterator<Item = Batch<f32>>, n: usize) {
        match &mut self.moments {
            Moments::F32(of) => of.update(self.count, batches, n),
            Moments::F64(of) => of.update(self.count, batches.map(Batch::widen), n),
        }
        self.count += n as f64;
    }

    /// Merges the moments of `n` rows of another type; the statistics become `float64`.
    pub(crate) fn update_f64(&mut self, batches: impl Iterator<Item = Batch<f64>>, n: usize) {
        if n == 0 {
            return;
        }
        match &mut self.moments {
            Moments::F64(of) => of.update(self.count, batches, n),
            Moments::F32(of) => {
                // in this update, numpy still multiplies variance and count in float32
                let scaled: Vec<_> = of
                    .var
                    .iter()
                    .map(|var| f64::from(var * self.count as f32))
                    .collect();
                let [mean, var] =
                    [&of.mean, &of.var].map(|numbers| numbers.iter().map(|x| f64::from(*x)));
                let mut of = MeanAndVariance {
                    mean: mean.collect(),
                    var: var.collect(),
                };
                of.update_scaled(self.count, scaled.into_iter(), batches);
                self.moments = Moments::F64(of);
            }
        }
        self.count += n as f64;
    }

    /// Writes `(x - mean) / sqrt(var + epsilon)` of each number `x` to `out`.
    pub(crate) fn normalize(
        &self,
        dtype: DType,
        values: impl Iterator<Item = f64>,
        epsilon: f64,
        out: &mut [f32],
    ) {
        match &self.moments {
            Moments::F32(MeanAndVariance { mean, var }) => {
                for (((mean, var), x), out) in mean.iter().zip(var).zip(values).zip(out) {
                    let std = (var + epsilon as f32).sqrt();
                    *out = match dtype {
                        DType::F32 => (x as f32 - mean) / std,
                        _ => ((x - f64::from(*mean)) / f64::from(std)) as f32,
                    };
                }
            }
            Moments::F64(MeanAndVariance { mean, var }) => {
                for (((mean, var), x), out) in mean.iter().zip(var).zip(values).zip(out) {
                    *out = ((x - mean) / (var + epsilon).sqrt()) as f32;
                }
            }
        }
    }
}

impl<T: Real> MeanAndVariance<T> {
    /// Merges the moments of a batch of `n` rows with those of `count` rows, for each number.
    fn update(&mut self, count: f64, batches: impl Iterator<Item = Batch<T>>, n: usize) {
        if n == 0 {
            return;
        }
        for ((mean, var), batch) in self.mean.iter_mut().zip(&mut self.var).zip(batches) {
            let scaled = *var * T::from_f64(count);
            update(mean, var, scaled, count, batch);
        }
    }

    /// [`update`](Self::update) with given products of variance and count.
    fn update_scaled(
        &mut self,
        count: f64,
        scaled: impl Iterator<Item = T>,
        batches: impl Iterator<Item = Batch<T>>,
    ) {
        for (((mean, var), scaled), batch) in self
            .mean
            .iter_mut()
            .zip(&mut self.var)
            .zip(scaled)
            .zip(batches)
        {
            update(mean, var, scaled, count, batch);
        }
    }
}

/// Merges the moments of a batch with those of `count` rows, for one number; `scaled` is `var`
/// times `count`.
fn update<T: Real>(mean: &mut T, var: &mut T, scaled: T, count: f64, batch: Batch<T>) {
    let (total, n) = (
        T::from_f64(count + batch.n as f64),
        T::from_f64(batch.n as f64),
    );
    let delta = batch.mean - *mean;
    let m2 = scaled + batch.m2 + delta * delta * T::from_f64(count) * n / total;
    *mean = *mean + delta * n / total;
    *var = m2 / total;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_statistics_is_refused() {
        let parse = |json: &str| {
            serde_json::from_str::<RunningMeanStd>(json).map_err(|error| error.to_string())
        };
        parse(r#"{"moments": {"F64": {"mean": [0.5], "var": [2.0]}}, "count": 3.0}"#).unwrap();
        for (json, reason) in [
            (
                r#"{"moments": {"F64": {"mean": [0.5], "var": [-2.0]}}, "count": 3.0}"#,
                "a variance is negative",
            ),
            (
                r#"{"moments": {"F32": {"mean": [0.5], "var": []}}, "count": 3.0}"#,
                "the mean has 1 numbers",
            ),
            (
                r#"{"moments": {"F32": {"mean": [0.5], "var": [1.0]}}, "count": 0.0}"#,
                "count is 0",
            ),
            (
                r#"{"moments": {"F32": {"mean": [0.5], "var": [1.0]}}, "count": 1.0, "cout": 1}"#,
                "unknown field",
            ),
        ] {
            assert!(parse(json).unwrap_err().contains(reason), "{json}");
        }
        assert!(RunningMeanStd::new(2).update(&[1.0_f32].into()).is_err());
        assert!(RunningMeanStd::from_moments(&[1.0_f32].into(), &[1.0_f64].into(), 1.0).is_err());
    }

    #[test]
    fn statistics_are_rebuilt_from_their_moments() {
        for dtype in [DType::F32, DType::F64] {
            let mut running = RunningMeanStd::new(2);
            running.update_row(dtype, [0.1, 3.0].into_iter());
            let again =
                RunningMeanStd::from_moments(&running.mean(), &running.variance(), running.count());
            assert_eq!(again.unwrap(), running);
        }
    }

    #[test]
    fn moments_approach_those_of_the_samples() {
        let samples: Vec<f64> = (0..1000).map(|i| f64::from(i % 10)).collect();
        for dtype in [DType::F32, DType::F64] {
            let mut running = RunningMeanStd::new(1);
            samples
                .iter()
                .for_each(|x| running.update_row(dtype, std::iter::once(*x)));
            let mut out = [0.0; 2];
            running.normalize(dtype, std::iter::once(4.5), 1e-8, &mut out[..1]);
            running.normalize(
                dtype,
                std::iter::once(4.5 + 8.25f64.sqrt()),
                1e-8,
                &mut out[1..],
            );
            assert!(
                out[0].abs() < 1e-4 && (out[1] - 1.0).abs() < 1e-3,
                "{out:?}"
            );
        }
    }

    #[test]
    fn numbers_of_each_type_are_normalized_by_moments_of_each_type() {
        let moments: [[Array; 2]; 2] = [
            [[2.0_f32].into(), [4.0_f32].into()],
            [[2.0_f64].into(), [4.0_f64].into()],
        ];
        for (moments, dtype) in moments
            .iter()
            .flat_map(|moments| [DType::U8, DType::F32, DType::F64].map(|dtype| (moments, dtype)))
        {
            let running = RunningMeanStd::from_moments(&moments[0], &moments[1], 1.0).unwrap();
            assert!(!running.is_empty());
            let mut out = [0.0];
            running.normalize(dtype, std::iter::once(8.0), 5.0, &mut out);
            assert_eq!(out, [2.0], "{dtype:?} by {moments:?}");
        }
        assert!(RunningMeanStd::new(0).is_empty());
    }

    /// numpy keeps the product of variance and count in `float32` in the update in which a row of
    /// `float64` makes the statistics `float64`.
    #[test]
    fn the_first_row_of_float64_meets_a_product_of_float32() {
        let mut running = RunningMeanStd::new(1);
        for x in [0.1, 0.7, -0.3] {
            running.update_row(DType::F32, std::iter::once(x));
        }
        let number = |array: Array| array.iter_f64().next().unwrap();
        let (mean, count) = (number(running.mean()), running.count());
        let var = number(running.variance()) as f32;
        let product = f64::from(var * count as f32);
        assert_ne!(product, f64::from(var) * count);
        running.update(&[0.2_f64].into()).unwrap();
        let (delta, total) = (0.2 - mean, count + 1.0);
        assert_eq!(number(running.mean()), mean + delta / total);
        let m2 = product + delta * delta * count / total;
        assert_eq!(number(running.variance()), m2 / total);
        assert_eq!(running.count(), total);
    }
}
