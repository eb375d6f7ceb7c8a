use super::reach;
use crate::vector::stored::Kept;
use crate::vector::{Autoreset, Columns, Progress, VectorEnv, VectorReset, VectorWrapper};
use crate::wrappers::moments::{Batch, Samples};
use crate::wrappers::running::{INITIAL_COUNT, check_epsilon, update_f64};
use crate::{BoxEnv, Error, Result, Snapshot, Value, WrapperSpec, wrappers};

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
    mean: f64,
    var: f64,
    count: f64,
    samples: Samples<f32>,
}

reach!(NormalizeReward);

impl<V: VectorEnv> NormalizeReward<V> {
    /// Normalizes the rewards of `envs` by returns discounted with `gamma` per step.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) for a `gamma` outside `[0, 1]`.
    pub fn new(envs: V, gamma: f64) -> Result<Self> {
        wrappers::normalize_reward::check_gamma(gamma)?;
        let n = envs.num_envs();
        Ok(Self {
            envs,
            gamma,
            epsilon: wrappers::NormalizeReward::<BoxEnv>::EPSILON,
            update_running_mean: true,
            discounted_rewards: vec![0.0; n],
            mean: 0.0,
            var: 1.0,
            count: INITIAL_COUNT,
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

    /// The estimated variance of the discounted return.
    pub fn variance(&self) -> f64 {
        self.var
    }

    fn estimate(&mut self) {
        let n = self.samples.moments();
        for Batch { mean, m2, .. } in self.samples.batches() {
            let batch = Batch { mean: mean.into(), m2: m2.into(), n };
            let scaled = self.var * self.count;
            update_f64(&mut self.mean, &mut self.var, scaled, self.count, batch);
            self.count += n as f64;
        }
    }
}

impl<V: VectorEnv> VectorWrapper for NormalizeReward<V> {
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
        Snapshot::of(&(envs.snapshot()?, statistics, update_running_mean, Kept::numbers(discounted_rewards)))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (envs, statistics, update, discounted): (_, RunningMeanStd, bool, Kept) = snapshot.get()?;
        let discounted = discounted.into_numbers(self.discounted_rewards.len())?;
        check_statistics(&statistics).map_err(|error| Error::Snapshot(error.to_string()))?;
        self.envs.restore(&envs)?;
        (self.statistics, self.update_running_mean, self.discounted_rewards) = (statistics, update, discounted);
        Ok(())
    }
}
