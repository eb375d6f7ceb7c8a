use std::fmt;
use std::marker::PhantomData;

use crate::{Element, Env, Outcome, Reset, Result, Space};

/// Applies a function to each action, which may change its type, before the environment gets it.
///
/// A function has no stored form: the [`spec`](Env::spec) is `None`, and the stack cannot be rebuilt
/// from JSON.
pub struct TransformAction<E, F, A> {
    env: E,
    func: F,
    space: Option<Space>,
    action: PhantomData<fn(A)>,
}

super::reach!(TransformAction<E, F, A>);

impl<E, F, A> TransformAction<E, F, A>
where
    E: Env,
    F: Fn(&A) -> E::Action + Clone + Send + 'static,
    A: Element,
{
    /// Transforms the actions for `env`. Without a space the actions to transform lie in the space of
    /// `env`.
    pub fn new(env: E, func: F, action_space: impl Into<Option<Space>>) -> Self {
        Self { env, func, space: action_space.into(), action: PhantomData }
    }
}

impl<E, F, A> crate::Wrapper for TransformAction<E, F, A>
where
    E: Env,
    F: Fn(&A) -> E::Action + Clone + Send + 'static,
    A: Element,
{
    type Observation = E::Observation;
    type Action = A;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)
    }

    fn action_space(&self) -> Space {
        self.space.clone().unwrap_or_else(|| self.env.action_space())
    }

    fn step_into(&mut self, action: &A, observation: &mut E::Observation) -> Result<Outcome> {
        self.env.step_into(&(self.func)(action), observation)
    }
}

impl<E: Clone, F: Clone, A> Clone for TransformAction<E, F, A> {
    fn clone(&self) -> Self {
        Self {
            env: self.env.clone(),
            func: self.func.clone(),
            space: self.space.clone(),
            action: PhantomData,
        }
    }
}

impl<E: fmt::Debug, F, A> fmt::Debug for TransformAction<E, F, A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("TransformAction");
        debug.field("env", &self.env).field("space", &self.space).finish_non_exhaustive()
    }
}
