//! Wrappers by method chaining.

use super::*;
use crate::{DType, Env, Result, Space};

/// Every wrapper as a method, for any environment, typed or erased.
///
/// ```
/// use gym_core::{BoxEnv, Env, Result, Wrap};
///
/// fn preprocess(env: BoxEnv) -> Result<impl Env> {
///     Ok(env.clip_reward(-1.0, 1.0)?.frame_stack(4)?.record_episode_statistics())
/// }
/// ```
///
/// Methods take what Gymnasium's constructors require, and the wrappers themselves have methods for
/// the rest.
pub trait Wrap: Env + Sized {
    /// [`TimeLimit`].
    ///
    /// # Errors
    /// As [`TimeLimit::new`].
    fn time_limit(self, max_episode_steps: u32) -> Result<TimeLimit<Self>> {
        TimeLimit::new(self, max_episode_steps)
    }

    /// [`Autoreset`].
    fn autoreset(self) -> Autoreset<Self> {
        Autoreset::new(self)
    }

    /// [`RecordEpisodeStatistics`] of the last 100 episodes.
    fn record_episode_statistics(self) -> RecordEpisodeStatistics<Self> {
        RecordEpisodeStatistics::new(self)
    }

    /// [`TransformObservation`].
    fn transform_observation<F, O>(
        self,
        func: F,
        observation_space: impl Into<Option<Space>>,
    ) -> TransformObservation<Self, F>
    where
        F: Fn(&Self::Observation) -> O + Clone + Send + 'static,
        O: crate::Element,
    {
        TransformObservation::new(self, func, observation_space)
    }

    /// [`FilterObservation`].
    ///
    /// # Errors
    /// As [`FilterObservation::new`].
    fn filter_observation(self, filter_keys: impl Into<FilterKeys>) -> Result<FilterObservation<Self>> {
        FilterObservation::new(self, filter_keys)
    }

    /// [`FlattenObservation`].
    ///
    /// # Errors
    /// As [`FlattenObservation::new`].
    fn flatten_observation(self) -> Result<FlattenObservation<Self>> {
        FlattenObservation::new(self)
    }

    /// [`GrayscaleObservation`].
    ///
    /// # Errors
    /// As [`GrayscaleObservation::new`].
    fn grayscale_observation(self, keep_dim: bool) -> Result<GrayscaleObservation<Self>> {
        GrayscaleObservation::new(self, keep_dim)
    }

    /// [`ResizeObservation`].
    ///
    /// # Errors
    /// As [`ResizeObservation::new`].
    fn resize_observation(self, height: usize, width: usize) -> Result<ResizeObservation<Self>> {
        ResizeObservation::new(self, height, width)
    }

    /// [`ReshapeObservation`].
    ///
    /// # Errors
    /// As [`ReshapeObservation::new`].
    fn reshape_observation(self, shape: impl Into<Vec<usize>>) -> Result<ReshapeObservation<Self>> {
        ReshapeObservation::new(self, shape)
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

    /// [`DtypeObservation`].
    ///
    /// # Errors
    /// As [`DtypeObservation::new`].
    fn dtype_observation(self, dtype: DType) -> Result<DtypeObservation<Self>> {
        DtypeObservation::new(self, dtype)
    }

    /// [`AddRenderObservation`] of the picture alone.
    ///
    /// # Errors
    /// As [`AddRenderObservation::new`].
    fn add_render_observation(self) -> Result<AddRenderObservation<Self>> {
        AddRenderObservation::new(self)
    }

    /// [`DiscretizeObservation`] to one integer.
    ///
    /// # Errors
    /// As [`DiscretizeObservation::new`].
    fn discretize_observation(self, bins: impl Into<Bins>) -> Result<DiscretizeObservation<Self>> {
        DiscretizeObservation::new(self, bins, false)
    }

    /// [`DelayObservation`].
    ///
    /// # Errors
    /// As [`DelayObservation::new`].
    fn delay_observation(self, delay: usize) -> Result<DelayObservation<Self>> {
        DelayObservation::new(self, delay)
    }

    /// [`TimeAwareObservation`], flattened.
    ///
    /// # Errors
    /// As [`TimeAwareObservation::new`].
    fn time_aware_observation(self) -> Result<TimeAwareObservation<Self>> {
        TimeAwareObservation::new(self)
    }

    /// [`FrameStackObservation`].
    ///
    /// # Errors
    /// As [`FrameStackObservation::new`].
    fn frame_stack(self, stack_size: usize) -> Result<FrameStackObservation<Self>> {
        FrameStackObservation::new(self, stack_size)
    }

    /// [`NormalizeObservation`].
    ///
    /// # Errors
    /// As [`NormalizeObservation::new`].
    fn normalize_observation(self) -> Result<NormalizeObservation<Self>> {
        NormalizeObservation::new(self)
    }

    /// [`MaxAndSkipObservation`].
    ///
    /// # Errors
    /// As [`MaxAndSkipObservation::new`].
    fn max_and_skip(self, skip: u32) -> Result<MaxAndSkipObservation<Self>> {
        MaxAndSkipObservation::new(self, skip)
    }

    /// [`TransformAction`].
    fn transform_action<F, A>(
        self,
        func: F,
        action_space: impl Into<Option<Space>>,
    ) -> TransformAction<Self, F, A>
    where
        F: Fn(&A) -> Self::Action + Clone + Send + 'static,
        A: crate::Element,
    {
        TransformAction::new(self, func, action_space)
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

    /// [`DiscretizeAction`] from one integer.
    ///
    /// # Errors
    /// As [`DiscretizeAction::new`].
    fn discretize_action(self, bins: impl Into<Bins>) -> Result<DiscretizeAction<Self>> {
        DiscretizeAction::new(self, bins, false)
    }

    /// [`StickyAction`] for one step at a time.
    ///
    /// # Errors
    /// As [`StickyAction::new`].
    fn sticky_action(self, repeat_action_probability: f64) -> Result<StickyAction<Self>> {
        StickyAction::new(self, repeat_action_probability)
    }

    /// [`RepeatAction`].
    ///
    /// # Errors
    /// As [`RepeatAction::new`].
    fn repeat_action(self, num_repeats: u32) -> Result<RepeatAction<Self>> {
        RepeatAction::new(self, num_repeats)
    }

    /// [`TransformReward`].
    fn transform_reward<F>(self, func: F) -> TransformReward<Self, F>
    where
        F: Fn(f64) -> f64 + Clone + Send + 'static,
    {
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

    /// [`AddWhiteNoise`] of colour.
    ///
    /// # Errors
    /// As [`AddWhiteNoise::new`].
    fn add_white_noise(self, probability_of_noise_per_pixel: f64) -> Result<AddWhiteNoise<Self>> {
        AddWhiteNoise::new(self, probability_of_noise_per_pixel, false)
    }

    /// [`ObstructView`] with noise of colour.
    ///
    /// # Errors
    /// As [`ObstructView::new`].
    fn obstruct_view(self, ratio: f64, obstruction_width: u32) -> Result<ObstructView<Self>> {
        ObstructView::new(self, ratio, obstruction_width, false)
    }
}

impl<E: Env> Wrap for E {}
