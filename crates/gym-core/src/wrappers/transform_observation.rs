use std::fmt;

use crate::{Element, Env, Outcome, Reset, Result, Space};

/// Applies a function to each observation, which may change its type.
///
/// A function has no stored form: the [`spec`](Env::spec) is `None`, and the stack cannot be rebuilt
/// from JSON.
#[derive(Clone)]
pub struct TransformObservation<E: Env, F> {
    env: E,
    func: F,
    space: Option<Space>,
    inner: E::Observation,
}

super::reach!(TransformObservation<E: Env, F>);

impl<E: Env, F, O> TransformObservation<E, F>
where
    F: Fn(&E::Observation) -> O + Clone + Send + 'static,
    O: Element,
{
    /// Transforms the observations of `env`. Without a space the transformed observations lie in the
    /// space of `env`.
    pub fn new(env: E, func: F, observation_space: impl Into<Option<Space>>) -> Self {
        Self { env, func, space: observation_space.into(), inner: E::Observation::empty() }
    }
}

impl<E: Env, F, O> crate::Wrapper for TransformObservation<E, F>
where
    F: Fn(&E::Observation) -> O + Clone + Send + 'static,
    O: Element,
{
    type Observation = O;
    type Action = E::Action;

    super::within!(E);

    fn observation_space(&self) -> Space {
        self.space.clone().unwrap_or_else(|| self.env.observation_space())
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut O) -> Result<()> {
        self.env.reset_into(reset, &mut self.inner)?;
        *observation = (self.func)(&self.inner);
        Ok(())
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut O) -> Result<Outcome> {
        let outcome = self.env.step_into(action, &mut self.inner)?;
        *observation = (self.func)(&self.inner);
        Ok(outcome)
    }
}

impl<E: Env + fmt::Debug, F> fmt::Debug for TransformObservation<E, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("TransformObservation");
        debug.field("env", &self.env).field("space", &self.space).finish_non_exhaustive()
    }
}
