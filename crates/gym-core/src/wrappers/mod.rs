//! Environments around environments: each changes one thing and forwards the rest.
//!
//! A wrapper takes any [`Env`], typed or erased, and is an `Env` again.

mod add_render_observation;
mod add_white_noise;
mod autoreset;
pub(crate) mod clip_action;
pub(crate) mod clip_reward;
mod delay_observation;
mod discretize_action;
mod discretize_observation;
mod dtype_observation;
mod filter_observation;
mod flatten_observation;
mod frame_stack_observation;
mod grayscale_observation;
mod max_and_skip_observation;
mod normalize_observation;
pub(crate) mod normalize_reward;
mod obstruct_view;
mod order_enforcing;
mod passive_env_checker;
mod record_episode_statistics;
mod render;
mod render_collection;
mod repeat_action;
pub(crate) mod rescale_action;
mod rescale_observation;
mod reshape_observation;
mod resize_observation;
mod sticky_action;
mod time_aware_observation;
mod time_limit;
mod transform_action;
mod transform_observation;
mod transform_reward;
mod wrap;

pub use add_render_observation::AddRenderObservation;
pub use add_white_noise::AddWhiteNoise;

pub use autoreset::Autoreset;

pub use clip_action::ClipAction;
pub use clip_reward::ClipReward;
pub use delay_observation::DelayObservation;
pub use discretize_action::DiscretizeAction;
pub use discretize_observation::DiscretizeObservation;
pub use dtype_observation::DtypeObservation;
pub use filter_observation::{FilterKeys, FilterObservation};
pub use flatten_observation::FlattenObservation;
pub use frame_stack_observation::{FrameStackObservation, Padding};
pub use grayscale_observation::GrayscaleObservation;
pub use max_and_skip_observation::MaxAndSkipObservation;
pub use normalize_observation::NormalizeObservation;
pub use normalize_reward::NormalizeReward;
pub use obstruct_view::ObstructView;
pub use order_enforcing::OrderEnforcing;
pub use passive_env_checker::PassiveEnvChecker;
pub(crate) use record_episode_statistics::episode_buffer;
pub use record_episode_statistics::{EpisodeStatistics, RecordEpisodeStatistics};
pub use render::Render;
pub use render_collection::RenderCollection;
pub use repeat_action::RepeatAction;
pub use rescale_action::RescaleAction;
pub use rescale_observation::RescaleObservation;
pub use reshape_observation::ReshapeObservation;
pub use resize_observation::ResizeObservation;
pub use sticky_action::StickyAction;
pub use time_aware_observation::TimeAwareObservation;
pub use time_limit::TimeLimit;
pub use transform_action::TransformAction;
pub use transform_observation::TransformObservation;
pub use transform_reward::TransformReward;
pub use wrap::Wrap;

pub use crate::transform::{Bins, Bound};

use serde_json::Value as Json;

use crate::spaces::BoxSpace;
use crate::{Element, Env, Error, Generator, Outcome, Result, Space, Value};

/// Where the inner environment of a [`Wrapper`](crate::Wrapper) is: in its field `env`, of type `$inner`.
macro_rules! within {
    ($inner:ident) => {
        type Inner = $inner;

        fn inner(&self) -> &$inner {
            &self.env
        }

        fn inner_mut(&mut self) -> &mut $inner {
            &mut self.env
        }
    };
}
use within;

/// `get_ref`, `get_mut` and `into_inner` of a wrapper with a field `env`.
macro_rules! reach {
    ($name:ident<$env:ident $(: $bound:path)? $(, $parameter:ident)*>) => {
        impl<$env $(: $bound)? $(, $parameter)*> $name<$env $(, $parameter)*> {
            /// The environment within.
            pub fn get_ref(&self) -> &$env {
                &self.env
            }

            /// The environment within, to change it. What the wrapper keeps of it does not follow.
            pub fn get_mut(&mut self) -> &mut $env {
                &mut self.env
            }

            /// The environment within, without the wrapper.
            pub fn into_inner(self) -> $env {
                self.env
            }
        }
    };
}
use reach;

/// `Wrapper` for a wrapper that changes observations by a function without state. It has the
/// fields `env`, `space` and `inner` (a kept [`Value`](crate::Value) for the observation within), and the
/// methods `observe(&self, out: &mut Value) -> Result<()>`, which reads `inner`, and `stored`.
macro_rules! observation_wrapper {
    ($name:ident) => {
        super::reach!($name<E>);

        impl<E: $crate::Env> $crate::Wrapper for $name<E> {
            type Observation = $crate::Value;
            type Action = E::Action;

            super::within!(E);

            fn observation_space(&self) -> $crate::Space {
                self.space.clone()
            }

            fn reset_into(
                &mut self,
                reset: &$crate::Reset,
                observation: &mut $crate::Value,
            ) -> $crate::Result<()> {
                let Self { env, inner, .. } = self;
                <E::Observation as $crate::Element>::fill(inner, |inner| env.reset_into(reset, inner))?;
                self.observe(observation)
            }

            fn step_into(
                &mut self,
                action: &E::Action,
                observation: &mut $crate::Value,
            ) -> $crate::Result<$crate::Outcome> {
                let Self { env, inner, .. } = self;
                let outcome =
                    <E::Observation as $crate::Element>::fill(inner, |inner| env.step_into(action, inner))?;
                self.observe(observation)?;
                Ok(outcome)
            }

            fn wrapper_spec(&self) -> Option<$crate::WrapperSpec> {
                Some(self.stored())
            }
        }
    };
}
use observation_wrapper;

/// The generator of the environment within.
fn lend<'a, E: Env>(env: &'a mut E, wrapper: &str) -> Result<&'a mut Generator> {
    env.generator().ok_or_else(|| {
        Error::Contract(format!(
            "{wrapper} draws from the environment's own generator: reset it first, and implement \
             `Env::generator` where it is not"
        ))
    })
}

/// The typed element of a space that was stored as JSON.
fn element<T: Element>(space: &Space, json: &Json) -> Result<T> {
    let value = space.from_json(json).map_err(|error| Error::Snapshot(error.to_string()))?;
    T::from_value(&value).ok_or_else(|| Error::Snapshot(format!("{value} has the wrong type")))
}

/// Leaves an action in `inner` if it has the form of the space; its bounds are not checked.
fn expect_action<A: Element>(space: &Space, action: &A, inner: &mut Value) -> Result<()> {
    action.write(inner);
    let has_form = match (inner, space) {
        (Value::Array(array), Space::Box(space)) => {
            array.dtype() == space.dtype() && array.shape() == space.shape()
        }
        _ => false,
    };
    if has_form { Ok(()) } else { Err(space.refuse_action(&action.to_value())) }
}

/// Takes a step with the typed form of an action.
fn act<E: Env>(env: &mut E, action: &Value, observation: &mut E::Observation) -> Result<Outcome> {
    E::Action::with(action, |action| env.step_into(action, observation))
        .unwrap_or_else(|| Err(env.action_space().refuse_action(action)))
}

/// The box that a wrapper needs for a space.
pub(crate) fn expect_box<'a>(wrapper: &str, kind: &str, space: &'a Space) -> Result<&'a BoxSpace> {
    match space {
        Space::Box(space) => Ok(space),
        _ => Err(Error::argument(wrapper, format!("it needs a Box {kind} space, and this one is {space}"))),
    }
}

/// The picture space `Box(0, 255, ..., uint8)` that a wrapper needs.
fn expect_picture<'a>(wrapper: &str, space: &'a Space) -> Result<&'a BoxSpace> {
    let space = expect_box(wrapper, "observation", space)?;
    let is_picture = space.dtype() == crate::DType::U8
        && space.low().iter_f64().all(|x| x == 0.0)
        && space.high().iter_f64().all(|x| x == 255.0);
    if is_picture {
        return Ok(space);
    }
    Err(Error::argument(wrapper, format!("it needs uint8 observations from 0 to 255, and these are {space}")))
}
