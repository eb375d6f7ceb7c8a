use crate::{Env, EnvSpec, Error, Outcome, Reset, Result, WrapperSpec};

/// Clips rewards between bounds, either of which may be left out.
#[derive(Clone, Debug)]
pub struct ClipReward<E> {
    env: E,
    min_reward: Option<f64>,
    max_reward: Option<f64>,
}

impl<E: Env> ClipReward<E> {
    /// Clips the rewards of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if neither bound is given, the lower one is above the upper one, or
    /// one is NaN.
    pub fn new(
        env: E,
        min_reward: impl Into<Option<f64>>,
        max_reward: impl Into<Option<f64>>,
    ) -> Result<Self> {
        let (min_reward, max_reward) = (min_reward.into(), max_reward.into());
        let refuse = |reason: String| Err(Error::argument("ClipReward", reason));
        match (min_reward, max_reward) {
            (None, None) => refuse("neither min_reward nor max_reward is given: give at least one".into()),
            (Some(bound), None) | (None, Some(bound)) if bound.is_nan() => refuse("a bound is NaN".into()),
            (Some(min), Some(max)) if min > max || min.is_nan() || max.is_nan() => {
                refuse(format!("min_reward {min} must not be above max_reward {max}"))
            }
            _ => Ok(Self { env, min_reward, max_reward }),
        }
    }

    /// The lower bound.
    pub fn min_reward(&self) -> Option<f64> {
        self.min_reward
    }

    /// The upper bound.
    pub fn max_reward(&self) -> Option<f64> {
        self.max_reward
    }

    /// The environment within.
    pub fn into_inner(self) -> E {
        self.env
    }
}

impl<E: Env> Env for ClipReward<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let mut outcome = self.env.step_into(action, observation)?;
        // comparisons that NaN fails, so that it stays as numpy's `clip` leaves it
        if let Some(min) = self.min_reward.filter(|min| outcome.reward < *min) {
            outcome.reward = min;
        }
        if let Some(max) = self.max_reward.filter(|max| outcome.reward > *max) {
            outcome.reward = max;
        }
        Ok(outcome)
    }

    fn spec(&self) -> Option<EnvSpec> {
        let wrapper = WrapperSpec::new("ClipReward")
            .arg("min_reward", super::number_to_json(self.min_reward))
            .arg("max_reward", super::number_to_json(self.max_reward));
        self.env.spec().map(|spec| spec.wrapped(wrapper))
    }

    crate::forward!(
        env: observation_space, action_space, snapshot, restore, info, metadata, draw, ansi, render, base,
        generator, close, describe
    );
}
