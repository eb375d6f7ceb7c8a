use std::fmt;

use gym_core::vector::Columns;
use gym_core::{Element, Env, Error, Outcome, Reset, Result, Space, Value, VectorEnv};

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

reach!(TransformObservation<T, F, S>);

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

impl<E, F, O> gym_core::Wrapper for TransformObservation<E, F, E::Observation>
where
    E: Env,
    F: Fn(&E::Observation) -> O + Clone + Send + 'static,
    O: Element,
{
    type Observation = O;
    type Action = E::Action;

    env_within!(E);

    fn observation_space(&self) -> Space {
        self.space
            .clone()
            .unwrap_or_else(|| self.inner.observation_space())
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut O) -> Result<()> {
        self.inner.reset_into(reset, &mut self.seen)?;
        *observation = (self.func)(&self.seen);
        Ok(())
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut O) -> Result<Outcome> {
        let outcome = self.inner.step_into(action, &mut self.seen)?;
        *observation = (self.func)(&self.seen);
        Ok(outcome)
    }
}

impl<V: VectorEnv, F: Fn(&Value) -> Value + Send + 'static> TransformObservation<V, F, Seen> {
    fn observe_columns(&mut self, n: usize, columns: &mut Columns) -> Result<()> {
        let space = gym_core::VectorWrapper::single_observation_space(self);
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

impl<V, F> gym_core::VectorWrapper for TransformObservation<V, F, Seen>
where
    V: VectorEnv,
    F: Fn(&Value) -> Value + Send + 'static,
{
    observes_columns!();

    fn single_observation_space(&self) -> Space {
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
