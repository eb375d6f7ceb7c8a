use std::fmt;

use super::{each_reward, reach};
use crate::vector::{Columns, VectorEnv};
use crate::{Result, Value};

/// Applies a function to each reward.
#[derive(Clone)]
pub struct TransformReward<V, F> {
    envs: V,
    func: F,
}

reach!(TransformReward, F);

impl<V: VectorEnv, F: Fn(f64) -> f64 + Send + 'static> TransformReward<V, F> {
    /// Transforms the rewards of `envs`.
    pub fn new(envs: V, func: F) -> Self {
        Self { envs, func }
    }
}

impl<V: VectorEnv, F: Fn(f64) -> f64 + Send + 'static> crate::VectorWrapper for TransformReward<V, F> {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        each_reward(&mut self.envs, actions, columns, &self.func)
    }
}

impl<V: fmt::Debug, F> fmt::Debug for TransformReward<V, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TransformReward").field("envs", &self.envs).finish_non_exhaustive()
    }
}
