//! The policies that commands can play.

use gym::{BoxEnv, Env, Result, Sampler, Value};

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum Policy {
    /// Actions sampled from the action space.
    Random,
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
    /// Plays an episode from `seed`; `watch` sees the environment after the reset and each step.
    pub(crate) fn play(
        self,
        env: &mut BoxEnv,
        seed: u64,
        mut watch: impl FnMut(&mut BoxEnv) -> Result<()>,
    ) -> Result<Episode> {
        let mut actions: Sampler = match self {
            Self::Random => env.action_sampler(seed)?,
        };
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
            let step = env.step(&actions.sample())?;
            episode.episode_return += step.reward;
            episode.length += 1;
            (episode.terminated, episode.truncated) = (step.terminated, step.truncated);
            (episode.last_reward, episode.last_observation) = (step.reward, step.observation);
            watch(env)?;
        }
        Ok(episode)
    }
}
