//! The policies that commands can play.

use clap::ValueEnum;
use gym::policy::Controller;
use gym::{BoxEnv, Env, EnvExt, Error, Result, Value, registry};
use serde::{Serialize, Serializer};

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Policy {
    /// Actions sampled from the action space.
    Random,
    /// The policy of the environment's registration: rules, or a trained network.
    // (Gymnasium's name for the good policies of Box2D)
    #[value(alias = "heuristic")]
    Good,
}

/// The result of an episode.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Episode {
    pub(crate) seed: u64,
    #[serde(rename = "return", serialize_with = "number")]
    pub(crate) episode_return: f64,
    pub(crate) length: u64,
    pub(crate) terminated: bool,
    pub(crate) truncated: bool,
    #[serde(serialize_with = "number")]
    pub(crate) last_reward: f64,
    #[serde(serialize_with = "plain")]
    pub(crate) last_observation: Value,
}

/// Serializes a value as JSON, without its type.
fn plain<S: Serializer>(value: &Value, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    value.to_json().serialize(serializer)
}

/// Serializes a number as JSON; infinities and NaN are texts, as in an observation.
fn number<S: Serializer>(x: &f64, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    plain(&Value::Float(*x), serializer)
}

impl Policy {
    /// Returns the good policy of an environment, if the registration has a good policy for the
    /// environment's arguments.
    pub(crate) fn good(env: &BoxEnv) -> Result<Option<Controller>> {
        let Some(spec) = env.spec() else {
            return Ok(None);
        };
        registry::find(&spec.id)?
            .page
            .policy
            .map_or(Ok(None), |policy| policy.controller(env))
    }

    /// Returns the good policy if the environment has one for its arguments, else the random one.
    pub(crate) fn best(env: &BoxEnv) -> Result<Self> {
        let good = Self::good(env)?;
        Ok(good.map_or(Self::Random, |_| Self::Good))
    }

    /// Returns the controller for an episode with the seed `seed`.
    fn controller(self, env: &BoxEnv, seed: u64) -> Result<Controller> {
        match self {
            Self::Random => {
                let mut actions = env.action_sampler(seed)?;
                Ok(Box::new(move |_, _| Some(actions.sample())))
            }
            Self::Good => Self::good(env)?.ok_or_else(|| {
                Error::argument(
                    "--policy",
                    format!(
                        "{} has no good policy: play it at random",
                        env.spec().map_or_else(|| env.to_string(), |spec| spec.id)
                    ),
                )
            }),
        }
    }

    /// Returns the policy's name on the command line.
    pub(crate) fn name(self) -> String {
        self.to_possible_value()
            .map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// Plays an episode with the seed `seed`. Calls `watch` with the environment after the reset
    /// and after each step.
    pub(crate) fn play(
        self,
        env: &mut BoxEnv,
        seed: u64,
        mut watch: impl FnMut(&mut BoxEnv) -> Result<()>,
    ) -> Result<Episode> {
        let mut act = self.controller(env, seed)?;
        let mut episode = Episode {
            seed,
            episode_return: 0.0,
            length: 0,
            terminated: false,
            truncated: false,
            last_reward: 0.0,
            last_observation: env.reset(seed)?,
        };
        watch(env)?;
        while !(episode.terminated || episode.truncated) {
            let action = act(env, &episode.last_observation).ok_or_else(|| {
                let seen = &episode.last_observation;
                Error::Contract(format!("{seen} is not an observation of this environment"))
            })?;
            let step = env.step(&action)?;
            episode.episode_return += step.reward;
            episode.length += 1;
            (episode.terminated, episode.truncated) = (step.terminated, step.truncated);
            (episode.last_reward, episode.last_observation) = (step.reward, step.observation);
            watch(env)?;
        }
        Ok(episode)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_result_keeps_numbers_that_json_lacks() {
        let episode = Episode {
            seed: 7,
            episode_return: f64::INFINITY,
            length: 2,
            terminated: true,
            truncated: false,
            last_reward: f64::NEG_INFINITY,
            last_observation: Value::from([0.5, f64::NAN]),
        };
        let expected = json!({
            "seed": 7,
            "return": "inf",
            "length": 2,
            "terminated": true,
            "truncated": false,
            "last_reward": "-inf",
            "last_observation": [0.5, "NaN"],
        });
        assert_eq!(serde_json::to_value(&episode).unwrap(), expected);
        let finite = Episode {
            episode_return: 1.5,
            last_reward: 1.0,
            ..episode
        };
        let json = serde_json::to_value(&finite).unwrap();
        assert_eq!(
            (&json["return"], &json["last_reward"]),
            (&json!(1.5), &json!(1.0))
        );
    }
}
