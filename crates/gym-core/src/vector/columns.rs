use serde::{Deserialize, Serialize};

use super::size;
use crate::{Result, Space, Value};

/// What a call of `reset_into` or `step_into` did with a sub-environment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Progress {
    /// Nothing: a mask left it out, or its reset or step failed. Its row has a reward of 0 and no flag
    /// set, and the observation is the last one it gave.
    #[default]
    Unchanged,
    /// It began an episode: a reset, or the step after the end of an episode with
    /// [`Autoreset::NextStep`](super::Autoreset::NextStep), whose action was ignored. Do not train on
    /// such a transition: it crosses an episode boundary.
    Started,
    /// It took the action. With [`Autoreset::SameStep`](super::Autoreset::SameStep) it has begun the
    /// next episode as well where [`Columns::has_final`] is set.
    Stepped,
}

/// What a step of a [`VectorEnv`](super::VectorEnv) gives: a row for each sub-environment.
///
/// The caller owns the columns and hands them to each `reset_into` and `step_into`, which overwrite
/// them. [`VectorEnvExt::columns`](super::VectorEnvExt::columns) makes them. A call that gets columns of another
/// form, such as `Columns::default()`, replaces them.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Columns {
    /// The observations, as one element of the batched observation space: for a `Box` an array of shape
    /// `[n, ..]`, for a `Discrete` one of shape `[n]`, for a `Tuple` or `Dict` these for each member.
    pub observations: Value,
    /// The reward of each sub-environment's step.
    pub rewards: Vec<f64>,
    /// Where the task has reached an end of its own.
    pub terminated: Vec<bool>,
    /// Where the episode was cut off from outside, as by a time limit.
    pub truncated: Vec<bool>,
    /// In the form of `observations`: the last observations of the episodes that have ended in this
    /// step and have been reset in it, as [`Autoreset::SameStep`](super::Autoreset::SameStep) does. The
    /// other rows mean nothing.
    pub final_observations: Value,
    /// Which rows of `final_observations` count.
    pub has_final: Vec<bool>,
    /// What the call that filled the columns did with each sub-environment. After
    /// [`begin`](Self::begin) and an `Err` it tells which of them have taken their step nevertheless.
    pub progress: Vec<Progress>,
}

impl Columns {
    /// Columns of `n` rows for observations of a space: zeros.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`](crate::Error::InvalidSpace) if there is no buffer for its elements, and
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) for more than memory holds.
    pub fn new(single_observation_space: &Space, n: usize) -> Result<Self> {
        let mut columns = Self::default();
        columns.prepare(single_observation_space, n)?;
        Ok(columns)
    }

    /// Notes in `progress` that nothing has happened yet. A wrapper calls this before the vector within
    /// fills the columns: where that call is refused, no row then looks as if it had been stepped.
    pub fn begin(&mut self) {
        self.progress.fill(Progress::Unchanged);
    }

    /// Replaces the columns that do not have the form for `n` observations of a space, and leaves the
    /// others as they are: what implementations of `reset_into` and `step_into` call once nothing can be
    /// refused any more.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn prepare(&mut self, single_observation_space: &Space, n: usize) -> Result<()> {
        for column in [&mut self.observations, &mut self.final_observations] {
            if !single_observation_space.is_batch(column, n) {
                size::check_rows(n, single_observation_space)?;
                *column = single_observation_space.empty_batch(n)?;
            }
        }
        self.rewards.resize(n, 0.0);
        for column in [&mut self.terminated, &mut self.truncated, &mut self.has_final] {
            column.resize(n, false);
        }
        self.progress.resize(n, Progress::Unchanged);
        Ok(())
    }

    /// Whether the last call did something with any sub-environment.
    pub fn any_progress(&self) -> bool {
        self.progress.iter().any(|progress| *progress != Progress::Unchanged)
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.rewards.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rewards.is_empty()
    }

    /// Whether an episode of a sub-environment has ended in this step; `false` beyond the last row.
    pub fn done(&self, index: usize) -> bool {
        let at = |flags: &[bool]| flags.get(index).copied().unwrap_or(false);
        at(&self.terminated) || at(&self.truncated)
    }
}
