use crate::statistics::{RunningMeanStd, check_epsilon, check_gamma};
use crate::{BoxEnv, DType, Env, Error, Outcome, Reset, Result, Snapshot, WrapperSpec};

/// Divides rewards by the standard deviation of the discounted return, estimated as it goes.
///
/// As in Gymnasium, the discounted sum starts anew after a step that terminates, not after one that
/// truncates; the mean is not subtracted.
#[derive(Clone, Debug)]
pub struct NormalizeReward<E = BoxEnv> {
    env: E,
    gamma: f64,
    epsilon: f64,
    update_running_mean: bool,
    discounted_reward: f64,
    statistics: RunningMeanStd,
}

super::reach!(NormalizeReward<E>);

impl<E: Env> NormalizeReward<E> {
    /// The discount factor that [`Wrap::normalize_reward`](super::Wrap::normalize_reward) and specs
    /// without one use: Gymnasium's.
    pub const GAMMA: f64 = 0.99;
    /// Gymnasium's default for what is added to the variance.
    pub const EPSILON: f64 = 1e-8;

    /// Normalizes the rewards of `env` by returns discounted with `gamma` per step.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a `gamma` outside `[0, 1]`.
    pub fn new(env: E, gamma: f64) -> Result<Self> {
        check_gamma(gamma)?;
        Ok(Self {
            env,
            gamma,
            epsilon: Self::EPSILON,
            update_running_mean: true,
            discounted_reward: 0.0,
            statistics: RunningMeanStd::new_f64(1),
        })
    }

    /// Adds another number to the variance than 1e-8.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless it is above 0.
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
    /// [`Error::InvalidArgument`] if they are of more than one number.
    pub fn set_statistics(&mut self, statistics: RunningMeanStd) -> Result<()> {
        statistics.expect_len(1)?;
        self.statistics = statistics;
        Ok(())
    }
}

impl<E: Env> crate::Wrapper for NormalizeReward<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.env.step_into(action, observation)?;
        let keep = f64::from(!outcome.terminated);
        self.discounted_reward = self.discounted_reward * self.gamma * keep + outcome.reward;
        if self.update_running_mean {
            self.statistics.update_row(DType::F64, std::iter::once(self.discounted_reward));
        }
        let std = (self.statistics.scalar_variance() + self.epsilon).sqrt();
        Ok(Outcome { reward: outcome.reward / std, ..outcome })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        let Self { discounted_reward, statistics, update_running_mean, .. } = self;
        Snapshot::of(&(self.env.snapshot()?, discounted_reward, statistics, update_running_mean))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, discounted_reward, statistics, update): (_, _, RunningMeanStd, _) = snapshot.get()?;
        statistics.expect_len(1).map_err(|error| Error::Snapshot(error.to_string()))?;
        self.env.restore(&env)?;
        (self.discounted_reward, self.statistics, self.update_running_mean) =
            (discounted_reward, statistics, update);
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let wrapper =
            WrapperSpec::new("NormalizeReward").arg("gamma", self.gamma).arg("epsilon", self.epsilon);
        Some(match self.update_running_mean {
            true => wrapper,
            false => wrapper.arg("update_running_mean", false),
        })
    }
}
