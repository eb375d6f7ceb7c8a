//! The state of an agent that moves from cell to cell, in CliffWalking and FrozenLake.

use gym_core::rng::Stream;
use gym_core::{Transition, Value};
use serde::{Deserialize, Serialize};

use crate::tabular::{Cell, Outcome, Table};

/// The agent's cell, and the last transition.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound(deserialize = "A: Deserialize<'de>"))]
pub struct State<A> {
    /// The cell, counted row by row from the top left.
    pub cell: usize,
    /// The last action; `None` at the start.
    #[serde(deserialize_with = "Option::deserialize")]
    pub last_action: Option<A>,
    /// The probability of the last transition; 1 at the start.
    pub probability: f64,
}

impl<A: Copy> State<A> {
    /// The start of an episode in a cell.
    pub(crate) fn start(cell: usize) -> Self {
        Self {
            cell,
            last_action: None,
            probability: 1.0,
        }
    }

    /// Returns the next state and outcome of `action`, whose number in `p` is `index`; `None` if
    /// the state does not exist.
    #[inline(always)]
    pub(crate) fn advance(
        &self,
        p: &Table,
        action: A,
        index: usize,
        rng: &mut impl Stream,
    ) -> Option<Transition<Self>> {
        let Outcome {
            probability,
            next,
            reward,
            terminated,
        } = p.sample(self.cell, index, rng)?;
        let state = Self {
            cell: next,
            last_action: Some(action),
            probability,
        };
        Some(Transition {
            state,
            reward,
            terminated,
        })
    }

    /// Passes the entry of `info` to `visit`.
    pub(crate) fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        // Gymnasium's `reset` returns the probability as an integer, which decides the type of a
        // vector's infos
        let probability = match self.last_action {
            None => Value::Int(1),
            Some(_) => Value::Float(self.probability),
        };
        visit("prob", probability);
    }

    /// The stored form in a native vector.
    #[inline(always)]
    pub(crate) fn pack(&self) -> Cell {
        Cell {
            state: self.cell as u32,
            probability: self.probability,
        }
    }

    /// Restores a state from `cell`, which does not contain the last action.
    #[inline(always)]
    pub(crate) fn unpack(cell: Cell, last_action: Option<A>) -> Self {
        Self {
            cell: cell.state as usize,
            last_action,
            probability: cell.probability,
        }
    }
}
