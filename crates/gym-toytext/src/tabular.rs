//! Dynamics as a table: Gymnasium's `P` and `initial_state_distrib`.
//!
//! A planner reads them instead of stepping an environment:
//!
//! ```
//! use gym_toytext::frozen_lake::{Config, FrozenLakeDynamics};
//! use gym_core::Task;
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

use gym_core::rng::Stream;
use gym_core::{Error, Result};
use gym_native::{LANES, Packed};
use serde_json::{Value as Json, json};

use crate::distribution::Distribution;

/// An exemption of tables from gym-conform's check `info-constant`.
pub(crate) const WHOLE_AT_RESET: (&str, &str) = (
    "info-constant",
    "`prob` is the whole number 1 after a reset and a float after a step, as in Gymnasium",
);

/// One possible outcome of an action: an entry of `P[state][action]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The probability; the probabilities of one state and action sum to 1.
    pub probability: f64,
    /// The next state.
    pub next: usize,
    /// The reward of the transition.
    pub reward: f64,
    /// Whether the transition ends the episode.
    pub terminated: bool,
}

/// Gymnasium's `P`: the outcomes of each action in each state. A clone shares its data.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    actions: usize,
    outcomes: Arc<[Outcome]>,
    /// For each row (a state and an action): the start of its outcomes; and the end of the last
    /// row.
    rows: Arc<[usize]>,
    lottery: Arc<Lottery>,
}

impl Table {
    /// Builds a table. `fill` appends the outcomes of each row: for each state, each action in
    /// turn.
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
        let lottery = Lottery::new(&outcomes, &rows).into();
        Self {
            actions,
            outcomes: outcomes.into(),
            rows: rows.into(),
            lottery,
        }
    }

    /// Returns the table in the form of [`Inspect::table`](gym_core::Inspect::table).
    pub(crate) fn to_json(&self, initial: &Distribution) -> Json {
        let row = |state, action| -> Vec<_> {
            let outcomes = self.outcomes(state, action).iter();
            outcomes
                .map(|o| json!([o.probability, o.next, o.reward, o.terminated]))
                .collect()
        };
        let actions = |state| -> Vec<_> { (0..self.actions).map(|a| row(state, a)).collect() };
        let p: Vec<_> = (0..self.states()).map(actions).collect();
        json!({"P": p, "initial_state_distrib": initial.probabilities()})
    }

    /// Reads a table and a distribution of initial states from the form of
    /// [`to_json`](Self::to_json). `table` must have as many states and actions as `self`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`], which names the faulty part of `table`.
    pub(crate) fn replaced(&self, table: &Json) -> Result<(Self, Distribution)> {
        let refuse = |reason: String| Error::argument("table", reason);
        type Row = Vec<(f64, usize, f64, bool)>;
        let p: Vec<Vec<Row>> = serde_json::from_value(table["P"].clone()).map_err(|error| {
            refuse(format!(
                "`P` must be a list of states, each a list of actions, each a list of outcomes \
                 [probability, next state, reward, terminated]: {error}"
            ))
        })?;
        let states = self.states();
        if p.len() != states {
            return Err(refuse(format!(
                "`P` has {} states, and the task {states}",
                p.len()
            )));
        }
        for (state, actions) in p.iter().enumerate() {
            if actions.len() != self.actions {
                return Err(refuse(format!(
                    "P[{state}] has {} actions, and the task {}",
                    actions.len(),
                    self.actions
                )));
            }
            for (action, row) in actions.iter().enumerate() {
                let place = format!("P[{state}][{action}]");
                if row.is_empty() {
                    return Err(refuse(format!("{place} has no outcome")));
                }
                let bad = |(probability, next, reward, _): &&(f64, usize, f64, bool)| {
                    !(0.0..=1.0).contains(probability) || *next >= states || !reward.is_finite()
                };
                if let Some(outcome) = row.iter().find(bad) {
                    return Err(refuse(format!(
                        "{place}: {outcome:?} needs a probability from 0 to 1, a next state below \
                         {states} and a finite reward"
                    )));
                }
            }
        }
        let initial: Vec<f64> = serde_json::from_value(table["initial_state_distrib"].clone())
            .map_err(|error| {
                refuse(format!(
                    "`initial_state_distrib` must be a list of numbers: {error}"
                ))
            })?;
        if initial.len() != states || !initial.iter().all(|p| (0.0..=1.0).contains(p)) {
            return Err(refuse(format!(
                "`initial_state_distrib` needs {states} probabilities from 0 to 1"
            )));
        }
        let table = Self::build(states, self.actions, |state, action, row| {
            let outcomes = p[state][action].iter();
            row.extend(
                outcomes.map(|&(probability, next, reward, terminated)| Outcome {
                    probability,
                    next,
                    reward,
                    terminated,
                }),
            );
        });
        Ok((table, Distribution::new(initial.into())))
    }

    /// Returns the number of states.
    pub fn states(&self) -> usize {
        (self.rows.len() - 1) / self.actions
    }

    /// Returns the number of actions.
    pub fn actions(&self) -> usize {
        self.actions
    }

    /// Returns the outcomes of an action in a state, `P[state][action]`; empty if the state or
    /// action does not exist.
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

    /// Draws an outcome by Gymnasium's `categorical_sample`: the first outcome at which the sum of
    /// probabilities exceeds `random()`, or outcome 0 if rounding keeps all sums below `random()`.
    /// `None`, without a draw, if the state does not exist.
    #[inline(always)]
    pub(crate) fn sample(
        &self,
        state: usize,
        action: usize,
        rng: &mut impl Stream,
    ) -> Option<Outcome> {
        // a state beyond the limit could wrap around to an existing row
        if state >= MAX_STATES {
            return None;
        }
        self.lottery.draw(state * self.actions + action, rng)
    }

    #[cold]
    pub(crate) fn no_such_state(&self, state: usize) -> Error {
        Error::custom(format!(
            "there is no state {state}: the states are 0 to {}",
            self.states() - 1
        ))
    }
}

/// A table in the form that steps read: a few bytes per row, so that it fits the first-level cache.
#[derive(Debug, PartialEq)]
struct Lottery {
    rows: Rows,
    /// The distinct outcomes, without their next states.
    kinds: Vec<Outcome>,
}

#[derive(Debug, PartialEq)]
enum Rows {
    /// Each row has a single outcome, whatever the drawn number.
    Certain(Vec<Ticket>),
    Random(Vec<FewOutcomes>),
    /// The outcomes of each row, in full. For a table with more outcomes in a row than
    /// [`FewOutcomes`] can hold, or with more kinds of outcomes than [`Ticket`] can number.
    Listed(Vec<Vec<Outcome>>),
}

/// The outcomes of one action in one state: at most [`MAX_OUTCOMES`].
#[derive(Debug, PartialEq)]
struct FewOutcomes {
    /// The partial sums of the probabilities; infinite after the last outcome.
    sums: [f64; MAX_OUTCOMES],
    /// The outcomes, and after the last outcome the first one again, for a drawn number above all
    /// sums.
    tickets: [Ticket; MAX_OUTCOMES + 1],
}

const MAX_OUTCOMES: usize = 3;

/// An outcome: its index in `kinds` in the lowest byte, the next state above.
type Ticket = u32;

/// The largest number of outcomes that differ in more than the next state: their index is a byte.
const MAX_KINDS: usize = 256;

/// The largest number of states.
pub(crate) const MAX_STATES: usize = 1 << 24;

impl Lottery {
    fn new(outcomes: &[Outcome], rows: &[usize]) -> Self {
        let row_of = |bounds: &[usize]| &outcomes[bounds[0]..bounds[1]];
        let kind = |outcome: &Outcome| Outcome {
            next: 0,
            ..*outcome
        };
        let mut kinds = Vec::new();
        for kind in outcomes.iter().map(kind) {
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
            if kinds.len() > MAX_KINDS {
                break;
            }
        }
        let fits = |bounds: &[usize]| row_of(bounds).len() <= MAX_OUTCOMES;
        if kinds.len() > MAX_KINDS || !rows.windows(2).all(fits) {
            let rows = rows.windows(2).map(|bounds| row_of(bounds).to_vec());
            return Self {
                rows: Rows::Listed(rows.collect()),
                kinds: Vec::new(),
            };
        }
        let ticket = |outcome: &Outcome| {
            debug_assert!(outcome.next < MAX_STATES, "it does not fit a ticket");
            let index = kinds.iter().position(|known| *known == kind(outcome));
            (outcome.next << 8 | index.unwrap_or_default()) as Ticket
        };
        let rows = || rows.windows(2).map(row_of);
        let rows = if rows().all(|row| row.len() == 1) {
            Rows::Certain(outcomes.iter().map(ticket).collect())
        } else {
            let row = |outcomes: &[Outcome]| {
                debug_assert!(
                    (1..=MAX_OUTCOMES).contains(&outcomes.len()),
                    "a row holds up to three"
                );
                let mut row = FewOutcomes {
                    sums: [f64::INFINITY; MAX_OUTCOMES],
                    tickets: [ticket(&outcomes[0]); MAX_OUTCOMES + 1],
                };
                let mut sum = 0.0;
                for (i, outcome) in outcomes.iter().enumerate() {
                    sum += outcome.probability;
                    row.sums[i] = sum;
                    row.tickets[i] = ticket(outcome);
                }
                row
            };
            Rows::Random(rows().map(row).collect())
        };
        Self { rows, kinds }
    }

    #[inline(always)]
    fn draw(&self, row: usize, rng: &mut impl Stream) -> Option<Outcome> {
        let ticket = match &self.rows {
            Rows::Certain(tickets) => {
                let ticket = tickets.get(row)?;
                rng.skip();
                *ticket
            }
            Rows::Random(rows) => {
                let row = rows.get(row)?;
                let r = rng.random();
                // without a branch, which the CPU could not predict
                let passed = row
                    .sums
                    .iter()
                    .fold(0, |passed, sum| passed + usize::from(*sum <= r));
                row.tickets[passed]
            }
            Rows::Listed(rows) => {
                let row = rows.get(row)?;
                let r = rng.random();
                let mut sum = 0.0;
                let drawn = row.iter().find(|outcome| {
                    sum += outcome.probability;
                    sum > r
                });
                return drawn.or(row.first()).copied();
            }
        };
        let kind = self.kinds.get((ticket & 0xff) as usize)?;
        Some(Outcome {
            next: (ticket >> 8) as usize,
            ..*kind
        })
    }
}

/// The stored form of a state in a native vector.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    pub(crate) state: u32,
    pub(crate) probability: f64,
}

/// The [`Cell`]s of a block of environments.
#[derive(Clone, Debug)]
pub struct Cells {
    states: [u32; LANES],
    probabilities: [f64; LANES],
}

impl Packed for Cell {
    type Block = Cells;

    fn splat(self) -> Cells {
        Cells {
            states: [self.state; LANES],
            probabilities: [self.probability; LANES],
        }
    }

    #[inline(always)]
    fn get(cells: &Cells, lane: usize) -> Self {
        Self {
            state: cells.states[lane],
            probability: cells.probabilities[lane],
        }
    }

    #[inline(always)]
    fn set(self, cells: &mut Cells, lane: usize) {
        cells.states[lane] = self.state;
        cells.probabilities[lane] = self.probability;
    }

    fn put(self, bytes: &mut Vec<u8>) -> Result<()> {
        bytes.extend(self.state.to_le_bytes());
        bytes.extend(self.probability.to_le_bytes());
        Ok(())
    }

    fn take(bytes: &mut &[u8]) -> Option<Self> {
        let (state, rest) = bytes.split_first_chunk()?;
        let (probability, rest) = rest.split_first_chunk()?;
        *bytes = rest;
        let probability = f64::from_le_bytes(*probability);
        Some(Self {
            state: u32::from_le_bytes(*state),
            probability,
        })
    }
}

#[cfg(test)]
mod tests {
    use gym_core::Generator;

    use super::*;

    fn coin(probability: f64) -> Table {
        Table::build(2, 1, |state, _, row| {
            for next in 0..2 {
                row.push(Outcome {
                    probability,
                    next,
                    reward: state as f64,
                    terminated: false,
                });
            }
        })
    }

    #[test]
    fn rows_are_found_by_state_and_action() {
        let table = coin(0.5);
        assert_eq!((table.states(), table.actions()), (2, 1));
        assert_eq!(table.outcomes(1, 0).len(), 2);
        assert!(
            table
                .outcomes(1, 0)
                .iter()
                .all(|outcome| outcome.reward == 1.0)
        );
        assert!(table.outcomes(2, 0).is_empty() && table.outcomes(0, 1).is_empty());
        assert!(table.outcomes(usize::MAX, 0).is_empty());
    }

    #[test]
    fn a_state_outside_the_table_is_an_error() {
        let (table, mut rng) = (coin(0.5), Generator::from(0));
        assert_eq!(table.sample(2, 0, &mut rng), None);
        assert_eq!(rng, Generator::from(0), "nothing was drawn");
        assert_eq!(
            table.no_such_state(2).to_string(),
            "there is no state 2: the states are 0 to 1"
        );
    }

    /// with seed 42, `random()` first returns 0.774 and 0.439
    #[test]
    fn the_first_sum_above_the_draw_is_chosen() {
        let rng = &mut Generator::from(42);
        assert_eq!(
            [(); 2].map(|()| coin(0.5).sample(0, 0, rng).unwrap().next),
            [1, 0]
        );
        // both sums are below the draw
        assert_eq!(
            coin(0.3)
                .sample(0, 0, &mut Generator::from(42))
                .unwrap()
                .next,
            0
        );
    }

    /// Tests numbers of outcomes that a [`FewOutcomes`] can hold, and a larger number.
    #[test]
    fn a_draw_above_all_sums_gives_the_first_outcome() {
        for n in [2, 3, 4, 9] {
            let table = Table::build(n, 1, |_, _, row| {
                row.extend((0..n).map(|next| Outcome {
                    probability: 0.1,
                    next,
                    reward: 0.0,
                    terminated: false,
                }));
            });
            // with seed 42, `random()` first returns 0.774 and 0.439
            let rng = &mut Generator::from(42);
            let drawn = [(); 2].map(|()| table.sample(1, 0, rng).unwrap().next);
            assert_eq!(drawn, if n == 9 { [7, 4] } else { [0, 0] }, "{n}");
        }
    }

    /// A table that is replaced may have probabilities that do not sum to 1.
    #[test]
    fn a_table_is_replaced_by_one_of_its_size() {
        let (table, initial) = (coin(0.5), Distribution::uniform(2, |_| true));
        let json = table.to_json(&initial);
        let (same, starts) = table.replaced(&json).unwrap();
        assert_eq!(
            (same, starts.probabilities()),
            (table.clone(), &[0.5; 2][..])
        );
        for (place, value, fits) in [
            ("/P/1/0/0/1", json!(1), true),
            ("/P/1/0/0/1", json!(2), false),
            ("/P/0/0/1/0", json!(1.0), true),
            ("/P/0/0/1/0", json!(1.1), false),
            ("/P/0/0/1/0", json!(-0.1), false),
            ("/P/0/0", json!([]), false),
            ("/P/0", json!([]), false),
            ("/P", json!([]), false),
            ("/initial_state_distrib", json!([0.0, 1.0]), true),
            ("/initial_state_distrib", json!([1.0]), false),
            ("/initial_state_distrib", json!([0.5, 0.5, 0.0]), false),
            ("/initial_state_distrib", json!([1.5, 0.0]), false),
        ] {
            let mut other = json.clone();
            *other.pointer_mut(place).unwrap() = value.clone();
            assert_eq!(table.replaced(&other).is_ok(), fits, "{place}: {value}");
        }
    }
}
