use std::fmt;

use super::reach;
use crate::vector::{Columns, VectorEnv};
use crate::{Result, Space, Value};

/// Applies a function to the actions of all sub-environments together, before they get them.
#[derive(Clone)]
pub struct TransformAction<V, F> {
    envs: V,
    func: F,
    space: Option<Space>,
}

reach!(TransformAction, F);

impl<V: VectorEnv, F: Fn(&Value) -> Value + Send + 'static> TransformAction<V, F> {
    /// Transforms the actions for `envs`: `func` takes and gives a batch. Without a space, which is that
    /// of a single action, the actions to transform lie in the space of `envs`.
    pub fn new(envs: V, func: F, single_action_space: impl Into<Option<Space>>) -> Self {
        Self { envs, func, space: single_action_space.into() }
    }
}

impl<V: VectorEnv, F: Fn(&Value) -> Value + Send + 'static> crate::VectorWrapper for TransformAction<V, F> {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn single_action_space(&self) -> Space {
        self.space.clone().unwrap_or_else(|| self.envs.single_action_space())
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        VectorEnv::single_action_space(self).check_batch(actions, self.envs.num_envs())?;
        self.envs.step_into(&(self.func)(actions), columns)
    }
}

impl<V: fmt::Debug, F> fmt::Debug for TransformAction<V, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("TransformAction");
        debug.field("envs", &self.envs).field("space", &self.space).finish_non_exhaustive()
    }
}
