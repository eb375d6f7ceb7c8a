use super::{each_reward, reach};
use crate::transform::clip::RewardBounds;
use crate::transform::number_to_json;
use crate::vector::{Columns, VectorEnv};
use crate::{Result, Value, WrapperSpec};

/// Clips rewards between bounds, either of which may be left out.
#[derive(Clone, Debug)]
pub struct ClipReward<V = Box<dyn VectorEnv>> {
    envs: V,
    bounds: RewardBounds,
}

reach!(ClipReward);

impl<V: VectorEnv> ClipReward<V> {
    /// Clips the rewards of `envs`.
    ///
    /// # Errors
    /// As [`wrappers::ClipReward::new`](crate::wrappers::ClipReward::new).
    pub fn new(
        envs: V,
        min_reward: impl Into<Option<f64>>,
        max_reward: impl Into<Option<f64>>,
    ) -> Result<Self> {
        Ok(Self { envs, bounds: RewardBounds::new(min_reward.into(), max_reward.into())? })
    }
}

impl<V: VectorEnv> crate::VectorWrapper for ClipReward<V> {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let RewardBounds { min, max } = self.bounds;
        let wrapper = WrapperSpec::new("ClipReward");
        Some(wrapper.arg("min_reward", number_to_json(min)).arg("max_reward", number_to_json(max)))
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        let Self { envs, bounds } = self;
        each_reward(envs, actions, columns, |reward| bounds.clip(reward))
    }
}
