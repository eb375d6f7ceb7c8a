use crate::transform::clip::RewardBounds;
use crate::transform::number_to_json;
use crate::{BoxEnv, Env, Outcome, Reset, Result, WrapperSpec};

/// Clips rewards between bounds, either of which may be left out.
#[derive(Clone, Debug)]
pub struct ClipReward<E = BoxEnv> {
    env: E,
    bounds: RewardBounds,
}

super::reach!(ClipReward<E>);

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
}

impl<E: Env> crate::Wrapper for ClipReward<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.env.step_into(action, observation)?;
        Ok(Outcome { reward: self.bounds.clip(outcome.reward), ..outcome })
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(
            WrapperSpec::new("ClipReward")
                .arg("min_reward", number_to_json(self.bounds.min))
                .arg("max_reward", number_to_json(self.bounds.max)),
        )
    }
}
