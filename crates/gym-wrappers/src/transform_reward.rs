use std::fmt;

use gym_core::vector::Columns;
use gym_core::{Env, Outcome, Reset, Result, Value, VectorEnv, VectorWrapper, Wrapper};

use crate::map::step_rewards;

/// Applies a function to each reward, of an environment or of each sub-environment of a vector.
///
/// A function has no stored form: the `spec` is `None`, and the stack cannot be rebuilt from JSON.
#[derive(Clone)]
pub struct TransformReward<T, F> {
    inner: T,
    func: F,
}

gym_core::inner!(impl TransformReward<T, F>);

impl<T, F: Fn(f64) -> f64 + Send + 'static> TransformReward<T, F> {
    /// Transforms the rewards of `inner`, as in `TransformReward::new(env, |reward| 0.01 *
    /// reward)`.
    pub fn new(inner: T, func: F) -> Self {
        Self { inner, func }
    }
}

impl<E: Env, F: Fn(f64) -> f64 + Clone + Send + 'static> Wrapper for TransformReward<E, F> {
    type Observation = E::Observation;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.inner.step_into(action, observation)?;
        Ok(Outcome {
            reward: (self.func)(outcome.reward),
            ..outcome
        })
    }
}

impl<V: VectorEnv, F: Fn(f64) -> f64 + Send + 'static> VectorWrapper for TransformReward<V, F> {
    gym_core::inner!(dyn);

    fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        step_rewards(&mut self.inner, actions, columns, &self.func)
    }
}

impl<T: fmt::Debug, F> fmt::Debug for TransformReward<T, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TransformReward")
            .field("inner", &self.inner)
            .finish_non_exhaustive()
    }
}
