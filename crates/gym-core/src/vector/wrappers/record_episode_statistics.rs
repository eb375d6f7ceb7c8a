use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::reach;
use crate::clock::Instant;
use crate::vector::{Columns, Progress, VectorEnv, VectorReset, infos};
use crate::wrappers::{EpisodeStatistics, episode_buffer};
use crate::{Error, Result, Snapshot, Value, WrapperSpec};

/// Keeps the return, length and duration of each sub-environment's episodes.
///
/// For a step in which episodes ended, [`infos`](VectorEnvExt::infos) have an entry `episode` with the
/// columns `r` (return), `l` (length in steps) and `t` (seconds since the reset, to the microsecond), zero
/// where no episode ended, and the mask `_episode`. The last episodes are kept in
/// [`episodes`](Self::episodes). The entry belongs to the step that ended the episode in each
/// [`Autoreset`](crate::vector::Autoreset) mode, and stands beside `final_info`, not in it.
///
/// A reset with a mask starts the statistics of those sub-environments anew, and of no others.
/// (Gymnasium's loses them all.)
#[derive(Clone, Debug)]
pub struct RecordEpisodeStatistics<V = Box<dyn VectorEnv>> {
    envs: V,
    buffer_length: usize,
    stats_key: String,
    running: Vec<Running>,
    episode_count: u64,
    episodes: VecDeque<EpisodeStatistics>,
}

/// The episode of one sub-environment.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Running {
    /// Wall-clock time is no part of a snapshot.
    #[serde(skip, default = "Instant::now")]
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

reach!(RecordEpisodeStatistics);

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
        let mut episodes = episode_buffer(buffer_length)?;
        episodes.extend(self.episodes.into_iter().rev().take(buffer_length).rev());
        Ok(Self { buffer_length, episodes, ..self })
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

    /// Counts what the sub-environments that went on have done.
    fn record(&mut self, columns: &Columns) {
        for (index, running) in self.running.iter_mut().enumerate() {
            running.ended = None;
            match columns.progress.get(index) {
                None | Some(Progress::Unchanged) => continue,
                Some(Progress::Started) => {
                    *running = Running::new();
                    continue;
                }
                Some(Progress::Stepped) => {}
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
    }
}

impl<V: VectorEnv> crate::VectorWrapper for RecordEpisodeStatistics<V> {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let wrapper = WrapperSpec::new("RecordEpisodeStatistics");
        let wrapper = wrapper.arg("buffer_length", self.buffer_length);
        Some(wrapper.arg("stats_key", self.stats_key.as_str()))
    }

    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        columns.begin();
        let result = self.envs.reset_into(reset, columns);
        self.record(columns);
        result
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        columns.begin();
        let result = self.envs.step_into(actions, columns);
        self.record(columns);
        result
    }

    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        self.envs.info(index, visit);
        if let Some(episode) = self.ended(index) {
            visit(&self.stats_key, episode.to_value());
        }
    }

    fn column_infos(&self, visit: &mut dyn FnMut(&str, Value)) {
        self.envs.column_infos(visit);
        let ended = || self.running.iter().map(|running| running.ended);
        if ended().all(|episode| episode.is_none()) {
            return;
        }
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
        visit(&self.stats_key, Value::Dict(columns.into()));
        visit(&format!("_{}", self.stats_key), infos::flags(&mask));
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.envs.snapshot()?, &self.running, self.episode_count, &self.episodes))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (envs, running, count, mut episodes): (_, Vec<Running>, _, VecDeque<EpisodeStatistics>) =
            snapshot.get()?;
        if running.len() != self.running.len() {
            let [there, here] = [running.len(), self.running.len()];
            return Err(Error::Snapshot(format!("it is of {there} sub-environments, and here are {here}")));
        }
        let mut kept = episode_buffer(self.buffer_length)?;
        self.envs.restore(&envs)?;
        let surplus = episodes.len().saturating_sub(self.buffer_length);
        kept.extend(episodes.drain(surplus..));
        (self.running, self.episode_count, self.episodes) = (running, count, kept);
        Ok(())
    }
}
