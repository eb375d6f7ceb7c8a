use crate::{Result, Space, Value};

/// What a step of a [`VectorEnv`](super::VectorEnv) gives: a row for each sub-environment.
///
/// The caller owns them and hands them to each `reset_into` and `step_into`, which overwrite them.
/// [`VectorEnv::columns`](super::VectorEnv::columns) makes them; columns of another form, such as
/// `Columns::default()`, are made anew by the call that fills them.
#[derive(Clone, Debug, Default, PartialEq)]
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
}

impl Columns {
    /// Columns of `n` rows for observations of a space: zeros.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`](crate::Error::InvalidSpace) if there is no buffer for its elements.
    pub fn new(single_observation_space: &Space, n: usize) -> Result<Self> {
        let mut columns = Self::default();
        columns.prepare(single_observation_space, n)?;
        Ok(columns)
    }

    /// Makes the columns anew that do not have the form for `n` observations of a space, and leaves the
    /// others as they are: what implementations of `reset_into` and `step_into` begin with.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn prepare(&mut self, single_observation_space: &Space, n: usize) -> Result<()> {
        for column in [&mut self.observations, &mut self.final_observations] {
            if !single_observation_space.is_batch(column, n) {
                *column = single_observation_space.empty_batch(n)?;
            }
        }
        self.rewards.resize(n, 0.0);
        for column in [&mut self.terminated, &mut self.truncated, &mut self.has_final] {
            column.resize(n, false);
        }
        Ok(())
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
