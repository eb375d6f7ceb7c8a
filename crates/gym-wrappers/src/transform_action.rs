use std::fmt;
use std::marker::PhantomData;

use gym_core::vector::Columns;
use gym_core::{
    Element, Env, Outcome, Reset, Result, Space, Value, VectorEnv, VectorWrapper, Wrapper,
};

/// Applies a function to each action for an environment, which may change its type, or to the
/// actions for all sub-environments of a vector together.
///
/// A function has no stored form: the `spec` is `None`, and the stack cannot be rebuilt from JSON.
pub struct TransformAction<T, F, A> {
    inner: T,
    func: F,
    space: Option<Space>,
    action: PhantomData<fn(A)>,
}

gym_core::inner!(impl TransformAction<T, F, A>);

impl<T, F, A> TransformAction<T, F, A> {
    /// Transforms the actions for `inner`. Around a vector, `func` maps a batch. `space` is the new
    /// space of a single action; `None` for that of `inner`.
    pub fn new<B>(inner: T, func: F, space: impl Into<Option<Space>>) -> Self
    where
        F: Fn(&A) -> B,
    {
        Self {
            inner,
            func,
            space: space.into(),
            action: PhantomData,
        }
    }
}

impl<E, F, A> Wrapper for TransformAction<E, F, A>
where
    E: Env,
    F: Fn(&A) -> E::Action + Clone + Send + 'static,
    A: Element,
{
    type Observation = E::Observation;
    type Action = A;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)
    }

    fn on_action_space(&self) -> Space {
        self.space
            .clone()
            .unwrap_or_else(|| self.inner.action_space())
    }

    fn on_step(&mut self, action: &A, observation: &mut E::Observation) -> Result<Outcome> {
        self.inner.step_into(&(self.func)(action), observation)
    }
}

impl<V: VectorEnv, F: Fn(&Value) -> Value + Send + 'static> VectorWrapper
    for TransformAction<V, F, Value>
{
    gym_core::inner!(dyn);

    fn on_single_action_space(&self) -> Space {
        self.space
            .clone()
            .unwrap_or_else(|| self.inner.single_action_space())
    }

    fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.single_action_space()
            .check_batch(actions, self.inner.num_envs())?;
        self.inner.step_into(&(self.func)(actions), columns)
    }
}

impl<T: Clone, F: Clone, A> Clone for TransformAction<T, F, A> {
    fn clone(&self) -> Self {
        let Self {
            inner,
            func,
            space,
            action,
        } = self;
        Self {
            inner: inner.clone(),
            func: func.clone(),
            space: space.clone(),
            action: *action,
        }
    }
}

impl<T: fmt::Debug, F, A> fmt::Debug for TransformAction<T, F, A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("TransformAction");
        debug
            .field("inner", &self.inner)
            .field("space", &self.space)
            .finish_non_exhaustive()
    }
}
