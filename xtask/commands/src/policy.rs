//! The policies that commands can play.

use clap::ValueEnum;
use gym::{BoxEnv, EnvExt, Error, Result, Value};

#[cfg(feature = "families")]
use crate::heuristic::controller;
use crate::trained;

/// Chooses the action for an observation; `None` for what is no observation of the environment.
pub(crate) type Controller = Box<dyn FnMut(&BoxEnv, &Value) -> Option<Value>>;

/// There are heuristics for the families of this workspace alone.
#[cfg(not(feature = "families"))]
fn controller(_: &BoxEnv) -> Option<Controller> {
    None
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Policy {
    /// Actions sampled from the action space.
    Random,
    /// A simple good policy: rules by hand, or the best policy of a transition table.
    Heuristic,
    /// A network that `gym-ppo` trained, from `docs/policies`.
    Trained,
}

/// One episode, summed up.
#[derive(Clone, Debug, serde::Serialize)]
pub(crate) struct Episode {
    pub(crate) seed: u64,
    #[serde(rename = "return")]
    pub(crate) episode_return: f64,
    pub(crate) length: u64,
    pub(crate) terminated: bool,
    pub(crate) truncated: bool,
    pub(crate) last_reward: f64,
    pub(crate) last_observation: Value,
}

impl Policy {
    /// The heuristic, for an environment that has one, or else a trained policy.
    #[cfg(feature = "families")]
    pub(crate) fn good(env: &BoxEnv) -> Result<Option<Self>> {
        if crate::heuristic::controller(env).is_some() {
            return Ok(Some(Self::Heuristic));
        }
        Ok(trained::controller(env)?.map(|_| Self::Trained))
    }

    /// What acts in an episode from `seed`.
    fn controller(self, env: &BoxEnv, seed: u64) -> Result<Controller> {
        match self {
            Self::Random => {
                let mut actions = env.action_sampler(seed)?;
                Ok(Box::new(move |_, _| Some(actions.sample())))
            }
            Self::Heuristic => controller(env).ok_or_else(|| {
                Error::argument("--policy", format!("{env} has no heuristic: play it at random"))
            }),
            Self::Trained => trained::controller(env)?.ok_or_else(|| {
                Error::argument("--policy", format!("no policy for {env} is stored: play it at random"))
            }),
        }
    }

    /// Its name on the command line.
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// Plays an episode from `seed`; `watch` sees the environment after the reset and each step.
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
