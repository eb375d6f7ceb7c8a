use super::reach;
use crate::statistics::moments::{Batch, Samples};
use crate::statistics::{RunningMeanStd, check_epsilon, check_gamma};
use crate::vector::{Autoreset, Columns, Progress, VectorEnv, VectorReset};
use crate::{Array, BoxEnv, Error, Result, Snapshot, Value, WrapperSpec, stored, wrappers};

/// Divides rewards by the standard deviation of the discounted return, estimated over all
/// sub-environments as it goes, to the bit as Gymnasium's does.
///
/// A reset with a mask starts the returns of those sub-environments anew, and of no others. (Gymnasium's
/// forgets them all.)
#[derive(Clone, Debug)]
pub struct NormalizeReward<V = Box<dyn VectorEnv>> {
    envs: V,
    gamma: f64,
    epsilon: f64,
    update_running_mean: bool,
    /// Kept as `float32`, as by Gymnasium.
    discounted_rewards: Vec<f32>,
    statistics: RunningMeanStd,
    samples: Samples<f32>,
}

reach!(NormalizeReward);

impl<V: VectorEnv> NormalizeReward<V> {
    /// Normalizes the rewards of `envs` by returns discounted with `gamma` per step.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) for a `gamma` outside `[0, 1]`.
    pub fn new(envs: V, gamma: f64) -> Result<Self> {
        check_gamma(gamma)?;
        let n = envs.num_envs();
        Ok(Self {
            envs,
            gamma,
            epsilon: wrappers::NormalizeReward::<BoxEnv>::EPSILON,
            update_running_mean: true,
            discounted_rewards: vec![0.0; n],
            statistics: RunningMeanStd::new_f64(1),
            samples: Samples::default(),
        })
    }

    /// Adds another number to the variance than 1e-8.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) unless it is above 0.
    pub fn with_epsilon(self, epsilon: f64) -> Result<Self> {
        check_epsilon("NormalizeReward", epsilon)?;
        Ok(Self { epsilon, ..self })
    }

    /// Goes on estimating (as it does from the start), or keeps the estimate as it is, as for
    /// evaluation.
    pub fn update_running_mean(&mut self, update: bool) {
        self.update_running_mean = update;
    }

    /// Mean, variance and count of the discounted return.
    pub fn statistics(&self) -> &RunningMeanStd {
        &self.statistics
    }

    /// Goes on from other statistics, such as those of a training.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) if they are of more than one number.
    pub fn set_statistics(&mut self, statistics: RunningMeanStd) -> Result<()> {
        statistics.expect_len(1)?;
        self.statistics = statistics;
        Ok(())
    }

    fn estimate(&mut self) {
        let n = self.samples.moments();
        for Batch { mean, m2, .. } in self.samples.batches() {
            self.statistics.update_batch(Batch { mean: mean.into(), m2: m2.into(), n });
        }
    }
}

impl<V: VectorEnv> crate::VectorWrapper for NormalizeReward<V> {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let wrapper =
            WrapperSpec::new("NormalizeReward").arg("gamma", self.gamma).arg("epsilon", self.epsilon);
        Some(if self.update_running_mean { wrapper } else { wrapper.arg("update_running_mean", false) })
    }

    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        columns.begin();
        let result = self.envs.reset_into(reset, columns);
        for (discounted, progress) in self.discounted_rewards.iter_mut().zip(&columns.progress) {
            if *progress == Progress::Started {
                *discounted = 0.0;
            }
        }
        result
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        columns.begin();
        let result = self.envs.step_into(actions, columns);
        self.samples.begin(1);
        for (index, discounted) in self.discounted_rewards.iter_mut().enumerate() {
            // the reward of a step that was a reset counts for nothing
            if columns.progress.get(index) == Some(&Progress::Stepped) {
                // the product with gamma is float32, and the rest float64
                let kept = f64::from(*discounted * self.gamma as f32);
                let kept = kept * f64::from(!columns.terminated[index]);
                *discounted = (kept + columns.rewards[index]) as f32;
                self.samples.extend([*discounted]);
            }
        }
        if self.update_running_mean && !self.samples.is_empty() {
            self.estimate();
        }
        let std = (self.statistics.scalar_variance() + self.epsilon).sqrt();
        let same_step = self.envs.autoreset() == Autoreset::SameStep;
        for (index, discounted) in self.discounted_rewards.iter_mut().enumerate() {
            if columns.progress.get(index).is_some_and(|progress| *progress != Progress::Unchanged) {
                columns.rewards[index] /= std;
                if same_step && columns.done(index) {
                    *discounted = 0.0;
                }
            }
        }
        result
    }

    fn snapshot(&self) -> Result<Snapshot> {
        let Self { envs, statistics, update_running_mean, discounted_rewards, .. } = self;
        Snapshot::of(&(
            envs.snapshot()?,
            statistics,
            update_running_mean,
            Array::from(discounted_rewards.clone()),
        ))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (envs, statistics, update, discounted): (_, RunningMeanStd, bool, Array) = snapshot.get()?;
        let discounted = stored::numbers(&discounted, self.discounted_rewards.len())?;
        statistics.expect_len(1).map_err(|error| Error::Snapshot(error.to_string()))?;
        self.envs.restore(&envs)?;
        (self.statistics, self.update_running_mean, self.discounted_rewards) =
            (statistics, update, discounted);
        Ok(())
    }
}
