//! Wrappers by name, to rebuild the stack that a spec describes.

use serde::{Deserialize, de::DeserializeOwned};
use serde_json::Value as Json;

use crate::wrappers::*;
use crate::{BoxEnv, DType, Env, Error, Kwargs, Result, WrapperSpec};

/// A wrapper that specs can name. A crate with a wrapper of its own submits one at link time, and then
/// stacks with it can be rebuilt from JSON as well:
///
/// ```
/// use gym_core::registry::WrapperRegistration;
/// use gym_core::{BoxEnv, wrappers::Autoreset};
///
/// gym_core::inventory::submit! {
///     WrapperRegistration { name: "my_envs/Endless", wrap: |env, _kwargs| Ok(BoxEnv::new(Autoreset::new(env))) }
/// }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct WrapperRegistration {
    /// The name in [`WrapperSpec`].
    pub name: &'static str,
    /// Puts it around an environment, with the arguments in the spec.
    pub wrap: fn(BoxEnv, &Kwargs) -> Result<BoxEnv>,
}

inventory::collect!(WrapperRegistration);

impl WrapperSpec {
    /// Puts the wrapper of this name around an environment.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a name that is not known or a bad argument, and whatever the
    /// wrapper refuses.
    pub fn wrap(&self, env: BoxEnv) -> Result<BoxEnv> {
        let mut known = BUILT_IN.iter().chain(inventory::iter::<WrapperRegistration>);
        match known.find(|wrapper| wrapper.name == self.name) {
            Some(wrapper) => (wrapper.wrap)(env, &self.kwargs),
            None => {
                let names = BUILT_IN.iter().chain(inventory::iter::<WrapperRegistration>);
                let names: Vec<_> = names.map(|wrapper| wrapper.name).collect();
                let reason = format!("unknown wrapper `{}`: known are {}", self.name, names.join(", "));
                Err(Error::argument("additional_wrappers", reason))
            }
        }
    }
}

/// A table entry from a wrapper's name, its arguments (`Option` where they have defaults), and how it
/// is made of them.
macro_rules! wrapper {
    ($name:literal, |$env:ident $(, $argument:ident: $type:ty)*| $new:expr) => {
        WrapperRegistration {
            name: $name,
            wrap: |$env, kwargs| {
                #[derive(Deserialize)]
                #[serde(deny_unknown_fields)]
                struct Arguments { $($argument: $type),* }
                let Arguments { $($argument),* } = arguments($name, kwargs)?;
                Ok(BoxEnv::new($new))
            },
        }
    };
}

pub(super) fn arguments<T: DeserializeOwned>(name: &str, kwargs: &Kwargs) -> Result<T> {
    serde_json::from_value(Json::Object(kwargs.clone()))
        .map_err(|error| Error::argument(name, error.to_string()))
}

/// One number, or the two ends of a range.
#[derive(Deserialize)]
#[serde(untagged)]
enum Duration {
    Steps(u32),
    Range(u32, u32),
}

/// A number, or infinity as a string.
pub(super) fn bound(name: &str, json: Option<Json>) -> Result<Option<f64>> {
    match json {
        None | Some(Json::Null) => Ok(None),
        Some(Json::String(text)) if text == "inf" => Ok(Some(f64::INFINITY)),
        Some(Json::String(text)) if text == "-inf" => Ok(Some(f64::NEG_INFINITY)),
        Some(json) => match json.as_f64() {
            Some(x) => Ok(Some(x)),
            None => Err(Error::argument(name, format!("{json} is not a number"))),
        },
    }
}

const BUILT_IN: &[WrapperRegistration] = &[
    wrapper!("TimeLimit", |env, max_episode_steps: u32| TimeLimit::new(env, max_episode_steps)?),
    wrapper!("Autoreset", |env| Autoreset::new(env)),
    wrapper!("PassiveEnvChecker", |env| PassiveEnvChecker::new(env)),
    wrapper!("OrderEnforcing", |env| OrderEnforcing::new(env)),
    wrapper!("RenderCollection", |env| RenderCollection::new(env)),
    wrapper!("RecordEpisodeStatistics", |env, buffer_length: Option<usize>, stats_key: Option<String>| {
        RecordEpisodeStatistics::new(env)
            .with_buffer_length(buffer_length.unwrap_or(100))?
            .with_stats_key(stats_key.unwrap_or_else(|| "episode".into()))
    }),
    wrapper!("FilterObservation", |env, filter_keys: FilterKeys| FilterObservation::new(env, filter_keys)?),
    wrapper!("FlattenObservation", |env| FlattenObservation::new(env)?),
    wrapper!("GrayscaleObservation", |env, keep_dim: Option<bool>| {
        GrayscaleObservation::new(env, keep_dim.unwrap_or(false))?
    }),
    wrapper!("ResizeObservation", |env, shape: [usize; 2]| ResizeObservation::new(env, shape[0], shape[1])?),
    wrapper!("ReshapeObservation", |env, shape: Vec<usize>| ReshapeObservation::new(env, shape)?),
    wrapper!("RescaleObservation", |env, min_obs: Json, max_obs: Json| {
        let space = env.observation_space();
        let [min, max] = [min_obs, max_obs].map(|json| Bound::from_json(&json, &space));
        RescaleObservation::new(env, min?, max?)?
    }),
    wrapper!("DtypeObservation", |env, dtype: DType| DtypeObservation::new(env, dtype)?),
    wrapper!("AddRenderObservation", |env,
                                      render_only: Option<bool>,
                                      render_key: Option<String>,
                                      obs_key: Option<String>| {
        AddRenderObservation::build(
            env,
            render_only.unwrap_or(true),
            render_key.as_deref().unwrap_or(AddRenderObservation::<BoxEnv>::RENDER_KEY),
            obs_key.as_deref().unwrap_or(AddRenderObservation::<BoxEnv>::OBS_KEY),
        )?
    }),
    wrapper!("DiscretizeObservation", |env, bins: Bins, multidiscrete: Option<bool>| {
        DiscretizeObservation::new(env, bins, multidiscrete.unwrap_or(false))?
    }),
    wrapper!("DelayObservation", |env, delay: usize| DelayObservation::new(env, delay)?),
    wrapper!("TimeAwareObservation", |env,
                                      flatten: Option<bool>,
                                      normalize_time: Option<bool>,
                                      dict_time_key: Option<String>,
                                      max_timesteps: Option<u32>| {
        let (flatten, normalize) = (flatten.unwrap_or(true), normalize_time.unwrap_or(false));
        TimeAwareObservation::build_with(env, flatten, normalize, dict_time_key, max_timesteps)?
    }),
    wrapper!("FrameStackObservation", |env, stack_size: usize, padding_type: Option<Json>| {
        let padding = match padding_type {
            None => Padding::Reset,
            Some(json) if json == "reset" => Padding::Reset,
            Some(json) if json == "zero" => Padding::Zero,
            Some(json) => Padding::Custom(env.observation_space().from_json(&json)?),
        };
        FrameStackObservation::new(env, stack_size)?.with_padding(padding)?
    }),
    wrapper!("NormalizeObservation", |env, epsilon: Option<f64>, update_running_mean: Option<bool>| {
        let default = NormalizeObservation::<BoxEnv>::EPSILON;
        let mut env = NormalizeObservation::new(env)?.with_epsilon(epsilon.unwrap_or(default))?;
        env.update_running_mean(update_running_mean.unwrap_or(true));
        env
    }),
    wrapper!("MaxAndSkipObservation", |env, skip: Option<u32>| {
        MaxAndSkipObservation::new(env, skip.unwrap_or(4))?
    }),
    wrapper!("ClipAction", |env| ClipAction::new(env)?),
    wrapper!("RescaleAction", |env, min_action: Json, max_action: Json| {
        let space = env.action_space();
        let [min, max] = [min_action, max_action].map(|json| Bound::from_json(&json, &space));
        RescaleAction::new(env, min?, max?)?
    }),
    wrapper!("DiscretizeAction", |env, bins: Bins, multidiscrete: Option<bool>| {
        DiscretizeAction::new(env, bins, multidiscrete.unwrap_or(false))?
    }),
    wrapper!("StickyAction", |env,
                              repeat_action_probability: f64,
                              repeat_action_duration: Option<Duration>| {
        let (low, high) = match repeat_action_duration {
            None => (1, 1),
            Some(Duration::Steps(steps)) => (steps, steps),
            Some(Duration::Range(low, high)) => (low, high),
        };
        StickyAction::new(env, repeat_action_probability)?.with_duration(low..=high)?
    }),
    wrapper!("RepeatAction", |env, num_repeats: u32| RepeatAction::new(env, num_repeats)?),
    wrapper!("ClipReward", |env, min_reward: Option<Json>, max_reward: Option<Json>| {
        ClipReward::new(env, bound("min_reward", min_reward)?, bound("max_reward", max_reward)?)?
    }),
    wrapper!("NormalizeReward", |env,
                                 gamma: Option<f64>,
                                 epsilon: Option<f64>,
                                 update_running_mean: Option<bool>| {
        let (gamma_default, epsilon_default) =
            (NormalizeReward::<BoxEnv>::GAMMA, NormalizeReward::<BoxEnv>::EPSILON);
        let mut env = NormalizeReward::new(env, gamma.unwrap_or(gamma_default))?
            .with_epsilon(epsilon.unwrap_or(epsilon_default))?;
        env.update_running_mean(update_running_mean.unwrap_or(true));
        env
    }),
    wrapper!("AddWhiteNoise", |env,
                               probability_of_noise_per_pixel: f64,
                               is_noise_grayscale: Option<bool>| {
        let is_grayscale = is_noise_grayscale.unwrap_or(false);
        AddWhiteNoise::new(env, probability_of_noise_per_pixel, is_grayscale)?
    }),
    wrapper!("ObstructView", |env,
                              obstructed_pixels_ratio: f64,
                              obstruction_width: u32,
                              is_noise_grayscale: Option<bool>| {
        let is_grayscale = is_noise_grayscale.unwrap_or(false);
        ObstructView::new(env, obstructed_pixels_ratio, obstruction_width, is_grayscale)?
    }),
];
