//! Taxi: fetch a passenger at one of four stands and drop them off at another.
//!
//! | | |
//! |---|---|
//! | observation | `((row * 5 + column) * 5 + passenger) * 4 + destination`, where the stands are red 0, green 1, yellow 2, blue 3, and a passenger aboard is 4; see [`encode`]; `Discrete(500)` |
//! | action | [`Action`]: south, north, east, west, pick up, drop off; `Discrete(6)` |
//! | dynamics | walls and the border stop a move; see [`Config::is_rainy`] and [`Config::fickle_passenger`] for chance |
//! | reward | -1 per step; 20 for a drop-off at the destination, -10 for an illegal pick-up or drop-off |
//! | start | any cell; the passenger waits at one stand with another as destination, all uniform |
//! | end | terminated with the drop-off at the destination |
//! | limit | 200 steps |
//! | info | `prob`: the probability of the outcome; `action_mask`: 1 for each action that changes the state, see [`action_mask`] |
//!
//! Versions: v4 added all arguments (in Gymnasium 1.2, v3 had two of them, with faults); v3, which
//! Gymnasium has removed, behaves as in 0.29 and takes none.
//!
//! After Dietterich, "Hierarchical Reinforcement Learning with the MAXQ Value Function
//! Decomposition" (JAIR 13, 2000). Source: Gymnasium 1.4.0, `envs/toy_text/taxi.py`.

mod city;
mod draw;

use gym_core::canvas::Canvas;
use gym_core::keys::json;
use gym_core::math::Real;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::rng::{Stream, WordStream};
use gym_core::{
    Array, Dynamics, Error, Generator, Keys, Names, Policy, Registration, Reset, Result, Space,
    Stateful, Task, Transition, Value,
};
use gym_native::{Many, Native};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::distribution::Distribution;
use crate::planning;
use crate::tabular::{Cell, Outcome, Table};
use city::{IN_TAXI, STANDS, STATES, drive, sides};
pub use city::{action_mask, decode, encode};

/// The environment.
pub type Taxi = Stateful<TaxiDynamics>;

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    pub struct Config {
        /// Whether an unblocked move can drift to the left or right of its heading.
        #[versions = 4..]
        pub is_rainy: bool,
        /// Whether a passenger may change the destination once, at the first move with them aboard.
        #[versions = 4..]
        pub fickle_passenger: bool,
        /// In rain, the probability of moving straight; left and right share the rest.
        #[versions = 4..]
        pub rainy_probability: f64 = 0.8,
        /// The probability that a fickle passenger changes the destination.
        #[versions = 4..]
        pub fickle_probability: f64 = 0.3,
    }
}

gym_core::discrete! {
    /// An action of the driver.
    #[derive(Serialize, Deserialize)]
    pub enum Action {
        /// One row down.
        South,
        /// One row up.
        North,
        /// One column to the right.
        East,
        /// One column to the left.
        West,
        /// Lets the passenger in.
        Pickup,
        /// Lets the passenger out.
        Dropoff,
    }
}

/// Taxi and passenger, and the last transition.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Taxi, passenger and destination as one number; see [`decode`].
    pub encoded: usize,
    /// Whether the passenger will change the destination at the first move with them aboard.
    pub fickle_step: bool,
    /// The last action; `None` at the start.
    #[serde(deserialize_with = "Option::deserialize")]
    pub last_action: Option<Action>,
    /// The direction of the last move, in which the taxi points; south at the start.
    pub heading: Action,
    /// The probability of the last transition; 1 at the start.
    pub probability: f64,
}

/// The pure functions of the task.
#[derive(Clone, Debug)]
pub struct TaxiDynamics {
    config: Config,
    p: Table,
    initial: Distribution,
}

impl TaxiDynamics {
    /// Returns the transition table, Gymnasium's `P`. It does not contain a fickle passenger's
    /// changes of the destination.
    pub fn p(&self) -> &Table {
        &self.p
    }

    /// The probability of each state at the start, Gymnasium's `initial_state_distrib`.
    pub fn initial_state_distribution(&self) -> &[f64] {
        self.initial.probabilities()
    }
}

impl TaxiDynamics {
    /// Returns the next state and outcome; `None` if the state does not exist.
    #[inline(always)]
    fn advance(
        &self,
        state: &State,
        action: Action,
        rng: &mut impl Stream,
    ) -> Option<Transition<State>> {
        let Outcome {
            probability,
            next,
            reward,
            terminated,
        } = self.p.sample(state.encoded, action as usize, rng)?;
        let heading = if matches!(action, Action::Pickup | Action::Dropoff) {
            state.heading
        } else {
            action
        };
        let changed = if state.fickle_step {
            change_of_mind(state.encoded, next, rng)
        } else {
            None
        };
        let state = State {
            encoded: changed.unwrap_or(next),
            fickle_step: state.fickle_step && changed.is_none(),
            last_action: Some(action),
            heading,
            probability,
        };
        Some(Transition {
            state,
            reward,
            terminated,
        })
    }
}

/// Returns the state with another destination (Gymnasium's `fickle_passenger`); `None` if the step
/// did not move the taxi with the passenger from one cell to the next.
fn change_of_mind(before: usize, after: usize, rng: &mut impl Stream) -> Option<usize> {
    let (row, col, passenger, destination) = decode(before);
    let (next_row, next_col, next_passenger, _) = decode(after);
    (passenger == IN_TAXI && (row, col) != (next_row, next_col)).then(|| {
        let other = rng.lend(|rng| rng.choice(STANDS.len() - 1));
        encode(
            next_row,
            next_col,
            next_passenger,
            other + usize::from(other >= destination),
        )
    })
}

impl Task for TaxiDynamics {
    type Config = Config;
    type State = State;
    type Observation = usize;
    type Action = Action;

    const NAME: &'static str = "Taxi";
    const INFO: bool = true;

    fn new(config: Config) -> Result<Self> {
        for (name, value) in [
            ("rainy_probability", config.rainy_probability),
            ("fickle_probability", config.fickle_probability),
        ] {
            if !(0.0..=1.0).contains(&value) {
                let reason = format!("{name} is {value}: a probability is between 0 and 1");
                return Err(Error::argument(Self::NAME, reason));
            }
        }
        let ahead = config.rainy_probability;
        let aside = (1.0 - ahead) / 2.0;
        let p = Table::build(STATES, Action::ALL.len(), |state, action, outcomes| {
            let (row, col, passenger, destination) = decode(state);
            let mut push = |probability, (row, col), passenger, reward, terminated| {
                let next = encode(row, col, passenger, destination);
                outcomes.push(Outcome {
                    probability,
                    next,
                    reward,
                    terminated,
                });
            };
            let here = (row, col);
            let stand = STANDS.iter().position(|stand| *stand == here);
            match (Action::ALL[action], stand) {
                (Action::Pickup, Some(stand)) if stand == passenger => {
                    push(1.0, here, IN_TAXI, -1.0, false);
                }
                (Action::Dropoff, Some(stand)) if passenger == IN_TAXI && stand == destination => {
                    push(1.0, here, stand, 20.0, true);
                }
                (Action::Dropoff, Some(stand)) if passenger == IN_TAXI => {
                    push(1.0, here, stand, -1.0, false);
                }
                (Action::Pickup | Action::Dropoff, _) => push(1.0, here, passenger, -10.0, false),
                (heading, _) if config.is_rainy => {
                    let there = drive(row, col, heading);
                    push(ahead, there, passenger, -1.0, false);
                    for side in sides(heading) {
                        let drift = if there == here {
                            here
                        } else {
                            drive(row, col, side)
                        };
                        push(aside, drift, passenger, -1.0, false);
                    }
                }
                (heading, _) => push(1.0, drive(row, col, heading), passenger, -1.0, false),
            }
        });
        let initial = Distribution::uniform(STATES, |state| {
            let (_, _, passenger, destination) = decode(state);
            passenger != IN_TAXI && passenger != destination
        });
        Ok(Self { config, p, initial })
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn table(&self) -> Option<Json> {
        Some(self.p.to_json(&self.initial))
    }

    fn set_table(&mut self, table: Json) -> Result<()> {
        (self.p, self.initial) = self.p.replaced(&table)?;
        Ok(())
    }

    fn observation_space(&self) -> Space {
        Space::discrete(STATES as i64)
    }

    fn action_space(&self) -> Space {
        Action::space()
    }

    fn start(&self, _reset: &Reset, rng: &mut Generator) -> Result<State> {
        Ok(State {
            encoded: self.initial.sample(rng),
            // drawn only if needed, because later draws continue from here
            fickle_step: self.config.fickle_passenger
                && rng.random() < self.config.fickle_probability,
            last_action: None,
            heading: Action::South,
            probability: 1.0,
        })
    }

    fn is_valid(&self, state: &State) -> bool {
        state.encoded < STATES
            && (self.config.fickle_passenger || !state.fickle_step)
            && !matches!(state.heading, Action::Pickup | Action::Dropoff)
            && (0.0..=1.0).contains(&state.probability)
    }

    fn info(&self, state: &State, visit: &mut dyn FnMut(&str, Value)) {
        visit("prob", Value::Float(state.probability));
        visit(
            "action_mask",
            Value::Array(Array::from(action_mask(state.encoded))),
        );
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn_and_text(4, (536, 456))
    }

    fn ansi(&self, state: &State) -> Option<String> {
        draw::ansi(state)
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        draw::city(state, canvas);
    }
}

impl Dynamics for TaxiDynamics {
    #[inline]
    fn transition(
        &self,
        state: &State,
        action: &Action,
        rng: &mut Generator,
    ) -> Result<Transition<State>> {
        self.advance(state, *action, rng)
            .ok_or_else(|| self.p.no_such_state(state.encoded))
    }

    #[inline]
    fn observe(&self, state: &State) -> usize {
        state.encoded
    }
}

impl Native for TaxiDynamics {
    type Packed = Cell;
    type Stream = WordStream;
    type Constants = [f64; 0];

    fn supports(config: &Config) -> Result<(), &'static str> {
        if config.fickle_passenger {
            Err("there are no fickle passengers")
        } else {
            Ok(())
        }
    }

    fn constants(&self) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn pack(&self, state: &State) -> Cell {
        Cell {
            state: state.encoded as u32,
            probability: state.probability,
        }
    }

    #[inline(always)]
    fn unpack(&self, cell: Cell, _fresh: bool) -> State {
        State {
            encoded: cell.state as usize,
            fickle_step: false,
            last_action: None,
            heading: Action::South,
            probability: cell.probability,
        }
    }

    #[inline(always)]
    fn step_block<R: Real>(&self, _: R::Token, block: &mut Many<'_, Self>) {
        block.each(self, |state, action, rng| {
            self.advance(state, action, rng)
                .unwrap_or(Transition::stay(*state))
        });
    }
}

/// The registration shared by all ids.
const fn taxi(id: &'static str) -> Registration {
    Registration::new::<Taxi>(id)
        .description("Pick up a passenger and drop them where they want to go.")
        .max_episode_steps(200)
        .reward_threshold(8.0)
        .vector_entry_point(gym_native::entry_point::<TaxiDynamics>)
        .light_step()
        .names(|_| Names::new(&["((row * 5 + column) * 5 + passenger) * 4 + destination"], &[]))
        .actions(Action::VARIANTS)
        .keys(|_| {
            Keys::new(
                json!({"Down": 0, "Up": 1, "Right": 2, "Left": 3, "P": 4, "Space": 4, "D": 5, "Enter": 5}),
            )
        })
        .policy(Policy::rules(planning::DESCRIPTION, |env| planning::controller(env, TaxiDynamics::p)))
}

#[cfg(not(test))]
gym_core::register!(
    taxi("Taxi-v3"),
    taxi("Taxi-v4").clip(Clip {
        seeds: 0..3,
        every: 1,
        frames: 40,
        size: (268, 228)
    }),
);

#[cfg(test)]
mod tests {
    use gym_core::{EnvExt, builder};

    use super::*;

    fn taxi(config: Config) -> TaxiDynamics {
        TaxiDynamics::new(config).unwrap()
    }

    #[test]
    fn the_mask_shows_what_changes_the_state() {
        let taxi = taxi(Config::default());
        for state in 0..STATES {
            for (action, mask) in action_mask(state).into_iter().enumerate() {
                assert_eq!(
                    mask == 1,
                    taxi.p().outcomes(state, action)[0].next != state,
                    "{state} {action}"
                );
            }
        }
    }

    #[test]
    fn rows_sum_to_one() {
        for is_rainy in [false, true] {
            let taxi = taxi(Config {
                is_rainy,
                rainy_probability: 0.3,
                ..Config::default()
            });
            assert_eq!((taxi.p().states(), taxi.p().actions()), (500, 6));
            for row in (0..500 * 6).map(|i| taxi.p().outcomes(i / 6, i % 6)) {
                assert!((row.iter().map(|o| o.probability).sum::<f64>() - 1.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn every_start_has_somewhere_to_go() {
        let taxi = taxi(Config::default());
        let starts = taxi
            .initial_state_distribution()
            .iter()
            .filter(|p| **p > 0.0)
            .count();
        assert_eq!(
            (
                starts,
                taxi.initial_state_distribution()[encode(0, 0, 0, 0)]
            ),
            (300, 0.0)
        );
    }

    #[test]
    fn pickup_and_dropoff() {
        let taxi = taxi(Config {
            is_rainy: true,
            ..Config::default()
        });
        let outcome = |state, action| {
            let [outcome] = taxi.p().outcomes(state, action as usize) else {
                panic!("one outcome")
            };
            (outcome.next, outcome.reward, outcome.terminated)
        };
        let (waiting, aboard) = (encode(0, 4, 1, 2), encode(0, 4, IN_TAXI, 2));
        assert_eq!(outcome(waiting, Action::Pickup), (aboard, -1.0, false));
        assert_eq!(outcome(aboard, Action::Dropoff), (waiting, -1.0, false));
        assert_eq!(outcome(aboard, Action::Pickup), (aboard, -10.0, false));
        assert_eq!(outcome(waiting, Action::Dropoff), (waiting, -10.0, false));
        let arrived = encode(4, 0, IN_TAXI, 2);
        assert_eq!(
            outcome(arrived, Action::Dropoff),
            (encode(4, 0, 2, 2), 20.0, true)
        );
    }

    #[test]
    fn rain_drifts_aside_unless_the_way_is_blocked() {
        let taxi = taxi(Config {
            is_rainy: true,
            ..Config::default()
        });
        let cells = |row, col, action| {
            let outcomes = taxi.p().outcomes(encode(row, col, 0, 1), action as usize);
            assert_eq!(
                [0, 1, 2].map(|i| outcomes[i].probability),
                [0.8, (1.0 - 0.8) / 2.0, (1.0 - 0.8) / 2.0]
            );
            [0, 1, 2].map(|i| (outcomes[i].next / 100, outcomes[i].next / 20 % 5))
        };
        assert_eq!(cells(2, 2, Action::South), [(3, 2), (2, 3), (2, 1)]);
        assert_eq!(cells(2, 2, Action::West), [(2, 1), (3, 2), (1, 2)]);
        // a wall to the left of the heading
        assert_eq!(cells(3, 0, Action::South), [(4, 0), (3, 0), (3, 0)]);
        // a wall ahead
        assert_eq!(cells(0, 1, Action::East), [(0, 1); 3]);
    }

    /// Picks up the passenger at the red location, waits, and drives on; returns the destinations
    /// along the way.
    fn destinations(config: Config, seed: u64) -> [usize; 4] {
        let taxi = taxi(config);
        let mut rng = Generator::from(seed);
        let mut state = taxi.start(&Reset::default(), &mut rng).unwrap();
        state.encoded = encode(0, 0, 0, 1);
        [Action::Pickup, Action::North, Action::South, Action::South].map(|action| {
            state = taxi.transition(&state, &action, &mut rng).unwrap().state;
            decode(state.encoded).3
        })
    }

    #[test]
    fn a_fickle_passenger_changes_the_destination_once() {
        for seed in 0..50 {
            let fickle = |fickle_probability| {
                destinations(
                    Config {
                        fickle_passenger: true,
                        fickle_probability,
                        ..Config::default()
                    },
                    seed,
                )
            };
            assert_eq!(fickle(0.0), [1; 4]);
            let [picked_up, waited, moved, later] = fickle(1.0);
            assert_eq!((picked_up, waited), (1, 1));
            assert!(moved != 1 && moved == later);
        }
    }

    #[test]
    fn probabilities_are_checked() {
        for bad in [-0.1, 1.5, f64::NAN] {
            let rainy = TaxiDynamics::new(Config {
                rainy_probability: bad,
                ..Config::default()
            });
            let fickle = TaxiDynamics::new(Config {
                fickle_probability: bad,
                ..Config::default()
            });
            assert!(
                rainy
                    .unwrap_err()
                    .to_string()
                    .contains("rainy_probability is")
            );
            assert!(
                fickle
                    .unwrap_err()
                    .to_string()
                    .contains("fickle_probability is")
            );
        }
    }

    #[test]
    fn states_of_another_task_are_refused() {
        let taxi = taxi(Config::default());
        let state = taxi
            .start(&Reset::default(), &mut Generator::from(0))
            .unwrap();
        assert!(taxi.is_valid(&state));
        for bad in [
            State {
                encoded: 500,
                ..state
            },
            State {
                fickle_step: true,
                ..state
            },
            State {
                heading: Action::Pickup,
                ..state
            },
            State {
                probability: 1.5,
                ..state
            },
        ] {
            assert!(!taxi.is_valid(&bad));
        }
        assert!(
            taxi.transition(
                &State {
                    encoded: 500,
                    ..state
                },
                &Action::North,
                &mut Generator::from(0)
            )
            .is_err()
        );
    }
}
