//! The policies that commands can play.

use clap::ValueEnum;
use gym::box2d::{BipedalWalker, LunarLander, bipedal_walker, lunar_lander};
use gym::{BoxEnv, Element, Env, Error, Result, Sampler, Space, Value};

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Policy {
    /// Actions sampled from the action space.
    Random,
    /// Gymnasium's own controllers, of LunarLander and BipedalWalker.
    Heuristic,
}

/// A policy at work in one episode.
enum Actor {
    Random(Box<Sampler>),
    LunarLander { continuous: bool },
    BipedalWalker(bipedal_walker::Heuristic),
}

impl Actor {
    fn new(policy: Policy, env: &BoxEnv, seed: u64) -> Result<Self> {
        let no_heuristic =
            || Error::argument("--policy", format!("{env} has no heuristic: play it at random"));
        match policy {
            Policy::Random => Ok(Self::Random(env.action_sampler(seed)?.into())),
            Policy::Heuristic if env.unwrapped::<LunarLander>().is_some() => {
                Ok(Self::LunarLander { continuous: !matches!(env.action_space(), Space::Discrete(_)) })
            }
            Policy::Heuristic if env.unwrapped::<BipedalWalker>().is_some() => {
                Ok(Self::BipedalWalker(bipedal_walker::Heuristic::default()))
            }
            Policy::Heuristic => Err(no_heuristic()),
        }
    }

    fn act(&mut self, observation: &Value) -> Result<Value> {
        let foreign = || Error::Contract(format!("{observation} is not an observation of this environment"));
        match self {
            Self::Random(actions) => Ok(actions.sample()),
            Self::LunarLander { continuous } => {
                let heuristic = |seen: &_| lunar_lander::heuristic(seen, *continuous).to_value();
                Element::with(observation, heuristic).ok_or_else(foreign)
            }
            Self::BipedalWalker(heuristic) => {
                Element::with(observation, |seen| heuristic.act(seen).to_value()).ok_or_else(foreign)
            }
        }
    }
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
        let mut actor = Actor::new(self, env, seed)?;
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
            let step = env.step(&actor.act(&episode.last_observation)?)?;
            episode.episode_return += step.reward;
            episode.length += 1;
            (episode.terminated, episode.truncated) = (step.terminated, step.truncated);
            (episode.last_reward, episode.last_observation) = (step.reward, step.observation);
            watch(env)?;
        }
        Ok(episode)
    }
}
