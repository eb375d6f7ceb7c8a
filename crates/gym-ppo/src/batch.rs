//! The batch of transitions that one update learns from.

use candle_core::Tensor;

/// Transitions, one per row, in any order.
pub(crate) struct Batch {
    pub(crate) observations: Tensor,
    pub(crate) actions: Tensor,
    pub(crate) log_probabilities: Tensor,
    pub(crate) advantages: Tensor,
    /// The sum of advantage and value: the target of the value network.
    pub(crate) returns: Tensor,
}

impl Batch {
    pub(crate) fn len(&self) -> usize {
        self.log_probabilities.elem_count()
    }

    pub(crate) fn select(&self, indices: &Tensor) -> candle_core::Result<Self> {
        self.map(|tensor| tensor.index_select(indices, 0))
    }

    /// Returns the `len` rows from row `start` on.
    pub(crate) fn narrow(&self, start: usize, len: usize) -> candle_core::Result<Self> {
        self.map(|tensor| tensor.narrow(0, start, len))
    }

    fn map(
        &self,
        select: impl Fn(&Tensor) -> candle_core::Result<Tensor>,
    ) -> candle_core::Result<Self> {
        Ok(Self {
            observations: select(&self.observations)?,
            actions: select(&self.actions)?,
            log_probabilities: select(&self.log_probabilities)?,
            advantages: select(&self.advantages)?,
            returns: select(&self.returns)?,
        })
    }
}
