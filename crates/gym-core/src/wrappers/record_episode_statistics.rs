use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::clock::Instant;
use crate::{BoxEnv, Env, Error, Outcome, Reset, Result, Snapshot, Value, WrapperSpec};

/// Keeps the return, length and duration of each episode.
///
/// On the step that ends an episode, [`info`](Env::info) has an entry `episode` (or another
/// [key](Self::with_stats_key)) with `r` (return),
/// `l` (length in steps) and `t` (seconds since the reset, to the microsecond). The last episodes
/// are kept in [`episodes`](Self::episodes).
#[derive(Clone, Debug)]
pub struct RecordEpisodeStatistics<E = BoxEnv> {
    env: E,
    buffer_length: usize,
    stats_key: String,
    record: Record,
    /// When the running episode began; wall-clock time is no part of a snapshot.
    started: Option<Instant>,
}

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

super::reach!(RecordEpisodeStatistics<E>);

impl EpisodeStatistics {
    /// The entry of `info`.
    pub(crate) fn to_value(self) -> Value {
        let entries = [
            ("r", Value::Float(self.episode_return)),
            ("l", Value::Int(self.length as i64)),
            ("t", Value::Float(self.seconds)),
        ];
        Value::Dict(entries.map(|(key, value)| (key.to_owned(), value)).into())
    }
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Record {
    episode_return: f64,
    length: u64,
    just_ended: bool,
    episode_count: u64,
    episodes: VecDeque<EpisodeStatistics>,
}

impl<E: Env> RecordEpisodeStatistics<E> {
    /// Records the last 100 episodes of `env`.
    pub fn new(env: E) -> Self {
        Self {
            env,
            buffer_length: 100,
            stats_key: "episode".into(),
            record: Record::default(),
            started: None,
        }
    }

    /// Records the last `buffer_length` episodes instead; of those recorded already, the last stay.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a length of 0, or one beyond the memory.
    pub fn with_buffer_length(self, buffer_length: usize) -> Result<Self> {
        let mut episodes = episode_buffer(buffer_length)?;
        let Self { record, .. } = &self;
        episodes.extend(record.episodes.iter().skip(record.episodes.len().saturating_sub(buffer_length)));
        Ok(Self { buffer_length, record: Record { episodes, ..self.record }, ..self })
    }

    /// Names the entry of `info`: Gymnasium's `stats_key`, for a stack with two of these wrappers.
    #[must_use]
    pub fn with_stats_key(self, stats_key: impl Into<String>) -> Self {
        Self { stats_key: stats_key.into(), ..self }
    }

    /// The last finished episodes, oldest first.
    pub fn episodes(&self) -> impl ExactSizeIterator<Item = &EpisodeStatistics> {
        self.record.episodes.iter()
    }

    /// How many episodes have ended, including those no longer kept.
    pub fn episode_count(&self) -> u64 {
        self.record.episode_count
    }
}

impl<E: Env> crate::Wrapper for RecordEpisodeStatistics<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)?;
        let record = &mut self.record;
        (record.episode_return, record.length, record.just_ended) = (0.0, 0, false);
        // so that the step that ends an episode does not have to grow the buffer
        if record.episodes.capacity() < self.buffer_length {
            let kept = std::mem::replace(&mut record.episodes, episode_buffer(self.buffer_length)?);
            record.episodes.extend(kept);
        }
        self.started = Some(Instant::now());
        Ok(())
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.env.step_into(action, observation)?;
        let record = &mut self.record;
        record.episode_return += outcome.reward;
        // a snapshot may hold any number
        record.length = record.length.saturating_add(1);
        record.just_ended = outcome.done();
        if record.just_ended {
            record.episode_count = record.episode_count.saturating_add(1);
            while record.episodes.len() >= self.buffer_length {
                record.episodes.pop_front();
            }
            let seconds = self.started.map_or(0.0, |started| started.elapsed().as_secs_f64());
            record.episodes.push_back(EpisodeStatistics {
                episode_return: record.episode_return,
                length: record.length,
                seconds: (seconds * 1e6).round() / 1e6,
            });
        }
        Ok(outcome)
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        self.env.info(visit);
        if self.record.just_ended
            && let Some(episode) = self.record.episodes.back()
        {
            visit(&self.stats_key, episode.to_value());
        }
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.env.snapshot()?, &self.record))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, mut record): (_, Record) = snapshot.get()?;
        self.env.restore(&env)?;
        let surplus = record.episodes.len().saturating_sub(self.buffer_length);
        record.episodes.drain(..surplus);
        (self.record, self.started) = (record, Some(Instant::now()));
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(
            WrapperSpec::new("RecordEpisodeStatistics")
                .arg("buffer_length", self.buffer_length)
                .arg("stats_key", self.stats_key.as_str()),
        )
    }
}

/// An empty buffer for so many episodes.
pub(crate) fn episode_buffer(buffer_length: usize) -> Result<VecDeque<EpisodeStatistics>> {
    let refuse = |reason: String| Err(Error::argument("RecordEpisodeStatistics", reason));
    if buffer_length == 0 {
        return refuse("buffer_length is 0: it must be at least 1".into());
    }
    let mut episodes = VecDeque::new();
    match episodes.try_reserve(buffer_length) {
        Ok(()) => Ok(episodes),
        Err(_) => refuse(format!("buffer_length is {buffer_length}: so many episodes do not fit in memory")),
    }
}
