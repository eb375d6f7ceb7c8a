use crate::statistics::moments::{Batch, Samples};
use crate::statistics::{RunningMeanStd, check_epsilon, check_gamma};
use crate::vector::{Autoreset, Columns, VectorEnv, VectorReset};
use crate::{BoxEnv, Result, Value, wrappers};

/// Divides rewards by the standard deviation of the discounted return, estimated over all
/// sub-environments as it goes, to the bit as Gymnasium's does.
///
/// A reset with a mask starts the returns of those sub-environments anew, and of no others. (Gymnasium's
/// forgets them all.)
#[derive(Clone, Debug)]
pub struct NormalizeReward<V> {
    envs: V,
    gamma: f64,
    epsilon: f64,
    update_running_mean: bool,
    /// Kept as `float32`, as by Gymnasium.
    discounted_rewards: Vec<f32>,
    /// Where the next step is a reset: its reward counts for nothing.
    is_done: Vec<bool>,
    statistics: RunningMeanStd,
    samples: Samples<f32>,
}

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
            is_done: vec![false; n],
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

    /// The estimated variance of the discounted return.
    pub fn variance(&self) -> f64 {
        self.statistics.scalar_variance()
    }

    /// The vector within.
    pub fn into_inner(self) -> V {
        self.envs
    }

    fn estimate(&mut self) {
        let n = self.samples.moments();
        for Batch { mean, m2, .. } in self.samples.batches() {
            self.statistics.update_batch(Batch { mean: mean.into(), m2: m2.into(), n });
        }
    }
}

impl<V: VectorEnv> VectorEnv for NormalizeReward<V> {
    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        self.envs.reset_into(reset, columns)?;
        for index in (0..self.is_done.len()).filter(|index| reset.selects(*index)) {
            (self.discounted_rewards[index], self.is_done[index]) = (0.0, false);
        }
        Ok(())
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.envs.step_into(actions, columns)?;
        let same_step = self.autoreset() == Autoreset::SameStep;
        self.samples.begin(1);
        for (index, reward) in columns.rewards.iter().enumerate() {
            if same_step || !self.is_done[index] {
                // the product with gamma is float32, and the rest float64
                let kept = f64::from(self.discounted_rewards[index] * self.gamma as f32);
                let kept = kept * f64::from(!columns.terminated[index]);
                self.discounted_rewards[index] = (kept + reward) as f32;
                self.samples.extend([self.discounted_rewards[index]]);
            }
            self.is_done[index] = columns.done(index);
        }
        if self.update_running_mean && !self.samples.is_empty() {
            self.estimate();
        }
        if same_step {
            let done = self.is_done.iter().zip(&mut self.discounted_rewards).filter(|(done, _)| **done);
            done.for_each(|(_, discounted_reward)| *discounted_reward = 0.0);
        }
        let std = (self.statistics.scalar_variance() + self.epsilon).sqrt();
        columns.rewards.iter_mut().for_each(|reward| *reward /= std);
        Ok(())
    }

    crate::forward_vector!(
        envs: num_envs, single_observation_space, observation_space, single_action_space, autoreset, info, final_info, infos,
        visit_envs, render, metadata, spec, describe, close
    );
}
