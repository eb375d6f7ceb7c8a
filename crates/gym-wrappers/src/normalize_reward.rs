//! Normalized rewards.

use gym_core::registry::WrapperConfig;
use gym_core::vector::parts::numbers;
use gym_core::vector::{Autoreset, Columns, Progress, VectorReset};
use gym_core::{
    Array, BoxEnv, DType, Env, Outcome, Reset, Result, Snapshot, Value, VectorEnv, VectorWrapper,
    Wrapper, WrapperSpec,
};

use crate::map::Within;
use crate::statistics::{Normalizer, RunningMeanStd};

/// Divides rewards by the standard deviation of the discounted return. It estimates the deviation
/// from the rewards, bit for bit like Gymnasium's wrapper; around a vector, over all
/// sub-environments.
///
/// As in Gymnasium, the discounted sum restarts after a step that terminates, not after one that
/// truncates; the mean is not subtracted. A reset of a vector with a mask restarts only the sums of
/// those sub-environments. (Gymnasium's restarts all.)
#[derive(Clone, Debug)]
pub struct NormalizeReward<T = BoxEnv> {
    inner: T,
    config: Config,
    normalizer: Normalizer,
    /// The discounted return of each environment. For a vector the numbers are rounded to
    /// `float32`, as in Gymnasium.
    returns: Vec<f64>,
}

gym_core::arguments! {
    /// The arguments of [`NormalizeReward`].
    #[derive(Copy)]
    pub struct Config {
        /// The discount for each step, in `[0, 1]`.
        pub gamma: f64 = 0.99,
        /// Added to the variance; above 0.
        pub epsilon: f64 = 1e-8,
        /// Whether to update the estimate.
        pub update_running_mean: bool = true,
    }
}

impl From<f64> for Config {
    fn from(gamma: f64) -> Self {
        Self {
            gamma,
            ..Self::default()
        }
    }
}

gym_core::register_wrapper!(
    "NormalizeReward", "divides rewards by the deviation of the discounted return", Config,
    env: NormalizeReward::new, vector: NormalizeReward::new
);

gym_core::inner!(impl NormalizeReward<T>);

impl<T> NormalizeReward<T> {
    /// Normalizes the rewards of `inner`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error) for a `gamma` outside `[0, 1]` or an `epsilon`
    /// that is not above 0.
    pub fn new<Kind>(inner: T, config: impl Into<Config>) -> Result<Self>
    where
        T: Within<Kind>,
    {
        let config = config.into();
        let Config {
            gamma,
            epsilon,
            update_running_mean,
        } = config;
        if !(0.0..=1.0).contains(&gamma) {
            return Err(Config::refuse(format!(
                "gamma is {gamma}: it must be in [0, 1]"
            )));
        }
        let statistics = RunningMeanStd::new_f64(1);
        let normalizer = Normalizer::new::<Config>(statistics, epsilon, update_running_mean)?;
        let returns = vec![0.0; inner.count()];
        Ok(Self {
            inner,
            config,
            normalizer,
            returns,
        })
    }

    /// Whether to update the estimate; `false` freezes it, as for evaluation.
    pub fn update_running_mean(&mut self, update: bool) {
        self.normalizer.updates = update;
    }

    /// Mean, variance and count of the discounted returns.
    pub fn statistics(&self) -> &RunningMeanStd {
        &self.normalizer.statistics
    }

    /// Replaces the statistics, for example with statistics from training.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) if their number of elements
    /// differs.
    pub fn set_statistics(&mut self, statistics: RunningMeanStd) -> Result<()> {
        self.normalizer.set_statistics(statistics)
    }

    /// The spec with the current arguments.
    fn own_spec(&self) -> WrapperSpec {
        Config {
            update_running_mean: self.normalizer.updates,
            ..self.config
        }
        .spec()
    }

    /// The wrapper's part of a snapshot.
    fn state(&self) -> (&RunningMeanStd, bool, Array) {
        (
            &self.normalizer.statistics,
            self.normalizer.updates,
            self.returns.clone().into(),
        )
    }

    /// Restores the wrapper's part of a snapshot, after the inner environment.
    fn restore_with(
        &mut self,
        snapshot: &Snapshot,
        restore: impl FnOnce(&mut T, &Snapshot) -> Result<()>,
    ) -> Result<()> {
        let (inner, (statistics, updates, returns)): (_, (RunningMeanStd, bool, Array)) =
            snapshot.get()?;
        self.normalizer.check(&statistics)?;
        let returns = numbers(&returns, self.returns.len())?;
        restore(&mut self.inner, &inner)?;
        (
            self.normalizer.statistics,
            self.normalizer.updates,
            self.returns,
        ) = (statistics, updates, returns);
        Ok(())
    }
}

impl<E: Env> Wrapper for NormalizeReward<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.inner.step_into(action, observation)?;
        let keep = f64::from(!outcome.terminated);
        for discounted in &mut self.returns {
            *discounted = *discounted * self.config.gamma * keep + outcome.reward;
            if self.normalizer.updates {
                self.normalizer
                    .statistics
                    .update_row(DType::F64, std::iter::once(*discounted));
            }
        }
        Ok(Outcome {
            reward: outcome.reward / self.normalizer.deviation(),
            ..outcome
        })
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.inner.snapshot()?, self.state()))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.restore_with(snapshot, E::restore)
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.own_spec())
    }
}

impl<V: VectorEnv> VectorWrapper for NormalizeReward<V> {
    gym_core::inner!(dyn);

    fn on_reset(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        columns.begin();
        let result = self.inner.reset_into(reset, columns);
        for (discounted, progress) in self.returns.iter_mut().zip(&columns.progress) {
            if *progress == Progress::Started {
                *discounted = 0.0;
            }
        }
        result
    }

    fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        columns.begin();
        let result = self.inner.step_into(actions, columns);
        // skip sub-environments that the step only reset
        let stepped = |index: usize| columns.progress.get(index) == Some(&Progress::Stepped);
        for (index, discounted) in self
            .returns
            .iter_mut()
            .enumerate()
            .filter(|(index, _)| stepped(*index))
        {
            // numpy multiplies with gamma in float32, and computes the rest in float64
            let kept = f64::from(*discounted as f32 * self.config.gamma as f32);
            let kept = kept * f64::from(!columns.terminated[index]);
            *discounted = f64::from((kept + columns.rewards[index]) as f32);
        }
        if self.normalizer.updates {
            let returns = self
                .returns
                .iter()
                .enumerate()
                .filter(|(index, _)| stepped(*index));
            self.normalizer
                .take_in_numbers(returns.map(|(_, discounted)| *discounted as f32));
        }
        let deviation = self.normalizer.deviation();
        let same_step = self.inner.autoreset() == Autoreset::SameStep;
        for (index, discounted) in self.returns.iter_mut().enumerate() {
            if columns
                .progress
                .get(index)
                .is_some_and(|progress| *progress != Progress::Unchanged)
            {
                columns.rewards[index] /= deviation;
                if same_step && columns.done(index) {
                    *discounted = 0.0;
                }
            }
        }
        result
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.inner.snapshot()?, self.state()))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.restore_with(snapshot, V::restore)
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.own_spec())
    }
}
