//! Normalized observations.

use gym_core::registry::WrapperConfig;
use gym_core::spaces::{BoxSpace, array_of};
use gym_core::vector::parts::numbers;
use gym_core::vector::{Columns, Progress};
use gym_core::{Array, BoxEnv, DType, Env, Result, Snapshot, Space, Value, VectorEnv};

use crate::map::Within;
use crate::observing::{Observer, Observing, Seen, VectorObserver};
use crate::statistics::{Normalizer, RunningMeanStd};
use crate::within::not_an_array;

/// Shifts and scales observations to mean 0 and variance 1. It estimates both from the
/// observations, in `float32`, bit for bit like Gymnasium's wrapper.
///
/// The estimate includes every observation since the wrapper was made; resets do not clear it.
/// Around a vector it includes all sub-environments: each reset and step adds its observations as
/// one batch, and a reset with a mask those of the sub-environments that it resets. Final
/// observations in their own column are normalized but not added. (Gymnasium's wrapper refuses
/// masks and every autoreset mode except the next step.)
pub type NormalizeObservation<T = BoxEnv> = Observing<T, ObservationNormalizer>;

/// The observer of [`NormalizeObservation`].
#[derive(Clone, Debug)]
pub struct ObservationNormalizer {
    config: Config,
    normalizer: Normalizer,
    /// The last returned observation of each sub-environment. A reset with a mask returns these
    /// observations for the excluded sub-environments.
    shown: Vec<f32>,
}

gym_core::arguments! {
    /// The arguments of [`NormalizeObservation`].
    #[derive(Copy)]
    pub struct Config {
        /// Added to the variance; above 0.
        pub epsilon: f64 = 1e-8,
        /// Whether to update the estimate.
        pub update_running_mean: bool = true,
    }
}

gym_core::register_wrapper!(
    "NormalizeObservation", "shifts and scales observations to mean 0 and variance 1, as `float32`", Config,
    env: NormalizeObservation::new, vector: NormalizeObservation::new
);

impl<T> NormalizeObservation<T> {
    /// Normalizes the observations of `inner`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error) unless they are arrays or integers.
    pub fn new<Kind>(inner: T, config: impl Into<Config>) -> Result<Self>
    where
        T: Within<Kind>,
    {
        let (config, space) = (config.into(), inner.observations());
        let Some(shape) = space.shape() else {
            let reason = format!("it needs observations with a shape, and the space is {space}");
            return Err(Config::refuse(reason));
        };
        let space = BoxSpace::uniform(f64::NEG_INFINITY, f64::INFINITY, shape, DType::F32)?;
        let len = space.low().len();
        let Config {
            epsilon,
            update_running_mean,
        } = config;
        let normalizer =
            Normalizer::new::<Config>(RunningMeanStd::new(len), epsilon, update_running_mean)?;
        let shown = vec![0.0; inner.count() * len];
        let observer = ObservationNormalizer {
            config,
            normalizer,
            shown,
        };
        Ok(Self::with_observer(inner, observer, space.into()))
    }

    /// Whether to update the estimate; `false` freezes it, as for evaluation.
    pub fn update_running_mean(&mut self, update: bool) {
        self.observer.normalizer.updates = update;
    }

    /// Mean, variance and count of the observations.
    pub fn statistics(&self) -> &RunningMeanStd {
        &self.observer.normalizer.statistics
    }

    /// Replaces the statistics, for example with statistics from training.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) if their number of elements
    /// differs.
    pub fn set_statistics(&mut self, statistics: RunningMeanStd) -> Result<()> {
        self.observer.normalizer.set_statistics(statistics)
    }
}

impl Observer for ObservationNormalizer {
    type Config = Config;

    fn arguments(&self) -> Config {
        Config {
            update_running_mean: self.normalizer.updates,
            ..self.config
        }
    }

    fn observe<E: Env>(
        &mut self,
        _env: &mut E,
        space: &Space,
        seen: &mut Value,
        _is_reset: bool,
        out: &mut Value,
    ) -> Result<()> {
        let shape = space.shape().unwrap_or_default();
        let out = array_of(out, DType::F32, shape)
            .as_mut_slice::<f32>()
            .unwrap_or_default();
        match seen {
            Value::Array(array) if array.len() == out.len() => {
                let numbers = (0..array.len()).map(|i| array.data().get_f64(i));
                self.normalizer.row(array.dtype(), numbers, out);
            }
            Value::Int(i) if out.len() == 1 => {
                self.normalizer
                    .row(DType::I64, std::iter::once(*i as f64), out);
            }
            other => return Err(not_an_array(other)),
        }
        Ok(())
    }

    fn snapshot<E: Env>(&self, env: &E) -> Result<Snapshot> {
        let Normalizer {
            statistics,
            updates,
            ..
        } = &self.normalizer;
        Snapshot::of(&(env.snapshot()?, statistics, updates))
    }

    fn restore<E: Env>(&mut self, env: &mut E, snapshot: &Snapshot) -> Result<()> {
        let (inner, statistics, updates): (_, RunningMeanStd, bool) = snapshot.get()?;
        self.normalizer.check(&statistics)?;
        env.restore(&inner)?;
        (self.normalizer.statistics, self.normalizer.updates) = (statistics, updates);
        Ok(())
    }
}

impl VectorObserver for ObservationNormalizer {
    /// Updates the estimate with the observations of the sub-environments that were stepped or
    /// reset, and normalizes them.
    fn observe_columns(
        &mut self,
        space: &Space,
        num_envs: usize,
        seen: &Seen,
        columns: &mut Columns,
    ) -> Result<()> {
        columns.prepare(space, num_envs)?;
        let Self {
            normalizer, shown, ..
        } = self;
        let goes_on = |index: usize| columns.progress[index] != Progress::Unchanged;
        let Value::Array(observations) = &seen.observations else {
            return Ok(());
        };
        normalizer.take_in(observations, num_envs, goes_on);
        normalizer.normalize(observations, num_envs, shown, goes_on);
        if let Value::Array(out) = &mut columns.observations {
            out.as_mut_slice()
                .unwrap_or_default()
                .copy_from_slice(shown);
        }
        if let (Value::Array(finals), Value::Array(out)) =
            (&seen.final_observations, &mut columns.final_observations)
        {
            let out = out.as_mut_slice().unwrap_or_default();
            normalizer.normalize(finals, num_envs, out, |index| columns.has_final[index]);
        }
        Ok(())
    }

    fn vector_snapshot(&self, envs: &dyn VectorEnv) -> Result<Snapshot> {
        let Normalizer {
            statistics,
            updates,
            ..
        } = &self.normalizer;
        let shown = Array::from(self.shown.clone());
        Snapshot::of(&(envs.snapshot()?, statistics, updates, shown))
    }

    fn restore_vector(&mut self, envs: &mut dyn VectorEnv, snapshot: &Snapshot) -> Result<()> {
        let (inner, statistics, updates, shown): (_, RunningMeanStd, bool, Array) =
            snapshot.get()?;
        let shown = numbers(&shown, self.shown.len())?;
        self.normalizer.check(&statistics)?;
        envs.restore(&inner)?;
        (
            self.normalizer.statistics,
            self.normalizer.updates,
            self.shown,
        ) = (statistics, updates, shown);
        Ok(())
    }
}
