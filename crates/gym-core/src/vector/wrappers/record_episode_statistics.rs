use std::collections::VecDeque;
use std::time::Instant;

use crate::vector::{Autoreset, Columns, VectorEnv, VectorReset, infos};
use crate::wrappers::{EpisodeStatistics, episode_buffer};
use crate::{Info, Result, Value};

/// Keeps the return, length and duration of each sub-environment's episodes.
///
/// For a step in which episodes ended, [`infos`](VectorEnv::infos) have an entry `episode` with the
/// columns `r` (return), `l` (length in steps) and `t` (seconds since the reset, to the microsecond), zero
/// where no episode ended, and the mask `_episode`. The last episodes are kept in
/// [`episodes`](Self::episodes).
///
/// A reset with a mask starts the statistics of those sub-environments anew, and of no others.
/// (Gymnasium's loses them all.)
#[derive(Clone, Debug)]
pub struct RecordEpisodeStatistics<V> {
    envs: V,
    buffer_length: usize,
    stats_key: String,
    running: Vec<Running>,
    episode_count: u64,
    episodes: VecDeque<EpisodeStatistics>,
}

/// The episode of one sub-environment.
#[derive(Clone, Debug)]
struct Running {
    started: Instant,
    episode_return: f64,
    length: u64,
    /// The episode that the last step ended.
    ended: Option<EpisodeStatistics>,
}

impl Running {
    fn new() -> Self {
        Self { started: Instant::now(), episode_return: 0.0, length: 0, ended: None }
    }
}

impl<V: VectorEnv> RecordEpisodeStatistics<V> {
    /// Records the last 100 episodes of `envs`.
    pub fn new(envs: V) -> Self {
        let running = vec![Running::new(); envs.num_envs()];
        let buffer_length = 100;
        let episodes = VecDeque::with_capacity(buffer_length);
        Self { envs, buffer_length, stats_key: "episode".into(), running, episode_count: 0, episodes }
    }

    /// Records the last `buffer_length` episodes instead.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) for a length of 0, or one beyond the memory.
    pub fn with_buffer_length(self, buffer_length: usize) -> Result<Self> {
        Ok(Self { buffer_length, episodes: episode_buffer(buffer_length)?, ..self })
    }

    /// Names the entry of the infos: Gymnasium's `stats_key`.
    #[must_use]
    pub fn with_stats_key(self, stats_key: impl Into<String>) -> Self {
        Self { stats_key: stats_key.into(), ..self }
    }

    /// The last finished episodes of all sub-environments, oldest first.
    pub fn episodes(&self) -> impl ExactSizeIterator<Item = &EpisodeStatistics> {
        self.episodes.iter()
    }

    /// How many episodes have ended, including those no longer kept.
    pub fn episode_count(&self) -> u64 {
        self.episode_count
    }

    /// The episode of a sub-environment that the last step ended, if it did.
    pub fn ended(&self, index: usize) -> Option<&EpisodeStatistics> {
        self.running.get(index)?.ended.as_ref()
    }

    /// The vector within.
    pub fn into_inner(self) -> V {
        self.envs
    }
}

impl<V: VectorEnv> VectorEnv for RecordEpisodeStatistics<V> {
    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        self.envs.reset_into(reset, columns)?;
        for (index, running) in self.running.iter_mut().enumerate() {
            running.ended = None;
            if reset.selects(index) {
                *running = Running::new();
            }
        }
        Ok(())
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.envs.step_into(actions, columns)?;
        let next_step = self.autoreset() == Autoreset::NextStep;
        for (index, running) in self.running.iter_mut().enumerate() {
            let has_ended = running.ended.take().is_some();
            if has_ended && next_step {
                *running = Running::new(); // this step was the reset
                continue;
            }
            running.episode_return += columns.rewards[index];
            running.length += 1;
            if columns.done(index) {
                let seconds = running.started.elapsed().as_secs_f64();
                let ended = EpisodeStatistics {
                    episode_return: running.episode_return,
                    length: running.length,
                    seconds: (seconds * 1e6).round() / 1e6,
                };
                *running = Running { ended: Some(ended), ..Running::new() };
                if self.episodes.len() == self.buffer_length {
                    self.episodes.pop_front();
                }
                self.episodes.push_back(ended);
                self.episode_count += 1;
            }
        }
        Ok(())
    }

    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        self.envs.info(index, visit);
        if let Some(episode) = self.ended(index) {
            visit(&self.stats_key, episode.to_value());
        }
    }

    fn infos(&self, columns: &Columns) -> Info {
        let mut infos = self.envs.infos(columns);
        let ended = || self.running.iter().map(|running| running.ended);
        if ended().any(|episode| episode.is_some()) {
            let real = |of: fn(EpisodeStatistics) -> f64| {
                let column: Vec<f64> = ended().map(|episode| episode.map_or(0.0, of)).collect();
                Value::Array(column.into())
            };
            let lengths: Vec<i64> = ended().map(|episode| episode.map_or(0, |e| e.length as i64)).collect();
            let columns = [
                ("r", real(|episode| episode.episode_return)),
                ("l", Value::Array(lengths.into())),
                ("t", real(|episode| episode.seconds)),
            ];
            let mask: Vec<bool> = ended().map(|episode| episode.is_some()).collect();
            let columns = columns.map(|(key, column)| (key.to_owned(), column));
            infos.insert(self.stats_key.clone(), Value::Dict(columns.into()));
            infos.insert(format!("_{}", self.stats_key), infos::flags(&mask));
        }
        infos
    }

    crate::forward_vector!(
        envs: num_envs, single_observation_space, observation_space, single_action_space, autoreset, final_info, visit_envs, render,
        metadata, spec, describe, close
    );
}
