use super::{cast_actions, reach};
use crate::spaces::BoxSpace;
use crate::transform::clip::clip;
use crate::vector::{Columns, VectorEnv};
use crate::wrappers::expect_box;
use crate::{Result, Space, Value, WrapperSpec};

/// Clips actions to the bounds of the sub-environments' `Box`, and so takes any numbers: its own action
/// space is unbounded.
#[derive(Clone, Debug)]
pub struct ClipAction<V = Box<dyn VectorEnv>> {
    envs: V,
    space: Space,
    bounds: BoxSpace,
    inner: Value,
}

reach!(ClipAction);

impl<V: VectorEnv> ClipAction<V> {
    /// Clips the actions for `envs`.
    ///
    /// # Errors
    /// As [`wrappers::ClipAction::new`](crate::wrappers::ClipAction::new).
    pub fn new(envs: V) -> Result<Self> {
        let bounds = expect_box("ClipAction", "action", &envs.single_action_space())?.clone();
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        let space = BoxSpace::uniform(low, high, bounds.shape(), bounds.dtype())?.into();
        Ok(Self { envs, space, bounds, inner: Value::Null })
    }
}

impl<V: VectorEnv> crate::VectorWrapper for ClipAction<V> {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(WrapperSpec::new("ClipAction"))
    }

    fn single_action_space(&self) -> Space {
        self.space.clone()
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        let array = cast_actions(&self.space, self.envs.num_envs(), actions, &mut self.inner)?;
        clip(array, &self.bounds);
        self.envs.step_into(&self.inner, columns)
    }
}
