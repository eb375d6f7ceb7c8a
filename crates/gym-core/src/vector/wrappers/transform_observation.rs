use std::fmt;

use super::{Inner, observation_methods, reach};
use crate::vector::{Columns, VectorEnv};
use crate::{Error, Result, Space, Value};

/// Applies a function to the observations of all sub-environments together, also to the final ones.
#[derive(Clone)]
pub struct TransformObservation<V, F> {
    envs: V,
    func: F,
    space: Space,
    inner: Inner,
}

reach!(TransformObservation, F);

impl<V: VectorEnv, F: Fn(&Value) -> Value + Send + 'static> TransformObservation<V, F> {
    /// Transforms the observations of `envs`: `func` takes and gives a batch. Without a space, which is
    /// that of a single observation, the transformed ones lie in the space of `envs`.
    pub fn new(envs: V, func: F, single_observation_space: impl Into<Option<Space>>) -> Self {
        let space = single_observation_space.into().unwrap_or_else(|| envs.single_observation_space());
        Self { envs, func, space, inner: Inner::default() }
    }

    fn observe(&self, columns: &mut Columns) -> Result<()> {
        let n = self.envs.num_envs();
        self.inner.map(columns, |inner, out| {
            *out = (self.func)(inner);
            if self.space.is_batch(out, n) {
                return Ok(());
            }
            Err(Error::Contract(format!(
                "the function of TransformObservation gave {out}, which is no batch of {n} elements of {}",
                self.space
            )))
        })?;
        columns.prepare(&self.space, n)
    }
}

impl<V: VectorEnv, F: Fn(&Value) -> Value + Send + 'static> crate::VectorWrapper
    for TransformObservation<V, F>
{
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn single_observation_space(&self) -> Space {
        self.space.clone()
    }

    observation_methods!();
}

impl<V: fmt::Debug, F> fmt::Debug for TransformObservation<V, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("TransformObservation");
        debug.field("envs", &self.envs).field("space", &self.space).finish_non_exhaustive()
    }
}
