use crate::{Env, EnvSpec, Error, Outcome, Result, WrapperSpec};

/// Clips rewards between bounds, either of which may be left out.
#[derive(Clone, Debug)]
pub struct ClipReward<E> {
    env: E,
    bounds: RewardBounds,
}

/// Bounds of a reward.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RewardBounds {
    pub(crate) min: Option<f64>,
    pub(crate) max: Option<f64>,
}

impl RewardBounds {
    pub(crate) fn new(min_reward: Option<f64>, max_reward: Option<f64>) -> Result<Self> {
        let refuse = |reason: String| Err(Error::argument("ClipReward", reason));
        match (min_reward, max_reward) {
            (None, None) => refuse("neither min_reward nor max_reward is given: give at least one".into()),
            (Some(bound), None) | (None, Some(bound)) if bound.is_nan() => refuse("a bound is NaN".into()),
            (Some(min), Some(max)) if min > max || min.is_nan() || max.is_nan() => {
                refuse(format!("min_reward {min} must not be above max_reward {max}"))
            }
            (min, max) => Ok(Self { min, max }),
        }
    }

    /// The reward within the bounds. NaN stays, as numpy's `clip` leaves it.
    pub(crate) fn clip(self, reward: f64) -> f64 {
        let reward = self.min.filter(|min| reward < *min).unwrap_or(reward);
        self.max.filter(|max| reward > *max).unwrap_or(reward)
    }
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
        let bounds = RewardBounds::new(min_reward.into(), max_reward.into())?;
        Ok(Self { env, bounds })
    }

    /// The lower bound.
    pub fn min_reward(&self) -> Option<f64> {
        self.bounds.min
    }

    /// The upper bound.
    pub fn max_reward(&self) -> Option<f64> {
        self.bounds.max
    }

    /// The environment within.
    pub fn into_inner(self) -> E {
        self.env
    }
}

impl<E: Env> Env for ClipReward<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.env.step_into(action, observation)?;
        Ok(Outcome { reward: self.bounds.clip(outcome.reward), ..outcome })
    }

    fn spec(&self) -> Option<EnvSpec> {
        let wrapper = WrapperSpec::new("ClipReward")
            .arg("min_reward", super::number_to_json(self.bounds.min))
            .arg("max_reward", super::number_to_json(self.bounds.max));
        self.env.spec().map(|spec| spec.wrapped(wrapper))
    }

    crate::forward!(
        env: reset_into, observation_space, action_space, snapshot, restore, info, metadata, draw, ansi, render, base,
        generator, close, describe
    );
}
