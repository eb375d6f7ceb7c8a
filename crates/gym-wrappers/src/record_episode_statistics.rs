//! The return, length and duration of episodes.

use std::collections::VecDeque;

use gym_core::registry::WrapperConfig;
use gym_core::vector::parts::flags;
use gym_core::vector::{Columns, Progress, VectorReset};
use gym_core::{
    BoxEnv, Env, Error, Outcome, Reset, Result, Snapshot, Value, VectorEnv, VectorWrapper, Wrapper,
    WrapperSpec,
};
use serde::{Deserialize, Serialize};

use crate::clock::Instant;

/// Keeps the return, length and duration of each episode, of an environment or of each
/// sub-environment of a vector.
///
/// On the step that ends an episode, `info` has an entry `episode` (or another
/// [key](Config::stats_key)) with `r` (return), `l` (length in steps) and `t` (seconds since the
/// reset, to the microsecond). The last episodes are kept in [`episodes`](Self::episodes).
///
/// Around a vector, `infos` have these as columns, zero where no episode ended, and the mask
/// `_episode`. In each [`Autoreset`](gym_core::vector::Autoreset) mode the entry belongs to the step
/// that ended the episode, and is beside `final_info`, not in it. A reset with a mask restarts only
/// the statistics of those sub-environments. (Gymnasium's loses all.)
#[derive(Clone, Debug)]
pub struct RecordEpisodeStatistics<T = BoxEnv> {
    inner: T,
    config: Config,
    record: Record,
}

gym_core::arguments! {
    /// The arguments of [`RecordEpisodeStatistics`].
    pub struct Config {
        /// The number of last episodes to keep, at least 1.
        pub buffer_length: usize = 100,
        /// The key of the entry of `info`. Two of these wrappers need different keys.
        pub stats_key: String = "episode".into(),
    }
}

gym_core::register_wrapper!(
    "RecordEpisodeStatistics", "adds return, length and seconds of each episode to `info[\"episode\"]`", Config,
    env: RecordEpisodeStatistics::with_config, vector: RecordEpisodeStatistics::with_config
);

/// One finished episode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EpisodeStatistics {
    /// The sum of rewards.
    #[serde(rename = "r")]
    pub episode_return: f64,
    /// The number of steps.
    #[serde(rename = "l")]
    pub length: u64,
    /// Seconds from reset to the end.
    #[serde(rename = "t")]
    pub seconds: f64,
}

impl EpisodeStatistics {
    /// The entry of `info`.
    fn to_value(self) -> Value {
        let entries = [
            ("r", Value::Float(self.episode_return)),
            ("l", Value::Int(self.length as i64)),
            ("t", Value::Float(self.seconds)),
        ];
        Value::Dict(entries.map(|(key, value)| (key.to_owned(), value)).into())
    }
}

/// The content of a snapshot.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Record {
    /// The running episode of each environment; empty before the first reset.
    running: Vec<Running>,
    episode_count: u64,
    episodes: VecDeque<EpisodeStatistics>,
}

/// The running episode of one environment.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Running {
    /// Snapshots do not contain wall-clock time: see `without_time`.
    #[serde(skip, default = "Instant::now")]
    started: Instant,
    episode_return: f64,
    length: u64,
    /// The episode that ended in the last step, if one did.
    ended: Option<EpisodeStatistics>,
}

impl Running {
    fn new(ended: Option<EpisodeStatistics>) -> Self {
        Self {
            started: Instant::now(),
            episode_return: 0.0,
            length: 0,
            ended,
        }
    }
}

impl Record {
    /// Allocates memory for `n` environments and the buffered episodes, so that no step allocates.
    fn reserve(&mut self, n: usize, buffer_length: usize) -> Result<()> {
        if self.running.len() != n {
            self.running.resize_with(n, || Running::new(None));
        }
        let lacking = buffer_length.saturating_sub(self.episodes.len());
        self.episodes.try_reserve(lacking).map_err(|_| {
            Config::refuse(format!(
                "buffer_length = {buffer_length} episodes do not fit in memory"
            ))
        })
    }

    /// Counts a step of an environment, and stores the statistics of the episode at its end.
    fn step(&mut self, index: usize, reward: f64, done: bool, buffer_length: usize) {
        let Some(running) = self.running.get_mut(index) else {
            return;
        };
        running.episode_return += reward;
        // a snapshot may contain any number
        running.length = running.length.saturating_add(1);
        running.ended = None;
        if done {
            let seconds = running.started.elapsed().as_secs_f64();
            let ended = EpisodeStatistics {
                episode_return: running.episode_return,
                length: running.length,
                seconds: (seconds * 1e6).round() / 1e6,
            };
            running.ended = Some(ended);
            self.episode_count = self.episode_count.saturating_add(1);
            while self.episodes.len() >= buffer_length {
                self.episodes.pop_front();
            }
            self.episodes.push_back(ended);
        }
    }

    /// Counts a step of a vector's sub-environments.
    fn columns(&mut self, columns: &Columns, buffer_length: usize) {
        for index in 0..self.running.len() {
            match columns.progress.get(index) {
                None | Some(Progress::Unchanged) => self.running[index].ended = None,
                Some(Progress::Started) => self.running[index] = Running::new(None),
                Some(Progress::Stepped) => {
                    let done = columns.done(index);
                    self.step(index, columns.rewards[index], done, buffer_length);
                    if done {
                        self.running[index] = Running::new(self.running[index].ended);
                    }
                }
            }
        }
    }

    /// The record without wall-clock times, for a snapshot: equal episodes give equal bytes.
    fn without_time(&self) -> Self {
        let mut record = self.clone();
        let ended = record
            .running
            .iter_mut()
            .filter_map(|running| running.ended.as_mut());
        ended
            .chain(&mut record.episodes)
            .for_each(|episode| episode.seconds = 0.0);
        record
    }

    /// Reads a record of `n` environments, and the inner snapshot, from a snapshot.
    fn read(snapshot: &Snapshot, n: usize, buffer_length: usize) -> Result<(Snapshot, Self)> {
        let (inner, mut record): (_, Self) = snapshot.get()?;
        let there = record.running.len();
        if there != n && there != 0 {
            return Err(Error::Snapshot(format!(
                "it has {there} sub-environments, and this vector {n}"
            )));
        }
        let surplus = record.episodes.len().saturating_sub(buffer_length);
        record.episodes.drain(..surplus);
        record.reserve(there, buffer_length)?;
        Ok((inner, record))
    }
}

impl<T> RecordEpisodeStatistics<T> {
    /// Records the last 100 episodes of `inner`.
    pub fn new(inner: T) -> Self {
        Self {
            inner,
            config: Config::default(),
            record: Record::default(),
        }
    }

    /// Records the episodes of `inner`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a buffer length of 0, or one that does not fit in memory.
    pub fn with_config(inner: T, config: Config) -> Result<Self> {
        if config.buffer_length == 0 {
            return Err(Config::refuse("buffer_length is 0: it must be at least 1"));
        }
        let mut record = Record::default();
        record.reserve(0, config.buffer_length)?;
        Ok(Self {
            inner,
            config,
            record,
        })
    }

    /// The last finished episodes, oldest first.
    pub fn episodes(&self) -> impl ExactSizeIterator<Item = &EpisodeStatistics> {
        self.record.episodes.iter()
    }

    /// The number of episodes that have ended, including episodes no longer kept.
    pub fn episode_count(&self) -> u64 {
        self.record.episode_count
    }

    /// The episode of sub-environment `index` that ended in the last step, if one did.
    pub fn ended(&self, index: usize) -> Option<&EpisodeStatistics> {
        self.record.running.get(index)?.ended.as_ref()
    }
}

gym_core::inner!(impl RecordEpisodeStatistics<E>);

impl<E: Env> Wrapper for RecordEpisodeStatistics<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)?;
        self.record.reserve(1, self.config.buffer_length)?;
        self.record.running[0] = Running::new(None);
        Ok(())
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.inner.step_into(action, observation)?;
        self.record
            .step(0, outcome.reward, outcome.done(), self.config.buffer_length);
        Ok(outcome)
    }

    fn on_info(&self, visit: &mut dyn FnMut(&str, Value)) {
        self.inner.info(visit);
        if let Some(episode) = self.ended(0) {
            visit(&self.config.stats_key, episode.to_value());
        }
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.inner.snapshot()?, self.record.without_time()))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (inner, record) = Record::read(snapshot, 1, self.config.buffer_length)?;
        self.inner.restore(&inner)?;
        self.record = record;
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }
}

impl<V: VectorEnv> VectorWrapper for RecordEpisodeStatistics<V> {
    gym_core::inner!(dyn);

    fn on_reset(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        self.record
            .reserve(self.inner.num_envs(), self.config.buffer_length)?;
        columns.begin();
        let result = self.inner.reset_into(reset, columns);
        self.record.columns(columns, self.config.buffer_length);
        result
    }

    fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        columns.begin();
        let result = self.inner.step_into(actions, columns);
        self.record.columns(columns, self.config.buffer_length);
        result
    }

    fn on_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        self.inner.info(index, visit);
        if let Some(episode) = self.ended(index) {
            visit(&self.config.stats_key, episode.to_value());
        }
    }

    fn on_column_infos(&self, visit: &mut dyn FnMut(&str, Value)) {
        self.inner.column_infos(visit);
        let ended = || self.record.running.iter().map(|running| running.ended);
        if ended().all(|episode| episode.is_none()) {
            return;
        }
        let real = |of: fn(EpisodeStatistics) -> f64| {
            let column: Vec<f64> = ended().map(|episode| episode.map_or(0.0, of)).collect();
            Value::Array(column.into())
        };
        let lengths: Vec<i64> = ended()
            .map(|episode| episode.map_or(0, |e| e.length as i64))
            .collect();
        let columns = [
            ("r", real(|episode| episode.episode_return)),
            ("l", Value::Array(lengths.into())),
            ("t", real(|episode| episode.seconds)),
        ];
        let mask: Vec<bool> = ended().map(|episode| episode.is_some()).collect();
        let columns = columns.map(|(key, column)| (key.to_owned(), column));
        visit(&self.config.stats_key, Value::Dict(columns.into()));
        visit(&format!("_{}", self.config.stats_key), flags(&mask));
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.inner.snapshot()?, self.record.without_time()))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (inner, record) =
            Record::read(snapshot, self.inner.num_envs(), self.config.buffer_length)?;
        self.inner.restore(&inner)?;
        self.record = record;
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }
}
