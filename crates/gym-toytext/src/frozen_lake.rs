//! FrozenLake: cross a frozen lake without falling into a hole, on ice that may be slippery.
//!
//! | | |
//! |---|---|
//! | observation | the cell, `row * columns + column` from the top left; `Discrete(cells)` |
//! | action | [`Action`]: left, down, right, up; `Discrete(4)` |
//! | dynamics | a move goes in its direction with probability 1/3, and to either side with 1/3 each; the shore stops it |
//! | reward | 1 for reaching the goal, else 0; see [`Config::reward_schedule`] |
//! | start | a cell `S`, all with the same probability |
//! | end | terminated at the goal `G` and in a hole `H` |
//! | limit | 100 steps (`FrozenLake8x8-v1`: 200) |
//! | info | `prob`: the probability of the outcome |
//!
//! Versions: v1 corrected the rewards. Gymnasium 1.2.1 added `success_rate` and `reward_schedule`
//! to it.
//!
//! Source: Gymnasium 1.4.0, `envs/toy_text/frozen_lake.py`.

mod draw;
mod map;

use std::sync::Arc;

use gym_core::canvas::Canvas;
use gym_core::keys::json;
use gym_core::math::Real;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::rng::{Stream, WordStream};
use gym_core::{
    Dynamics, Generator, Keys, Names, Policy, Registration, Reset, Result, Space, Stateful, Task,
    Transition, Value,
};
use gym_native::{Many, Native};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::distribution::Distribution;
use crate::grid;
use crate::planning;
use crate::tabular::{Cell, MAX_STATES, Outcome, Table, WHOLE_AT_RESET};
pub use map::generate_random_map;
use map::{check_map, invalid, named_map};

/// The environment.
pub type FrozenLake = Stateful<FrozenLakeDynamics>;

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The map: a string for each row, all of one length, of the letters `S` (start), `F`
        /// (frozen), `H` (hole) and `G` (goal), with at least one `S`. Overrides `map_name`.
        pub desc: Option<Vec<String>>,
        /// A map of Gymnasium's: `4x4` or `8x8`. With neither this nor `desc`, each environment
        /// draws a map by [`generate_random_map`]`(8, 0.8, None)`; its snapshots then fit only
        /// itself and its clones.
        pub map_name: Option<String> = Some("4x4".to_owned()),
        /// Whether a move can slip to a side.
        pub is_slippery: bool = true,
        /// The probability that a move on slippery ice goes in its direction; both sides share the
        /// rest.
        pub success_rate: f64 = 1.0 / 3.0,
        /// The rewards of reaching the goal, a hole, and any other cell.
        pub reward_schedule: [f64; 3] = [1.0, 0.0, 0.0],
    }
}

gym_core::discrete! {
    /// The direction of a move.
    #[derive(Serialize, Deserialize)]
    pub enum Action {
        /// One column to the left.
        Left,
        /// One row down.
        Down,
        /// One column to the right.
        Right,
        /// One row up.
        Up,
    }
}

/// The agent's cell, and the last transition.
pub type State = grid::State<Action>;

/// The pure functions of the task.
#[derive(Clone, Debug)]
pub struct FrozenLakeDynamics {
    config: Arc<Config>,
    desc: Arc<[String]>,
    p: Table,
    initial: Distribution,
}

impl FrozenLakeDynamics {
    /// Returns the map, one string per row.
    pub fn desc(&self) -> &[String] {
        &self.desc
    }

    /// The transition table, Gymnasium's `P`.
    pub fn p(&self) -> &Table {
        &self.p
    }

    /// The probability of each cell at the start, Gymnasium's `initial_state_distrib`.
    pub fn initial_state_distribution(&self) -> &[f64] {
        self.initial.probabilities()
    }

    /// Returns the numbers of rows and columns.
    fn shape(&self) -> (usize, usize) {
        (self.desc.len(), self.desc[0].len())
    }
}

impl FrozenLakeDynamics {
    /// Returns the next state and outcome; `None` if the state does not exist.
    #[inline(always)]
    fn advance(
        &self,
        state: &State,
        action: Action,
        rng: &mut impl Stream,
    ) -> Option<Transition<State>> {
        state.advance(&self.p, action, action as usize, rng)
    }
}

impl Task for FrozenLakeDynamics {
    type Config = Config;
    type State = State;
    type Observation = usize;
    type Action = Action;

    const NAME: &'static str = "FrozenLake";
    const INFO: bool = true;

    fn new(config: Config) -> Result<Self> {
        let desc = match (&config.desc, &config.map_name) {
            (Some(desc), _) => desc.clone(),
            (None, Some(name)) => named_map(name)?,
            (None, None) => generate_random_map(8, 0.8, None)?,
        };
        // a random map becomes part of the arguments, so that the arguments describe this lake
        let config = Config {
            desc: config
                .map_name
                .is_none()
                .then(|| desc.clone())
                .or(config.desc),
            ..config
        };
        let Config {
            is_slippery,
            success_rate,
            reward_schedule,
            ..
        } = config;
        check_map(&desc)?;
        if !(0.0..=1.0).contains(&success_rate) {
            return Err(invalid(format!(
                "success_rate is {success_rate}: a probability is between 0 and 1"
            )));
        }
        if !reward_schedule.iter().all(|reward| reward.is_finite()) {
            return Err(invalid(format!(
                "reward_schedule is {reward_schedule:?}: rewards are finite numbers"
            )));
        }

        let (nrow, ncol) = (desc.len(), desc[0].len());
        let letters = desc.concat().into_bytes();
        if letters.len() > MAX_STATES {
            return Err(invalid(format!(
                "the map has {} cells: at most {MAX_STATES} are possible",
                letters.len()
            )));
        }
        let [goal, hole, other] = reward_schedule;
        let fail_rate = (1.0 - success_rate) / 2.0;
        // for each outcome, the number of quarter turns from the action to the outcome's direction,
        // and the probability
        let turns: &[(usize, f64)] = if is_slippery {
            &[(3, fail_rate), (0, success_rate), (1, fail_rate)]
        } else {
            &[(0, 1.0)]
        };
        let p = Table::build(
            letters.len(),
            Action::ALL.len(),
            |cell, action, outcomes| {
                if matches!(letters[cell], b'G' | b'H') {
                    outcomes.push(Outcome {
                        probability: 1.0,
                        next: cell,
                        reward: 0.0,
                        terminated: true,
                    });
                    return;
                }
                let (row, col) = (cell / ncol, cell % ncol);
                outcomes.extend(turns.iter().map(|&(turn, probability)| {
                    let (row, col) = match Action::ALL[(action + turn) % 4] {
                        Action::Left => (row, col.saturating_sub(1)),
                        Action::Down => ((row + 1).min(nrow - 1), col),
                        Action::Right => (row, (col + 1).min(ncol - 1)),
                        Action::Up => (row.saturating_sub(1), col),
                    };
                    let next = row * ncol + col;
                    let (reward, terminated) = match letters[next] {
                        b'G' => (goal, true),
                        b'H' => (hole, true),
                        _ => (other, false),
                    };
                    Outcome {
                        probability,
                        next,
                        reward,
                        terminated,
                    }
                }));
            },
        );
        let initial = Distribution::uniform(letters.len(), |cell| letters[cell] == b'S');
        Ok(Self {
            config: config.into(),
            desc: desc.into(),
            p,
            initial,
        })
    }

    fn config(&self) -> &Config {
        &self.config
    }

    /// Returns `P` and `desc`, the rows of the map. A replaced table does not change `desc`.
    fn table(&self) -> Option<Json> {
        let mut table = self.p.to_json(&self.initial);
        table["desc"] = self.desc.to_vec().into();
        Some(table)
    }

    fn set_table(&mut self, table: Json) -> Result<()> {
        (self.p, self.initial) = self.p.replaced(&table)?;
        Ok(())
    }

    fn observation_space(&self) -> Space {
        Space::discrete(self.p.states() as i64)
    }

    fn action_space(&self) -> Space {
        Action::space()
    }

    fn start(&self, _reset: &Reset, rng: &mut Generator) -> Result<State> {
        Ok(State::start(self.initial.sample(rng)))
    }

    fn is_valid(&self, state: &State) -> bool {
        state.cell < self.p.states() && (0.0..=1.0).contains(&state.probability)
    }

    fn info(&self, state: &State, visit: &mut dyn FnMut(&str, Value)) {
        state.info(visit);
    }

    fn metadata(&self) -> Metadata {
        let (nrow, ncol) = self.shape();
        Metadata::drawn_and_text(
            4,
            ((64 * ncol).min(512) as u32, (64 * nrow).min(512) as u32),
        )
    }

    /// Writes the last action, and the map with the agent's cell in red.
    fn ansi(&self, state: &State) -> Option<String> {
        let mut text = state
            .last_action
            .map_or_else(String::new, |action| format!("  ({action:?})"));
        text.push('\n');
        let (_, ncol) = self.shape();
        for (cell, letter) in self.desc.concat().char_indices() {
            if cell == state.cell {
                text += &format!("\x1b[41m{letter}\x1b[0m");
            } else {
                text.push(letter);
            }
            if (cell + 1) % ncol == 0 {
                text.push('\n');
            }
        }
        Some(text)
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        self.draw_lake(state, canvas);
    }
}

impl Dynamics for FrozenLakeDynamics {
    #[inline]
    fn transition(
        &self,
        state: &State,
        action: &Action,
        rng: &mut Generator,
    ) -> Result<Transition<State>> {
        self.advance(state, *action, rng)
            .ok_or_else(|| self.p.no_such_state(state.cell))
    }

    #[inline]
    fn observe(&self, state: &State) -> usize {
        state.cell
    }
}

impl Native for FrozenLakeDynamics {
    type Packed = Cell;
    type Stream = WordStream;
    type Constants = [f64; 0];

    fn supports(config: &Config) -> Result<(), &'static str> {
        match config {
            Config {
                desc: None,
                map_name: None,
                ..
            } => Err("there are no random maps, one for each environment,"),
            _ => Ok(()),
        }
    }

    fn constants(&self) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn pack(&self, state: &State) -> Cell {
        state.pack()
    }

    /// Restores a state. `cell` does not contain the last action, so any action stands in after the
    /// first step.
    #[inline(always)]
    fn unpack(&self, cell: Cell, fresh: bool) -> State {
        State::unpack(cell, (!fresh).then_some(Action::Left))
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
const fn lake(id: &'static str) -> Registration {
    Registration::new::<FrozenLake>(id)
        .exceptions(&[WHOLE_AT_RESET])
        .vector_entry_point(gym_native::entry_point::<FrozenLakeDynamics>)
        .light_step()
        .names(|_| Names::new(&["cell: columns * row + column"], &[]))
        .actions(Action::VARIANTS)
        .keys(|_| Keys::new(json!({"Left": 0, "Down": 1, "Right": 2, "Up": 3})))
        .policy(Policy::rules(planning::DESCRIPTION, |env| {
            planning::controller(env, FrozenLakeDynamics::p)
        }))
}

#[cfg(not(test))]
gym_core::register!(
    lake("FrozenLake-v1")
        .description("Cross a frozen lake without falling into a hole.")
        .kwargs(r#"{"map_name": "4x4"}"#)
        .max_episode_steps(100)
        .reward_threshold(0.70)
        .clip(Clip {
            seeds: 12..13,
            every: 1,
            frames: 40,
            size: (192, 192)
        }),
    lake("FrozenLake8x8-v1")
        .description("Cross a larger frozen lake without falling into a hole.")
        .kwargs(r#"{"map_name": "8x8"}"#)
        .max_episode_steps(200)
        .reward_threshold(0.85),
);

#[cfg(test)]
mod tests {
    use gym_core::{Env, EnvExt};

    use super::*;

    fn lake(config: Config) -> FrozenLakeDynamics {
        FrozenLakeDynamics::new(config).unwrap()
    }

    fn on(desc: &[&str]) -> Config {
        Config {
            desc: Some(desc.iter().map(|row| (*row).to_owned()).collect()),
            ..Config::default()
        }
    }

    fn refusal(config: Config) -> String {
        FrozenLakeDynamics::new(config).unwrap_err().to_string()
    }

    /// The probability is an integer after a reset, as Gymnasium's, and a float after a step.
    #[test]
    fn the_probability_has_the_type_of_gymnasiums() {
        let mut env = FrozenLake::new(Config::default()).unwrap();
        env.reset(0).unwrap();
        assert_eq!(env.info_map()["prob"], Value::Int(1));
        env.step(&Action::Right).unwrap();
        assert!(matches!(env.info_map()["prob"], Value::Float(_)));
        env.reset(()).unwrap();
        assert_eq!(env.info_map()["prob"], Value::Int(1));
    }

    #[test]
    fn a_slippery_move_has_three_outcomes() {
        let lake = lake(Config::default());
        let rows = lake.p().outcomes(14, Action::Right as usize);
        let expected = [(14, 0.0, false), (15, 1.0, true), (10, 0.0, false)];
        assert_eq!(
            rows.iter()
                .map(|o| (o.next, o.reward, o.terminated))
                .collect::<Vec<_>>(),
            expected
        );
        let probabilities: Vec<f64> = rows.iter().map(|o| o.probability).collect();
        // (1 - 1/3) / 2 is not 1/3
        assert_eq!(
            probabilities,
            [0.33333333333333337, 1.0 / 3.0, 0.33333333333333337]
        );
    }

    #[test]
    fn rows_sum_to_one_and_the_end_is_absorbing() {
        for config in [
            Config::default(),
            Config {
                is_slippery: false,
                ..Config::default()
            },
            Config {
                success_rate: 0.0,
                ..on(&["SFFG", "HFHF"])
            },
            Config {
                success_rate: 1.0,
                map_name: Some("8x8".to_owned()),
                ..Config::default()
            },
        ] {
            let lake = lake(config);
            let letters = lake.desc().concat().into_bytes();
            assert_eq!((lake.p().states(), lake.p().actions()), (letters.len(), 4));
            for (cell, letter) in letters.into_iter().enumerate() {
                for action in 0..4 {
                    let row = lake.p().outcomes(cell, action);
                    assert!((row.iter().map(|o| o.probability).sum::<f64>() - 1.0).abs() < 1e-15);
                    if matches!(letter, b'G' | b'H') {
                        let stay = Outcome {
                            probability: 1.0,
                            next: cell,
                            reward: 0.0,
                            terminated: true,
                        };
                        assert_eq!(row, [stay]);
                    }
                }
            }
        }
    }

    #[test]
    fn rewards_follow_the_schedule() {
        let config = Config {
            reward_schedule: [5.0, -2.0, -0.5],
            is_slippery: false,
            ..on(&["HSG", "FFF"])
        };
        let lake = lake(config);
        let rewards = Action::ALL.map(|action| lake.p().outcomes(1, action as usize)[0].reward);
        assert_eq!(rewards, [-2.0, -0.5, 5.0, -0.5]);
    }

    #[test]
    fn all_starts_are_alike() {
        let lake = lake(on(&["SFS", "SSG"]));
        assert_eq!(
            lake.initial_state_distribution(),
            [0.25, 0.0, 0.25, 0.25, 0.25, 0.0]
        );
    }

    #[test]
    fn bad_arguments_are_refused() {
        for (desc, reason) in [
            (&[][..], "desc is empty"),
            (&["", ""], "desc is empty"),
            (&["SF", "F"], "rows of different length: `SF` and `F`"),
            (&["SF", "FX"], "the letter 'X': use S (start)"),
            (&["SF", "Fé"], "the letter 'é'"),
            (&["FF", "FG"], "no start: mark a cell with S"),
        ] {
            let error = refusal(on(desc));
            assert!(
                error.starts_with("invalid argument for FrozenLake: ") && error.contains(reason),
                "{error}"
            );
        }
        let error = refusal(Config {
            map_name: Some("5x5".to_owned()),
            ..Config::default()
        });
        assert!(
            error.contains("unknown map_name `5x5`: the maps are 4x4, 8x8"),
            "{error}"
        );
        for success_rate in [-0.1, 1.1, f64::NAN] {
            assert!(
                refusal(Config {
                    success_rate,
                    ..Config::default()
                })
                .contains("between 0 and 1")
            );
        }
        let reward_schedule = [1.0, f64::INFINITY, 0.0];
        assert!(
            refusal(Config {
                reward_schedule,
                ..Config::default()
            })
            .contains("finite")
        );
    }

    #[test]
    fn a_snapshot_fits_its_own_map_alone() {
        let random = || {
            FrozenLake::new(Config {
                map_name: None,
                ..Config::default()
            })
            .unwrap()
        };
        let (mut one, mut other) = (random(), random());
        one.reset(0).unwrap();
        let snapshot = one.snapshot().unwrap();
        one.clone().restore(&snapshot).unwrap();
        let same_map = one.dynamics().desc() == other.dynamics().desc();
        assert_eq!(other.restore(&snapshot).is_ok(), same_map);
    }

    #[test]
    fn ansi_is_gymnasiums() {
        let mut env = FrozenLake::new(Config {
            is_slippery: false,
            ..on(&["SF", "FG"])
        })
        .unwrap();
        env.reset(0).unwrap();
        assert_eq!(env.ansi().unwrap(), "\n\x1b[41mS\x1b[0mF\nFG\n");
        env.step(&Action::Right).unwrap();
        assert_eq!(env.ansi().unwrap(), "  (Right)\nS\x1b[41mF\x1b[0m\nFG\n");
    }
}
