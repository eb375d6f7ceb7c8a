//! Wrappers of vectors by name, for traces.

use serde::Deserialize;
use serde_json::Value as Json;

use super::wrappers::{arguments, bound};
use crate::vector::{VectorEnv, wrappers::*};
use crate::wrappers::{self, Bound};
use crate::{BoxEnv, Error, Result, WrapperSpec};

impl WrapperSpec {
    /// Puts the wrapper of this name around a vector.
    pub(crate) fn wrap_vector(&self, envs: Box<dyn VectorEnv>) -> Result<Box<dyn VectorEnv>> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct NoArguments {}

        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Normalize {
            gamma: Option<f64>,
            epsilon: Option<f64>,
        }

        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Statistics {
            buffer_length: Option<usize>,
            stats_key: Option<String>,
        }

        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Bounds {
            #[serde(alias = "min_obs", alias = "min_action", alias = "min_reward")]
            min: Option<Json>,
            #[serde(alias = "max_obs", alias = "max_action", alias = "max_reward")]
            max: Option<Json>,
        }

        let name = self.name.as_str();
        Ok(match name {
            "RecordEpisodeStatistics" => {
                let Statistics { buffer_length, stats_key } = arguments(name, &self.kwargs)?;
                let envs =
                    RecordEpisodeStatistics::new(envs).with_buffer_length(buffer_length.unwrap_or(100))?;
                Box::new(envs.with_stats_key(stats_key.unwrap_or_else(|| "episode".into())))
            }
            "ClipAction" => {
                arguments::<NoArguments>(name, &self.kwargs)?;
                Box::new(ClipAction::new(envs)?)
            }
            "NormalizeObservation" => {
                let Normalize { epsilon, .. } = arguments(name, &self.kwargs)?;
                let epsilon = epsilon.unwrap_or(wrappers::NormalizeObservation::<BoxEnv>::EPSILON);
                Box::new(NormalizeObservation::new(envs)?.with_epsilon(epsilon)?)
            }
            "NormalizeReward" => {
                let Normalize { gamma, epsilon } = arguments(name, &self.kwargs)?;
                let gamma = gamma.unwrap_or(wrappers::NormalizeReward::<BoxEnv>::GAMMA);
                let epsilon = epsilon.unwrap_or(wrappers::NormalizeReward::<BoxEnv>::EPSILON);
                Box::new(NormalizeReward::new(envs, gamma)?.with_epsilon(epsilon)?)
            }
            "ClipReward" => {
                let Bounds { min, max } = arguments(name, &self.kwargs)?;
                Box::new(ClipReward::new(envs, bound("min_reward", min)?, bound("max_reward", max)?)?)
            }
            "RescaleAction" | "RescaleObservation" => {
                let is_action = name == "RescaleAction";
                let Bounds { min, max } = arguments(name, &self.kwargs)?;
                let space =
                    if is_action { envs.single_action_space() } else { envs.single_observation_space() };
                let [min, max] = [min, max].map(|json| Bound::from_json(&json.unwrap_or_default(), &space));
                match is_action {
                    true => Box::new(RescaleAction::new(envs, min?, max?)?),
                    false => Box::new(RescaleObservation::new(envs, min?, max?)?),
                }
            }
            _ => return Err(Error::argument("a vector's wrappers", format!("unknown wrapper `{name}`"))),
        })
    }
}
