use super::*;
use crate::wrappers::Bound;

/// Every wrapper of vectors as a method, for any vector.
///
/// ```no_run
/// use gym_core::vector::VectorWrap;
///
/// # fn main() -> gym_core::Result<()> {
/// let envs = gym_core::make_vec("Pendulum-v1", 16, None)?
///     .record_episode_statistics()
///     .normalize_observation()?
///     .clip_reward(-5.0, None)?;
/// # Ok(())
/// # }
/// ```
pub trait VectorWrap: VectorEnv + Sized {
    /// [`RecordEpisodeStatistics`] of the last 100 episodes.
    fn record_episode_statistics(self) -> RecordEpisodeStatistics<Self> {
        RecordEpisodeStatistics::new(self)
    }

    /// [`TransformObservation`].
    fn transform_observation<F>(
        self,
        func: F,
        single_observation_space: impl Into<Option<Space>>,
    ) -> TransformObservation<Self, F>
    where
        F: Fn(&Value) -> Value + Send + 'static,
    {
        TransformObservation::new(self, func, single_observation_space)
    }

    /// [`RescaleObservation`].
    ///
    /// # Errors
    /// As [`RescaleObservation::new`].
    fn rescale_observation(
        self,
        min_obs: impl Into<Bound>,
        max_obs: impl Into<Bound>,
    ) -> Result<RescaleObservation<Self>> {
        RescaleObservation::new(self, min_obs, max_obs)
    }

    /// [`NormalizeObservation`].
    ///
    /// # Errors
    /// As [`NormalizeObservation::new`].
    fn normalize_observation(self) -> Result<NormalizeObservation<Self>> {
        NormalizeObservation::new(self)
    }

    /// [`TransformAction`].
    fn transform_action<F>(
        self,
        func: F,
        single_action_space: impl Into<Option<Space>>,
    ) -> TransformAction<Self, F>
    where
        F: Fn(&Value) -> Value + Send + 'static,
    {
        TransformAction::new(self, func, single_action_space)
    }

    /// [`ClipAction`].
    ///
    /// # Errors
    /// As [`ClipAction::new`].
    fn clip_action(self) -> Result<ClipAction<Self>> {
        ClipAction::new(self)
    }

    /// [`RescaleAction`].
    ///
    /// # Errors
    /// As [`RescaleAction::new`].
    fn rescale_action(
        self,
        min_action: impl Into<Bound>,
        max_action: impl Into<Bound>,
    ) -> Result<RescaleAction<Self>> {
        RescaleAction::new(self, min_action, max_action)
    }

    /// [`TransformReward`].
    fn transform_reward<F: Fn(f64) -> f64 + Send + 'static>(self, func: F) -> TransformReward<Self, F> {
        TransformReward::new(self, func)
    }

    /// [`ClipReward`].
    ///
    /// # Errors
    /// As [`ClipReward::new`].
    fn clip_reward(
        self,
        min_reward: impl Into<Option<f64>>,
        max_reward: impl Into<Option<f64>>,
    ) -> Result<ClipReward<Self>> {
        ClipReward::new(self, min_reward, max_reward)
    }

    /// [`NormalizeReward`].
    ///
    /// # Errors
    /// As [`NormalizeReward::new`].
    fn normalize_reward(self, gamma: f64) -> Result<NormalizeReward<Self>> {
        NormalizeReward::new(self, gamma)
    }
}

impl<V: VectorEnv> VectorWrap for V {}
