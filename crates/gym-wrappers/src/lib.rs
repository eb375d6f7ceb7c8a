//! Gymnasium's wrappers, around environments and vectors.
//!
//! A wrapper is made from the inner environment or vector, and its arguments, a `Config`:
//!
//! ```
//! use gym_core::{Env, Result};
//! use gym_wrappers::{ClipReward, FrameStackObservation, clip_reward};
//!
//! fn preprocessed(env: impl Env) -> Result<impl Env> {
//!     let config = clip_reward::Config { min_reward: Some((-1.0).into()), max_reward: None };
//!     FrameStackObservation::new(ClipReward::new(env, config)?, 4) // short for a `Config` with `stack_size: 4`
//! }
//! ```
//!
//! The traits [`Wrap`] and [`VectorWrap`] make methods of them. Each is registered under
//! Gymnasium's name, with Gymnasium's names of the arguments, so that specs rebuild stacks of them.
//!
//! The wrappers that `make` adds, such as `TimeLimit`, are in [`gym_core::wrappers`] and
//! re-exported here.
//!
//! # Which trait for a wrapper of your own
//!
//! | the wrapper | implement | around an environment | around a vector |
//! |---|---|---|---|
//! | computes each observation from the inner one alone | [`map::ObservationMap`] | [`map::MapObservation`] | the same |
//! | computes the inner action from each action alone | [`map::ActionMap`] | [`map::MapAction`] | the same |
//! | computes each reward from the inner one alone | [`map::RewardMap`] | [`map::MapReward`] | the same |
//! | makes observations with a state of its own, such as a stack of frames | [`observing::Observer`]; [`observing::VectorObserver`] for vectors too | [`observing::Observing`] | the same |
//! | anything else: the ends of an episode, repeated steps, statistics | [`Wrapper`](gym_core::Wrapper) | the type itself | |
//! | anything else, around a vector | [`VectorWrapper`](gym_core::VectorWrapper) | | the type itself |
//! | a closure, without a name in specs | nothing | [`TransformObservation`], [`TransformAction`], [`TransformReward`] | the same, for batches |

pub mod add_render_observation;
mod affine;
pub mod autoreset;
pub mod bins;
pub mod bounds;
pub mod clip_action;
pub mod clip_reward;
mod clock;
pub mod delay_observation;
pub mod discretize_action;
pub mod discretize_observation;
pub mod dtype_observation;
pub mod filter_observation;
pub mod flatten_observation;
pub mod frame_stack_observation;
pub mod grayscale_observation;
pub mod map;
pub mod max_and_skip_observation;
pub mod noise;
pub mod normalize_observation;
pub mod normalize_reward;
pub mod observing;
pub mod record_episode_statistics;
pub mod repeat_action;
pub mod rescale_action;
pub mod rescale_observation;
pub mod reshape_observation;
pub mod resize_observation;
mod ring;
pub mod statistics;
pub mod sticky_action;
pub mod time_aware_observation;
mod transform_action;
mod transform_observation;
mod transform_reward;
mod within;
mod wrap;

pub use add_render_observation::AddRenderObservation;
pub use autoreset::Autoreset;
pub use bins::{Binning, Bins};
pub use bounds::Bound;
pub use clip_action::ClipAction;
pub use clip_reward::ClipReward;
pub use delay_observation::DelayObservation;
pub use discretize_action::DiscretizeAction;
pub use discretize_observation::DiscretizeObservation;
pub use dtype_observation::DtypeObservation;
pub use filter_observation::{FilterKeys, FilterObservation};
pub use flatten_observation::FlattenObservation;
pub use frame_stack_observation::FrameStackObservation;
pub use grayscale_observation::GrayscaleObservation;
pub use max_and_skip_observation::MaxAndSkipObservation;
pub use noise::{AddWhiteNoise, ObstructView, add_white_noise, obstruct_view};
pub use normalize_observation::NormalizeObservation;
pub use normalize_reward::NormalizeReward;
pub use record_episode_statistics::{EpisodeStatistics, RecordEpisodeStatistics};
pub use repeat_action::RepeatAction;
pub use rescale_action::RescaleAction;
pub use rescale_observation::RescaleObservation;
pub use reshape_observation::ReshapeObservation;
pub use resize_observation::ResizeObservation;
pub use statistics::RunningMeanStd;
pub use sticky_action::StickyAction;
pub use time_aware_observation::TimeAwareObservation;
pub use transform_action::TransformAction;
pub use transform_observation::TransformObservation;
pub use transform_reward::TransformReward;
pub use wrap::{VectorWrap, Wrap};

pub use gym_core::wrappers::*;

/// The example of the README, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
