//! Wrappers of vectors by name, to rebuild the stack that a spec describes.

use serde::Deserialize;
use serde_json::Value as Json;

use super::wrappers::{arguments, bound};
use crate::vector::{VectorEnv, wrappers::*};
use crate::wrappers::{self, Bound};
use crate::{BoxEnv, Error, Kwargs, Result, WrapperSpec};

/// Puts a wrapper around a vector, with the arguments in a spec.
pub type WrapVector = fn(Box<dyn VectorEnv>, &Kwargs) -> Result<Box<dyn VectorEnv>>;

/// A wrapper of vectors that specs can name. A crate with a wrapper of its own submits one at link time, and
/// then stacks with it can be rebuilt from JSON as well:
///
/// ```
/// use gym_core::registry::VectorWrapperRegistration;
/// use gym_core::vector::VectorEnv;
///
/// struct Effort {
///     envs: Box<dyn VectorEnv>,
/// }
///
/// impl gym_core::VectorWrapper for Effort {
///     fn inner(&self) -> &dyn VectorEnv {
///         &*self.envs
///     }
///
///     fn inner_mut(&mut self) -> &mut dyn VectorEnv {
///         &mut *self.envs
///     }
/// }
///
/// gym_core::inventory::submit! {
///     VectorWrapperRegistration { name: "my_envs/Effort", wrap: |envs, _kwargs| Ok(Box::new(Effort { envs })) }
/// }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct VectorWrapperRegistration {
    /// The name in [`WrapperSpec`].
    pub name: &'static str,
    /// Puts it around a vector, with the arguments in the spec.
    pub wrap: WrapVector,
}

inventory::collect!(VectorWrapperRegistration);

impl WrapperSpec {
    /// Puts the wrapper of this name around a vector.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a name that is not known or a bad argument, and whatever the wrapper
    /// refuses.
    pub fn wrap_vector(&self, envs: Box<dyn VectorEnv>) -> Result<Box<dyn VectorEnv>> {
        let known = || BUILT_IN.iter().chain(inventory::iter::<VectorWrapperRegistration>);
        match known().find(|wrapper| wrapper.name == self.name) {
            Some(wrapper) => (wrapper.wrap)(envs, &self.kwargs),
            None => {
                let names: Vec<_> = known().map(|wrapper| wrapper.name).collect();
                let reason = format!("unknown wrapper `{}`: known are {}", self.name, names.join(", "));
                Err(Error::argument("a vector's wrappers", reason))
            }
        }
    }
}

/// A table entry from a wrapper's name, its arguments (`Option` where they have defaults), and how it is made
/// of them.
macro_rules! wrapper {
    ($name:literal, |$envs:ident $(, $argument:ident: $type:ty)*| $new:expr) => {
        VectorWrapperRegistration {
            name: $name,
            wrap: |$envs, kwargs| {
                #[derive(Deserialize)]
                #[serde(deny_unknown_fields)]
                struct Arguments { $($argument: $type),* }
                let Arguments { $($argument),* } = arguments($name, kwargs)?;
                Ok(Box::new($new))
            },
        }
    };
}

const BUILT_IN: &[VectorWrapperRegistration] = &[
    wrapper!("RecordEpisodeStatistics", |envs, buffer_length: Option<usize>, stats_key: Option<String>| {
        RecordEpisodeStatistics::new(envs)
            .with_buffer_length(buffer_length.unwrap_or(100))?
            .with_stats_key(stats_key.unwrap_or_else(|| "episode".into()))
    }),
    wrapper!("ClipAction", |envs| ClipAction::new(envs)?),
    wrapper!("RescaleAction", |envs, min_action: Json, max_action: Json| {
        let space = envs.single_action_space();
        let [min, max] = [min_action, max_action].map(|json| Bound::from_json(&json, &space));
        RescaleAction::new(envs, min?, max?)?
    }),
    wrapper!("RescaleObservation", |envs, min_obs: Json, max_obs: Json| {
        let space = envs.single_observation_space();
        let [min, max] = [min_obs, max_obs].map(|json| Bound::from_json(&json, &space));
        RescaleObservation::new(envs, min?, max?)?
    }),
    wrapper!("NormalizeObservation", |envs, epsilon: Option<f64>, update_running_mean: Option<bool>| {
        let epsilon = epsilon.unwrap_or(wrappers::NormalizeObservation::<BoxEnv>::EPSILON);
        let mut envs = NormalizeObservation::new(envs)?.with_epsilon(epsilon)?;
        envs.update_running_mean(update_running_mean.unwrap_or(true));
        envs
    }),
    wrapper!("NormalizeReward", |envs,
                                 gamma: Option<f64>,
                                 epsilon: Option<f64>,
                                 update_running_mean: Option<bool>| {
        let gamma = gamma.unwrap_or(wrappers::NormalizeReward::<BoxEnv>::GAMMA);
        let epsilon = epsilon.unwrap_or(wrappers::NormalizeReward::<BoxEnv>::EPSILON);
        let mut envs = NormalizeReward::new(envs, gamma)?.with_epsilon(epsilon)?;
        envs.update_running_mean(update_running_mean.unwrap_or(true));
        envs
    }),
    wrapper!("ClipReward", |envs, min_reward: Option<Json>, max_reward: Option<Json>| {
        ClipReward::new(envs, bound("min_reward", min_reward)?, bound("max_reward", max_reward)?)?
    }),
];
