use std::fmt;

use gym_core::vector::{Columns, VectorReset};
use gym_core::{
    Element, Env, Error, Outcome, Reset, Result, Space, Value, VectorEnv, VectorWrapper, Wrapper,
};

use crate::map::{Seen, Within};

/// Applies a function to each observation of an environment, which may change its type, or to the
/// observations of all sub-environments of a vector together, also to the final ones.
///
/// A function has no stored form: the `spec` is `None`, and the stack cannot be rebuilt from JSON.
#[derive(Clone)]
pub struct TransformObservation<T, F, S> {
    inner: T,
    func: F,
    space: Option<Space>,
    seen: S,
}

gym_core::inner!(impl TransformObservation<T, F, S>);

impl<T, F, S> TransformObservation<T, F, S> {
    /// Transforms the observations of `inner`. Around a vector, `func` maps a batch. `space` is the
    /// new space of a single observation; `None` for that of `inner`.
    pub fn new<Kind, O>(inner: T, func: F, space: impl Into<Option<Space>>) -> Self
    where
        T: Within<Kind, Buffer = S>,
        F: Fn(&<T as Within<Kind>>::Observation) -> O,
    {
        Self {
            inner,
            func,
            space: space.into(),
            seen: T::buffer(),
        }
    }
}

impl<E, F, O> Wrapper for TransformObservation<E, F, E::Observation>
where
    E: Env,
    F: Fn(&E::Observation) -> O + Clone + Send + 'static,
    O: Element,
{
    type Observation = O;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_observation_space(&self) -> Space {
        self.space
            .clone()
            .unwrap_or_else(|| self.inner.observation_space())
    }

    fn on_reset(&mut self, reset: &Reset, observation: &mut O) -> Result<()> {
        self.inner.reset_into(reset, &mut self.seen)?;
        *observation = (self.func)(&self.seen);
        Ok(())
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut O) -> Result<Outcome> {
        let outcome = self.inner.step_into(action, &mut self.seen)?;
        *observation = (self.func)(&self.seen);
        Ok(outcome)
    }
}

impl<V: VectorEnv, F: Fn(&Value) -> Value + Send + 'static> TransformObservation<V, F, Seen> {
    /// Resets or steps the inner vector by `call`, and transforms its observations.
    fn observe(
        &mut self,
        columns: &mut Columns,
        call: impl FnOnce(&mut V, &mut Columns) -> Result<()>,
    ) -> Result<()> {
        let (result, goes_on) = self
            .seen
            .fill(columns, |columns| call(&mut self.inner, columns));
        if goes_on {
            result.and(self.transform(columns))
        } else {
            result
        }
    }

    fn transform(&self, columns: &mut Columns) -> Result<()> {
        let (n, space) = (self.num_envs(), self.single_observation_space());
        self.seen.map(columns, |inner, out| {
            *out = (self.func)(inner);
            if space.is_batch(out, n) {
                return Ok(());
            }
            Err(Error::Contract(format!(
                "the function of TransformObservation returned {out}, which is not a batch of {n} elements of {space}"
            )))
        })?;
        columns.prepare(&space, n)
    }
}

impl<V, F> VectorWrapper for TransformObservation<V, F, Seen>
where
    V: VectorEnv,
    F: Fn(&Value) -> Value + Send + 'static,
{
    gym_core::inner!(dyn);

    fn on_reset(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        self.observe(columns, |inner, columns| inner.reset_into(reset, columns))
    }

    fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.observe(columns, |inner, columns| inner.step_into(actions, columns))
    }

    fn on_single_observation_space(&self) -> Space {
        self.space
            .clone()
            .unwrap_or_else(|| self.inner.single_observation_space())
    }
}

impl<T: fmt::Debug, F, S> fmt::Debug for TransformObservation<T, F, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("TransformObservation");
        debug
            .field("inner", &self.inner)
            .field("space", &self.space)
            .finish_non_exhaustive()
    }
}
