//! Environments around environments: each changes one thing and forwards the rest.
//!
//! A wrapper takes any [`Env`], typed or erased, and is an `Env` again.

mod add_render_observation;
mod add_white_noise;
pub(crate) mod affine;
mod area;
mod autoreset;
mod bins;
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
pub(crate) mod moments;
mod noise;
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
pub(crate) mod running;
mod sticky_action;
mod time_aware_observation;
mod time_limit;
mod transform_action;
mod transform_observation;
mod transform_reward;
mod wrap;

pub use add_render_observation::AddRenderObservation;
pub use add_white_noise::AddWhiteNoise;
pub use affine::Bound;
pub use autoreset::Autoreset;
pub use bins::Bins;
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

use serde_json::Value as Json;

use crate::spaces::BoxSpace;
use crate::{Element, Env, Error, Generator, Outcome, Result, Space, Value};

/// `Env` for a wrapper that changes observations by a function without state. The wrapper has the
/// fields `env`, `space` and `inner` (a kept [`Value`](crate::Value) for the observation within), a
/// method `observe(&self, out: &mut Output) -> Result<()>` that reads `inner`, and `wrapper_spec`.
macro_rules! observation_wrapper {
    ($name:ident: $output:ty) => {
        impl<E: $crate::Env> $name<E> {
            /// The environment within.
            pub fn into_inner(self) -> E {
                self.env
            }
        }

        impl<E: $crate::Env> $crate::Env for $name<E> {
            type Observation = $output;
            type Action = E::Action;

            fn observation_space(&self) -> $crate::Space {
                self.space.clone()
            }

            fn reset_into(
                &mut self,
                reset: &$crate::Reset,
                observation: &mut $output,
            ) -> $crate::Result<()> {
                let Self { env, inner, .. } = self;
                <E::Observation as $crate::Element>::fill(inner, |inner| env.reset_into(reset, inner))?;
                self.observe(observation)
            }

            fn step_into(
                &mut self,
                action: &E::Action,
                observation: &mut $output,
            ) -> $crate::Result<$crate::Outcome> {
                let Self { env, inner, .. } = self;
                let outcome =
                    <E::Observation as $crate::Element>::fill(inner, |inner| env.step_into(action, inner))?;
                self.observe(observation)?;
                Ok(outcome)
            }

            fn spec(&self) -> Option<$crate::EnvSpec> {
                self.env.spec().map(|spec| spec.wrapped(self.wrapper_spec()))
            }

            $crate::forward!(
                env: action_space, snapshot, restore, info, metadata, draw, ansi, base, generator, close, describe,
                render
            );
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

/// A number as JSON, where infinity is a string as in the stored form of spaces.
fn number_to_json(number: impl Into<Option<f64>>) -> Json {
    match number.into() {
        Some(x) if x.is_infinite() => Json::from(if x > 0.0 { "inf" } else { "-inf" }),
        number => Json::from(number),
    }
}

fn not_an_array(value: &Value) -> Error {
    Error::Contract(format!("{value} should be an array of the space's type"))
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
    if has_form { Ok(()) } else { Err(invalid_action(&action.to_value(), space)) }
}

fn invalid_action(action: &Value, space: &Space) -> Error {
    let hint = String::new();
    Error::InvalidAction { action: action.to_string(), space: space.to_string(), hint }
}

/// Takes a step with the typed form of an action.
fn act<E: Env>(env: &mut E, action: &Value, observation: &mut E::Observation) -> Result<Outcome> {
    E::Action::with(action, |action| env.step_into(action, observation))
        .unwrap_or_else(|| Err(invalid_action(action, &env.action_space())))
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

/// Implements methods of [`Env`](crate::Env) by calling the same method of a field.
///
/// ```text
/// gym_core::forward!(env: observation_space, action_space, info, metadata, draw, ansi, render, base, close);
/// ```
#[macro_export]
macro_rules! forward {
    ($field:tt: $($method:ident),+ $(,)?) => { $($crate::forward!(@ $field $method);)+ };
    (@ $field:tt observation_space) => {
        fn observation_space(&self) -> $crate::Space { self.$field.observation_space() }
    };
    (@ $field:tt action_space) => {
        fn action_space(&self) -> $crate::Space { self.$field.action_space() }
    };
    (@ $field:tt reset_into) => {
        fn reset_into(
            &mut self,
            reset: &$crate::Reset,
            observation: &mut Self::Observation,
        ) -> $crate::Result<()> {
            self.$field.reset_into(reset, observation)
        }
    };
    (@ $field:tt step_into) => {
        fn step_into(
            &mut self,
            action: &Self::Action,
            observation: &mut Self::Observation,
        ) -> $crate::Result<$crate::Outcome> {
            self.$field.step_into(action, observation)
        }
    };
    (@ $field:tt snapshot) => {
        fn snapshot(&self) -> $crate::Result<$crate::Snapshot> { self.$field.snapshot() }
    };
    (@ $field:tt restore) => {
        fn restore(&mut self, snapshot: &$crate::Snapshot) -> $crate::Result<()> {
            self.$field.restore(snapshot)
        }
    };
    (@ $field:tt info) => {
        fn info(&self, visit: &mut dyn FnMut(&str, $crate::Value)) { self.$field.info(visit); }
    };
    (@ $field:tt metadata) => {
        fn metadata(&self) -> $crate::render::Metadata { self.$field.metadata() }
    };
    (@ $field:tt draw) => {
        fn draw(&self, canvas: &mut dyn $crate::canvas::Canvas) { self.$field.draw(canvas); }
        fn start_rendering(&mut self) { self.$field.start_rendering(); }
        fn picture_taken(&mut self) { self.$field.picture_taken(); }
    };
    (@ $field:tt ansi) => {
        fn ansi(&self) -> Option<String> { self.$field.ansi() }
    };
    (@ $field:tt render) => {
        fn render(&mut self) -> $crate::Result<$crate::render::Rendered> { self.$field.render() }
        fn render_into(&mut self, rendered: &mut $crate::render::Rendered) -> $crate::Result<()> {
            self.$field.render_into(rendered)
        }
    };
    (@ $field:tt spec) => {
        fn spec(&self) -> Option<$crate::EnvSpec> { self.$field.spec() }
    };
    (@ $field:tt base) => {
        fn base(&self) -> &dyn ::std::any::Any { self.$field.base() }
    };
    (@ $field:tt generator) => {
        fn generator(&mut self) -> Option<&mut $crate::Generator> { self.$field.generator() }
    };
    (@ $field:tt close) => {
        fn close(&mut self) { self.$field.close(); }
    };
    (@ $field:tt describe) => {
        fn describe(&self) -> String { $crate::wrappers::describe(self, &self.$field) }
    };
}

/// `<Wrapper<inner>>`, as Gymnasium prints a stack.
#[doc(hidden)]
pub fn describe<W, E: crate::Env>(_wrapper: &W, inner: &E) -> String {
    let inner = inner.describe();
    let inner = inner.strip_prefix('<').and_then(|s| s.strip_suffix('>')).unwrap_or(&inner);
    format!("<{}<{inner}>>", crate::env::short_type_name::<W>())
}
