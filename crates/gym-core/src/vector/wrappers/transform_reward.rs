use std::fmt;

use crate::vector::{Columns, VectorEnv};
use crate::{Result, Value};

/// Applies a function to each reward.
#[derive(Clone)]
pub struct TransformReward<V, F> {
    envs: V,
    func: F,
}

impl<V: VectorEnv, F: Fn(f64) -> f64 + Send> TransformReward<V, F> {
    /// Transforms the rewards of `envs`.
    pub fn new(envs: V, func: F) -> Self {
        Self { envs, func }
    }

    /// The vector within.
    pub fn into_inner(self) -> V {
        self.envs
    }
}

impl<V: VectorEnv, F: Fn(f64) -> f64 + Send> VectorEnv for TransformReward<V, F> {
    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.envs.step_into(actions, columns)?;
        columns.rewards.iter_mut().for_each(|reward| *reward = (self.func)(*reward));
        Ok(())
    }

    crate::forward_vector!(
        envs: num_envs, single_observation_space, observation_space, single_action_space, autoreset, reset_into, info, final_info,
        infos, visit_envs, render, metadata, spec, describe, close
    );
}

impl<V: fmt::Debug, F> fmt::Debug for TransformReward<V, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TransformReward").field("envs", &self.envs).finish_non_exhaustive()
    }
}
