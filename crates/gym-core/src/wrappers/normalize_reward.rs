use serde::{Deserialize, Serialize};

use super::moments::Batch;
use crate::{Env, EnvSpec, Error, Outcome, Result, Snapshot, WrapperSpec};

/// Divides rewards by the standard deviation of the discounted return, estimated as it goes.
///
/// As in Gymnasium, the discounted sum starts anew after a step that terminates, not after one that
/// truncates; the mean is not subtracted.
#[derive(Clone, Debug)]
pub struct NormalizeReward<E> {
    env: E,
    gamma: f64,
    epsilon: f64,
    update_running_mean: bool,
    estimate: Estimate,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Estimate {
    discounted_reward: f64,
    mean: f64,
    var: f64,
    count: f64,
}

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
        let estimate =
            Estimate { discounted_reward: 0.0, mean: 0.0, var: 1.0, count: super::running::INITIAL_COUNT };
        Ok(Self { env, gamma, epsilon: Self::EPSILON, update_running_mean: true, estimate })
    }

    /// Adds another number to the variance than 1e-8.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless it is above 0.
    pub fn with_epsilon(self, epsilon: f64) -> Result<Self> {
        super::running::check_epsilon("NormalizeReward", epsilon)?;
        Ok(Self { epsilon, ..self })
    }

    /// Goes on estimating (as it does from the start), or keeps the estimate as it is, as for
    /// evaluation.
    pub fn update_running_mean(&mut self, update: bool) {
        self.update_running_mean = update;
    }

    /// The estimated variance of the discounted return.
    pub fn variance(&self) -> f64 {
        self.estimate.var
    }

    /// The environment within.
    pub fn into_inner(self) -> E {
        self.env
    }
}

impl<E: Env> Env for NormalizeReward<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.env.step_into(action, observation)?;
        let Estimate { discounted_reward, mean, var, count } = &mut self.estimate;
        let keep = f64::from(!outcome.terminated);
        *discounted_reward = *discounted_reward * self.gamma * keep + outcome.reward;
        if self.update_running_mean {
            let batch = Batch::of_one(*discounted_reward);
            super::running::update_f64(mean, var, *var * *count, *count, batch);
            *count += 1.0;
        }
        Ok(Outcome { reward: outcome.reward / (*var + self.epsilon).sqrt(), ..outcome })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.env.snapshot()?, self.estimate, self.update_running_mean))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, estimate, update) = snapshot.get()?;
        self.env.restore(&env)?;
        (self.estimate, self.update_running_mean) = (estimate, update);
        Ok(())
    }

    fn spec(&self) -> Option<EnvSpec> {
        let wrapper =
            WrapperSpec::new("NormalizeReward").arg("gamma", self.gamma).arg("epsilon", self.epsilon);
        self.env.spec().map(|spec| spec.wrapped(wrapper))
    }

    crate::forward!(
        env: reset_into, observation_space, action_space, info, metadata, draw, ansi, render, base, generator, close, describe
    );
}

pub(crate) fn check_gamma(gamma: f64) -> Result<()> {
    match (0.0..=1.0).contains(&gamma) {
        true => Ok(()),
        false => Err(Error::argument("NormalizeReward", format!("gamma is {gamma}: it must be in [0, 1]"))),
    }
}
