use std::fmt;

use crate::{Env, Outcome, Reset, Result};

/// Applies a function to each reward.
///
/// A function has no stored form: the [`spec`](Env::spec) is `None`, and the stack cannot be rebuilt
/// from JSON.
#[derive(Clone)]
pub struct TransformReward<E, F> {
    env: E,
    func: F,
}

super::reach!(TransformReward<E, F>);

impl<E: Env, F: Fn(f64) -> f64 + Clone + Send + 'static> TransformReward<E, F> {
    /// Transforms the rewards of `env`, as in `TransformReward::new(env, |reward| 0.01 * reward)`.
    pub fn new(env: E, func: F) -> Self {
        Self { env, func }
    }
}

impl<E: Env, F: Fn(f64) -> f64 + Clone + Send + 'static> crate::Wrapper for TransformReward<E, F> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.env.step_into(action, observation)?;
        Ok(Outcome { reward: (self.func)(outcome.reward), ..outcome })
    }
}

impl<E: fmt::Debug, F> fmt::Debug for TransformReward<E, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TransformReward").field("env", &self.env).finish_non_exhaustive()
    }
}
