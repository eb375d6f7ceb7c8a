//! Wrappers by method chaining.

use gym_core::{Element, Env, Result, Space, Value, VectorEnv};

use crate::*;

/// Declares methods that wrap `self`, with arguments or with default arguments. `both` declares
/// methods for environments and for vectors.
macro_rules! methods {
    (both) => {
        methods! {
            filter_observation(filter_keys) => FilterObservation in filter_observation,
            flatten_observation => FlattenObservation in flatten_observation,
            grayscale_observation(keep_dim) => GrayscaleObservation in grayscale_observation,
            resize_observation(shape) => ResizeObservation in resize_observation,
            reshape_observation(shape) => ReshapeObservation in reshape_observation,
            rescale_observation(bounds) => RescaleObservation in rescale_observation,
            dtype_observation(dtype) => DtypeObservation in dtype_observation,
            discretize_observation(bins) => DiscretizeObservation in discretize_observation,
            normalize_observation => NormalizeObservation in normalize_observation,
            clip_action => ClipAction in clip_action,
            rescale_action(bounds) => RescaleAction in rescale_action,
            discretize_action(bins) => DiscretizeAction in discretize_action,
            clip_reward(bounds) => ClipReward in clip_reward,
            normalize_reward(gamma) => NormalizeReward in normalize_reward,
        }
    };
    ($($method:ident $(($config:ident))? => $wrapper:ident in $module:ident),* $(,)?) => {$(
        #[doc = concat!("[`", stringify!($wrapper), "`].")]
        ///
        /// # Errors
        #[doc = concat!("As [`", stringify!($wrapper), "::new`].")]
        fn $method(self $(, $config: impl Into<$module::Config>)?) -> Result<$wrapper<Self>> {
            methods!(@new $wrapper, $module, self $(, $config)?)
        }
    )*};
    (@new $wrapper:ident, $module:ident, $self:ident) => {
        $wrapper::new($self, $module::Config::default())
    };
    (@new $wrapper:ident, $module:ident, $self:ident, $config:ident) => {
        $wrapper::new($self, $config)
    };
}

/// The wrappers of environments as methods, for any environment, typed or erased.
///
/// ```
/// use gym_core::{BoxEnv, Env, Result};
/// use gym_wrappers::Wrap;
///
/// fn preprocess(env: BoxEnv) -> Result<impl Env> {
///     Ok(env.clip_reward((-1.0, 1.0))?.frame_stack(4)?.record_episode_statistics())
/// }
/// ```
///
/// Methods take the wrapper's `Config`, or the arguments that Gymnasium's constructors require;
/// those without an argument use the defaults.
pub trait Wrap: Env + Sized {
    /// [`TimeLimit`].
    ///
    /// # Errors
    /// The errors of [`TimeLimit::new`].
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

    methods! { both }

    methods! {
        add_render_observation => AddRenderObservation in add_render_observation,
        delay_observation(delay) => DelayObservation in delay_observation,
        time_aware_observation => TimeAwareObservation in time_aware_observation,
        frame_stack(stack_size) => FrameStackObservation in frame_stack_observation,
        max_and_skip(skip) => MaxAndSkipObservation in max_and_skip_observation,
        sticky_action(probability) => StickyAction in sticky_action,
        repeat_action(num_repeats) => RepeatAction in repeat_action,
        add_white_noise(probability) => AddWhiteNoise in add_white_noise,
        obstruct_view(ratio_and_width) => ObstructView in obstruct_view,
    }

    /// [`TransformObservation`].
    fn transform_observation<F, O>(
        self,
        func: F,
        observation_space: impl Into<Option<Space>>,
    ) -> TransformObservation<Self, F, Self::Observation>
    where
        F: Fn(&Self::Observation) -> O + Clone + Send + 'static,
        O: Element,
    {
        TransformObservation::new(self, func, observation_space)
    }

    /// [`TransformAction`].
    fn transform_action<F, A>(
        self,
        func: F,
        action_space: impl Into<Option<Space>>,
    ) -> TransformAction<Self, F, A>
    where
        F: Fn(&A) -> Self::Action + Clone + Send + 'static,
        A: Element,
    {
        TransformAction::new(self, func, action_space)
    }

    /// [`TransformReward`].
    fn transform_reward<F: Fn(f64) -> f64 + Clone + Send + 'static>(
        self,
        func: F,
    ) -> TransformReward<Self, F> {
        TransformReward::new(self, func)
    }
}

impl<E: Env> Wrap for E {}

/// The wrappers of vectors as methods, for any vector.
///
/// ```no_run
/// use gym_wrappers::VectorWrap;
///
/// # fn main() -> gym_core::Result<()> {
/// let envs = gym_core::make_vec("Pendulum-v1", 16, None)?
///     .record_episode_statistics()
///     .normalize_observation()?
///     .clip_reward((-5.0, None))?;
/// # Ok(())
/// # }
/// ```
pub trait VectorWrap: VectorEnv + Sized {
    /// [`RecordEpisodeStatistics`] of the last 100 episodes.
    fn record_episode_statistics(self) -> RecordEpisodeStatistics<Self> {
        RecordEpisodeStatistics::new(self)
    }

    methods! { both }

    /// [`TransformObservation`].
    fn transform_observation<F>(
        self,
        func: F,
        single_observation_space: impl Into<Option<Space>>,
    ) -> TransformObservation<Self, F, map::Seen>
    where
        F: Fn(&Value) -> Value + Send + 'static,
    {
        TransformObservation::new(self, func, single_observation_space)
    }

    /// [`TransformAction`].
    fn transform_action<F>(
        self,
        func: F,
        single_action_space: impl Into<Option<Space>>,
    ) -> TransformAction<Self, F, Value>
    where
        F: Fn(&Value) -> Value + Send + 'static,
    {
        TransformAction::new(self, func, single_action_space)
    }

    /// [`TransformReward`].
    fn transform_reward<F: Fn(f64) -> f64 + Send + 'static>(
        self,
        func: F,
    ) -> TransformReward<Self, F> {
        TransformReward::new(self, func)
    }
}

impl<V: VectorEnv> VectorWrap for V {}
