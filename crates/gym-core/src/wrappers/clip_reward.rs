use crate::transform::clip::RewardBounds;
use crate::transform::number_to_json;
use crate::{Env, EnvSpec, Outcome, Result, WrapperSpec};

/// Clips rewards between bounds, either of which may be left out.
#[derive(Clone, Debug)]
pub struct ClipReward<E> {
    env: E,
    bounds: RewardBounds,
}

impl<E: Env> ClipReward<E> {
    /// Clips the rewards of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) if neither bound is given, the lower one is above the upper one, or
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
            .arg("min_reward", number_to_json(self.bounds.min))
            .arg("max_reward", number_to_json(self.bounds.max));
        self.env.spec().map(|spec| spec.wrapped(wrapper))
    }

    crate::forward!(
        env: reset_into, observation_space, action_space, snapshot, restore, info, metadata, draw, ansi, render, base,
        generator, close, describe
    );
}
