use super::cast_actions;
use crate::transform::affine::{Affine, Bound};
use crate::vector::{Columns, VectorEnv};
use crate::wrappers::rescale_action::affine_map;
use crate::{Result, Space, Value};

/// Maps actions linearly from other bounds to those of the sub-environments' `Box`.
#[derive(Clone, Debug)]
pub struct RescaleAction<V> {
    envs: V,
    space: Space,
    map: Affine,
    inner: Value,
}

impl<V: VectorEnv> RescaleAction<V> {
    /// Takes actions between the new bounds, which are those of one sub-environment.
    ///
    /// # Errors
    /// As [`wrappers::RescaleAction::new`](crate::wrappers::RescaleAction::new).
    pub fn new(envs: V, min_action: impl Into<Bound>, max_action: impl Into<Bound>) -> Result<Self> {
        let (map, space) = affine_map(&envs.single_action_space(), &min_action.into(), &max_action.into())?;
        Ok(Self { envs, space: space.into(), map, inner: Value::Null })
    }

    /// The vector within.
    pub fn into_inner(self) -> V {
        self.envs
    }
}

impl<V: VectorEnv> VectorEnv for RescaleAction<V> {
    fn single_action_space(&self) -> Space {
        self.space.clone()
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        let array = cast_actions(&self.space, self.envs.num_envs(), actions, &mut self.inner)?;
        self.map.backward(array);
        self.envs.step_into(&self.inner, columns)
    }

    crate::forward_vector!(
        envs: num_envs, single_observation_space, observation_space, autoreset, reset_into, info, final_info, infos, visit_envs,
        render, metadata, spec, describe, close
    );
}
