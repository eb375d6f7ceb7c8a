use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::size;
use crate::spaces::Space;
use crate::value::{Result, Value};

/// The effect of a call of `reset_into` or `step_into` on a sub-environment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Progress {
    /// Neither reset nor step: a mask left the sub-environment out, or its call failed. Its row has
    /// a reward of 0, no flag set, and its last observation.
    #[default]
    Unchanged,
    /// The sub-environment began an episode: a reset, or the step after the end of an episode with
    /// [`Autoreset::NextStep`](super::Autoreset::NextStep), whose action was ignored. Do not train
    /// on such a transition: it crosses an episode boundary.
    Started,
    /// The sub-environment took the action. With
    /// [`Autoreset::SameStep`](super::Autoreset::SameStep), it has also begun the next episode if
    /// [`Columns::has_final`] is set.
    Stepped,
}

/// The result of a step of a [`VectorEnv`](super::VectorEnv): a row for each sub-environment.
///
/// The caller owns the columns; `reset_into` and `step_into` overwrite them.
/// [`VectorEnvExt::columns`](super::VectorEnvExt::columns) makes them. A call replaces columns of
/// another form, such as `Columns::default()`.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Columns {
    /// The observations, as one element of the batched observation space: for a `Box` an array of
    /// shape `[n, ..]`, for a `Discrete` one of shape `[n]`, for a `Tuple` or `Dict` these for each
    /// member.
    pub observations: Value,
    /// The reward of each sub-environment's step.
    pub rewards: Vec<f64>,
    /// Whether the task has ended, for each sub-environment.
    pub terminated: Vec<bool>,
    /// Whether something outside the task, such as a time limit, ended the episode.
    pub truncated: Vec<bool>,
    /// The last observations of episodes that ended and were reset in this step
    /// ([`Autoreset::SameStep`](super::Autoreset::SameStep)), in the form of `observations`. The
    /// other rows are meaningless.
    pub final_observations: Value,
    /// Whether each row of `final_observations` is set.
    pub has_final: Vec<bool>,
    /// The effect of the last call on each sub-environment. After [`begin`](Self::begin) and an
    /// `Err` it shows which have stepped nevertheless.
    pub progress: Vec<Progress>,
}

impl Columns {
    /// Columns of `n` rows for observations of a space: zeros.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`](crate::Error::InvalidSpace) if the space has no buffers, and
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) for more than fits in memory.
    pub fn new(single_observation_space: &Space, n: usize) -> Result<Self> {
        let mut columns = Self::default();
        columns.prepare(single_observation_space, n)?;
        Ok(columns)
    }

    /// Sets `progress` to unchanged. A wrapper calls this before the inner vector fills the
    /// columns, so that after a refused call no row appears stepped.
    pub fn begin(&mut self) {
        self.progress.fill(Progress::Unchanged);
    }

    /// Replaces the columns that do not have the form for `n` observations of a space, and keeps
    /// the others. Implementations of `reset_into` and `step_into` call it once nothing can be
    /// refused any more.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new).
    pub fn prepare(&mut self, single_observation_space: &Space, n: usize) -> Result<()> {
        for column in [&mut self.observations, &mut self.final_observations] {
            if !single_observation_space.is_batch(column, n) {
                size::check_rows(n, single_observation_space)?;
                *column = single_observation_space.empty_batch(n)?;
            }
        }
        self.rewards.resize(n, 0.0);
        for column in [
            &mut self.terminated,
            &mut self.truncated,
            &mut self.has_final,
        ] {
            column.resize(n, false);
        }
        self.progress.resize(n, Progress::Unchanged);
        Ok(())
    }

    /// Overwrites the rows from `to` with rows of other columns, for observations of the same
    /// space.
    pub(super) fn copy_rows(
        &mut self,
        space: &Space,
        to: usize,
        from: &Self,
        rows: Range<usize>,
    ) -> Result<()> {
        let into = to..to + rows.len();
        self.rewards[into.clone()].copy_from_slice(&from.rewards[rows.clone()]);
        self.terminated[into.clone()].copy_from_slice(&from.terminated[rows.clone()]);
        self.truncated[into.clone()].copy_from_slice(&from.truncated[rows.clone()]);
        self.has_final[into.clone()].copy_from_slice(&from.has_final[rows.clone()]);
        self.progress[into.clone()].copy_from_slice(&from.progress[rows.clone()]);
        space.copy_rows(&from.observations, rows.clone(), &mut self.observations, to)?;
        for (row, to) in rows.zip(into).filter(|(row, _)| from.has_final[*row]) {
            space.copy_rows(
                &from.final_observations,
                row..row + 1,
                &mut self.final_observations,
                to,
            )?;
        }
        Ok(())
    }

    /// Whether the last call changed any sub-environment.
    pub fn any_progress(&self) -> bool {
        self.progress
            .iter()
            .any(|progress| *progress != Progress::Unchanged)
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.rewards.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.rewards.is_empty()
    }

    /// Whether an episode of a sub-environment has ended in this step; `false` beyond the last row.
    pub fn done(&self, index: usize) -> bool {
        let at = |flags: &[bool]| flags.get(index).copied().unwrap_or(false);
        at(&self.terminated) || at(&self.truncated)
    }
}
