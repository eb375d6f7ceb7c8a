//! Dynamics as a table: Gymnasium's `P` and `initial_state_distrib`.
//!
//! A planner reads them instead of stepping an environment:
//!
//! ```
//! use gym_toytext::frozen_lake::{Config, FrozenLakeDynamics};
//! use gym_core::Dynamics;
//!
//! let lake = FrozenLakeDynamics::new(Config::default())?;
//! let p = lake.p();
//! let mut values = vec![0.0; p.states()];
//! for _ in 0..1000 {
//!     for state in 0..p.states() {
//!         let returns = (0..p.actions()).map(|action| {
//!             let outcomes = p.outcomes(state, action).iter();
//!             outcomes.map(|o| o.probability * (o.reward + if o.terminated { 0.0 } else { values[o.next] })).sum()
//!         });
//!         values[state] = returns.fold(f64::NEG_INFINITY, f64::max);
//!     }
//! }
//! assert!((values[0] - 14.0 / 17.0).abs() < 1e-9); // the best that can be done from the start
//! # Ok::<(), gym_core::Error>(())
//! ```

use std::sync::Arc;

use gym_core::{Error, Generator, Result};

/// One way in which an action can turn out: an entry of `P[state][action]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// How likely it is; those of one state and action sum to 1.
    pub probability: f64,
    /// The state that follows.
    pub next: usize,
    /// The reward of getting there.
    pub reward: f64,
    /// Whether the episode ends there.
    pub terminated: bool,
}

/// Gymnasium's `P`: the outcomes of each action in each state. A clone shares the numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    actions: usize,
    outcomes: Arc<[Outcome]>,
    /// Where in `outcomes` each row (a state and an action) begins, and where the last one ends.
    rows: Arc<[usize]>,
}

impl Table {
    /// A table whose rows `fill` appends, for each state each action in turn.
    pub(crate) fn build(
        states: usize,
        actions: usize,
        mut fill: impl FnMut(usize, usize, &mut Vec<Outcome>),
    ) -> Self {
        let mut outcomes = Vec::new();
        let mut rows = vec![0];
        for state in 0..states {
            for action in 0..actions {
                fill(state, action, &mut outcomes);
                rows.push(outcomes.len());
            }
        }
        Self { actions, outcomes: outcomes.into(), rows: rows.into() }
    }

    /// The number of states.
    pub fn states(&self) -> usize {
        (self.rows.len() - 1) / self.actions
    }

    /// The number of actions.
    pub fn actions(&self) -> usize {
        self.actions
    }

    /// The outcomes of an action in a state, `P[state][action]`; none if there is no such state or
    /// action.
    #[inline]
    pub fn outcomes(&self, state: usize, action: usize) -> &[Outcome] {
        if action >= self.actions {
            return &[];
        }
        let row = state.saturating_mul(self.actions).saturating_add(action);
        match self.rows.get(row..).unwrap_or_default() {
            [start, end, ..] => self.outcomes.get(*start..*end).unwrap_or_default(),
            _ => &[],
        }
    }

    /// Draws an outcome by Gymnasium's `categorical_sample`: the first at which the sum of
    /// probabilities exceeds `random()`, or the first of all where rounding leaves that sum short.
    #[inline]
    pub(crate) fn sample(&self, state: usize, action: usize, rng: &mut Generator) -> Result<Outcome> {
        let outcomes = self.outcomes(state, action);
        let Some(first) = outcomes.first() else { return Err(self.no_such_state(state)) };
        let r = rng.random();
        let mut sum = 0.0;
        let drawn = outcomes.iter().find(|outcome| {
            sum += outcome.probability;
            sum > r
        });
        Ok(*drawn.unwrap_or(first))
    }

    #[cold]
    fn no_such_state(&self, state: usize) -> Error {
        Error::custom(format!("there is no state {state}: the states are 0 to {}", self.states() - 1))
    }
}

/// Gymnasium's `initial_state_distrib`: how likely each state is at the start.
#[derive(Clone, Debug)]
pub(crate) struct Distribution {
    probabilities: Arc<[f64]>,
    /// The sums of the leading probabilities, as `np.cumsum` rounds them.
    cumulative: Arc<[f64]>,
}

impl Distribution {
    /// The same probability for each state where `possible` holds.
    pub(crate) fn uniform(states: usize, possible: impl Fn(usize) -> bool) -> Self {
        let count = (0..states).filter(|state| possible(*state)).count();
        let probabilities: Arc<[f64]> =
            (0..states).map(|state| if possible(state) { 1.0 / count as f64 } else { 0.0 }).collect();
        let mut sum = 0.0;
        let cumulative = probabilities
            .iter()
            .map(|probability| {
                sum += probability;
                sum
            })
            .collect();
        Self { probabilities, cumulative }
    }

    pub(crate) fn probabilities(&self) -> &[f64] {
        &self.probabilities
    }

    /// Draws a state by the rule of [`Table::sample`]. The sums never fall, so a binary search
    /// finds the index that Gymnasium's scan finds.
    pub(crate) fn sample(&self, rng: &mut Generator) -> usize {
        let r = rng.random();
        let state = self.cumulative.partition_point(|sum| *sum <= r);
        if state < self.cumulative.len() { state } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coin(probability: f64) -> Table {
        Table::build(2, 1, |state, _, row| {
            for next in 0..2 {
                row.push(Outcome { probability, next, reward: state as f64, terminated: false });
            }
        })
    }

    #[test]
    fn rows_are_found_by_state_and_action() {
        let table = coin(0.5);
        assert_eq!((table.states(), table.actions()), (2, 1));
        assert_eq!(table.outcomes(1, 0).len(), 2);
        assert!(table.outcomes(1, 0).iter().all(|outcome| outcome.reward == 1.0));
        assert!(table.outcomes(2, 0).is_empty() && table.outcomes(0, 1).is_empty());
        assert!(table.outcomes(usize::MAX, 0).is_empty());
    }

    #[test]
    fn a_state_outside_the_table_is_an_error() {
        let error = coin(0.5).sample(2, 0, &mut Generator::from(0)).unwrap_err();
        assert_eq!(error.to_string(), "there is no state 2: the states are 0 to 1");
    }

    /// `random()` of seed 42 begins 0.774, 0.439.
    #[test]
    fn the_first_sum_above_the_draw_is_chosen() {
        let rng = &mut Generator::from(42);
        assert_eq!([(); 2].map(|()| coin(0.5).sample(0, 0, rng).unwrap().next), [1, 0]);
        // both sums stay below the draw
        assert_eq!(coin(0.3).sample(0, 0, &mut Generator::from(42)).unwrap().next, 0);
    }

    #[test]
    fn the_binary_search_finds_what_the_scan_finds() {
        let distribution = Distribution::uniform(500, |state| state % 5 > 1);
        let (mut fast, mut slow) = (Generator::from(1), Generator::from(1));
        for _ in 0..1000 {
            assert_eq!(distribution.sample(&mut fast), slow.categorical(distribution.probabilities()));
        }
    }
}
