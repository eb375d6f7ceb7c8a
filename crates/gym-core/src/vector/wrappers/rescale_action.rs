use super::{cast_actions, reach};
use crate::transform::affine::{Affine, Bound};
use crate::vector::{Columns, VectorEnv};
use crate::wrappers::rescale_action::affine_map;
use crate::{Result, Space, Value, WrapperSpec};

/// Maps actions linearly from other bounds to those of the sub-environments' `Box`.
#[derive(Clone, Debug)]
pub struct RescaleAction<V = Box<dyn VectorEnv>> {
    envs: V,
    space: Space,
    bounds: [Bound; 2],
    map: Affine,
    inner: Value,
}

reach!(RescaleAction);

impl<V: VectorEnv> RescaleAction<V> {
    /// Takes actions between the new bounds, which are those of one sub-environment.
    ///
    /// # Errors
    /// As [`wrappers::RescaleAction::new`](crate::wrappers::RescaleAction::new).
    pub fn new(envs: V, min_action: impl Into<Bound>, max_action: impl Into<Bound>) -> Result<Self> {
        let inner = envs.single_action_space();
        let bounds = [min_action.into(), max_action.into()].map(|bound| bound.in_type_of(&inner));
        let (map, space) = affine_map(&inner, &bounds[0], &bounds[1])?;
        Ok(Self { envs, space: space.into(), bounds, map, inner: Value::Null })
    }
}

impl<V: VectorEnv> crate::VectorWrapper for RescaleAction<V> {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let [min, max] = self.bounds.each_ref().map(Bound::to_json);
        Some(WrapperSpec::new("RescaleAction").arg("min_action", min).arg("max_action", max))
    }

    fn single_action_space(&self) -> Space {
        self.space.clone()
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        let array = cast_actions(&self.space, self.envs.num_envs(), actions, &mut self.inner)?;
        self.map.backward(array);
        self.envs.step_into(&self.inner, columns)
    }
}
