use crate::transform::clip::RewardBounds;
use crate::vector::{Columns, VectorEnv};
use crate::{Result, Value};

/// Clips rewards between bounds, either of which may be left out.
#[derive(Clone, Debug)]
pub struct ClipReward<V> {
    envs: V,
    bounds: RewardBounds,
}

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

    /// The vector within.
    pub fn into_inner(self) -> V {
        self.envs
    }
}

impl<V: VectorEnv> VectorEnv for ClipReward<V> {
    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.envs.step_into(actions, columns)?;
        columns.rewards.iter_mut().for_each(|reward| *reward = self.bounds.clip(*reward));
        Ok(())
    }

    crate::forward_vector!(
        envs: num_envs, single_observation_space, observation_space, single_action_space, autoreset, reset_into, info, final_info,
        infos, visit_envs, render, metadata, spec, describe, close
    );
}
