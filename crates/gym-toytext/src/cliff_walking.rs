//! CliffWalking: reach the goal along the edge of a cliff.
//!
//! | | |
//! |---|---|
//! | observation | the cell, `row * 12 + column` from the top left; `Discrete(48)` |
//! | action | [`Action`]: up, right, down, left; `Discrete(4)` |
//! | dynamics | the border stops a move; the cliff (bottom row, columns 1 to 10) throws it back to the start |
//! | reward | -1 per step, -100 for a step into the cliff |
//! | start | bottom left, cell 36 |
//! | end | terminated at the goal, bottom right, cell 47 |
//! | limit | none |
//! | info | `prob`: the probability of the outcome |
//!
//! Versions: v1 added `is_slippery`; v0, which Gymnasium has removed, takes no arguments.
//!
//! After Example 6.6 of Sutton and Barto, *Reinforcement Learning: An Introduction* (2020). Source:
//! Gymnasium 1.4.0, `envs/toy_text/cliffwalking.py`.

use gym_core::canvas::{Canvas, Color};
use gym_core::keys::json;
use gym_core::math::Real;
use gym_core::registry::Clip;
use gym_core::render::{Metadata, RenderMode};
use gym_core::rng::{Stream, WordStream};
use gym_core::{
    Dynamics, Generator, Keys, Names, Policy, Registration, Reset, Result, Space, Stateful, Task,
    Transition, Value,
};
use gym_native::{Many, Native};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::art::{self, Facing};
use crate::distribution::Distribution;
use crate::grid;
use crate::planning;
use crate::tabular::{Cell, Outcome, Table, WHOLE_AT_RESET};

/// The environment.
pub type CliffWalking = Stateful<CliffWalkingDynamics>;

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    pub struct Config {
        /// Whether a move goes to either side of its direction with probability 1/3 each.
        #[versions = 1..]
        pub is_slippery: bool,
    }
}

const ROWS: usize = 4;
const COLUMNS: usize = 12;
const CELLS: usize = ROWS * COLUMNS;
const START: usize = 3 * COLUMNS;
const GOAL: usize = CELLS - 1;

const fn is_cliff(cell: usize) -> bool {
    START < cell && cell < GOAL
}

gym_core::discrete! {
    /// The direction of a move.
    #[derive(Serialize, Deserialize)]
    pub enum Action {
        /// One row up.
        Up,
        /// One column to the right.
        Right,
        /// One row down.
        Down,
        /// One column to the left.
        Left,
    }
}

/// The agent's cell, and the last transition.
pub type State = grid::State<Action>;

/// The pure functions of the task.
#[derive(Clone, Debug)]
pub struct CliffWalkingDynamics {
    config: Config,
    p: Table,
    initial: Distribution,
}

impl CliffWalkingDynamics {
    /// The transition table, Gymnasium's `P`.
    pub fn p(&self) -> &Table {
        &self.p
    }

    /// The probability of each cell at the start, Gymnasium's `initial_state_distrib`.
    pub fn initial_state_distribution(&self) -> &[f64] {
        self.initial.probabilities()
    }
}

impl CliffWalkingDynamics {
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

impl Task for CliffWalkingDynamics {
    type Config = Config;
    type State = State;
    type Observation = usize;
    type Action = Action;

    const NAME: &'static str = "CliffWalking";
    const INFO: bool = true;

    fn new(config: Config) -> Result<Self> {
        // for each outcome, the number of quarter turns from the action to the outcome's direction
        let turns: &[usize] = if config.is_slippery { &[3, 0, 1] } else { &[0] };
        let probability = 1.0 / turns.len() as f64;
        let p = Table::build(CELLS, Action::ALL.len(), |cell, action, outcomes| {
            let (row, col) = (cell / COLUMNS, cell % COLUMNS);
            outcomes.extend(turns.iter().map(|turn| {
                let (row, col) = match Action::ALL[(action + turn) % 4] {
                    Action::Up => (row.saturating_sub(1), col),
                    Action::Right => (row, (col + 1).min(COLUMNS - 1)),
                    Action::Down => ((row + 1).min(ROWS - 1), col),
                    Action::Left => (row, col.saturating_sub(1)),
                };
                match row * COLUMNS + col {
                    cell if is_cliff(cell) => Outcome {
                        probability,
                        next: START,
                        reward: -100.0,
                        terminated: false,
                    },
                    next => Outcome {
                        probability,
                        next,
                        reward: -1.0,
                        terminated: next == GOAL,
                    },
                }
            }));
        });
        Ok(Self {
            config,
            p,
            initial: Distribution::uniform(CELLS, |cell| cell == START),
        })
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
        Space::discrete(CELLS as i64)
    }

    fn action_space(&self) -> Space {
        Action::space()
    }

    fn start(&self, _reset: &Reset, rng: &mut Generator) -> Result<State> {
        Ok(State::start(self.initial.sample(rng)))
    }

    fn is_valid(&self, state: &State) -> bool {
        state.cell < CELLS && !is_cliff(state.cell) && (0.0..=1.0).contains(&state.probability)
    }

    fn info(&self, state: &State, visit: &mut dyn FnMut(&str, Value)) {
        state.info(visit);
    }

    fn metadata(&self) -> Metadata {
        const MODES: [RenderMode; 3] = [RenderMode::Human, RenderMode::RgbArray, RenderMode::Ansi];
        Metadata {
            render_modes: &MODES,
            ..Metadata::drawn_and_text(4, (768, 256))
        }
    }

    /// Draws the grid as text: `x` is the agent, `T` the goal, `C` the cliff.
    fn ansi(&self, state: &State) -> Option<String> {
        let mut text = String::new();
        for cell in 0..CELLS {
            text.push(match cell {
                cell if cell == state.cell => 'x',
                GOAL => 'T',
                cell if is_cliff(cell) => 'C',
                _ => 'o',
            });
            text += if (cell + 1) % COLUMNS == 0 {
                "\n"
            } else {
                "  "
            };
        }
        text.push('\n');
        Some(text)
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        let at = |cell: usize| {
            [
                64.0 * (cell % COLUMNS) as f64,
                64.0 * (cell / COLUMNS) as f64,
            ]
        };
        canvas.clear(GRASS);
        for cell in 0..CELLS {
            let [x, y] = at(cell);
            let light = (cell / COLUMNS + cell % COLUMNS).is_multiple_of(2);
            if is_cliff(cell) {
                // the grass of the row above reaches over the edge
                rock(canvas, x, y, if light { GRASS } else { LIGHT_GRASS });
                continue;
            }
            if light {
                canvas.rect([x, y], [64.0, 64.0], LIGHT_GRASS);
            }
            if cell < START && cell % 7 % 3 == 1 {
                tuft(canvas, x + 12.0 + (cell % 5 * 8) as f64, y + 20.0);
            }
        }
        let [x, y] = at(START);
        canvas.round_rect([x + 8.0, y + 40.0], [48.0, 18.0], 9.0, EARTH);
        let [x, y] = at(GOAL);
        canvas.round_rect([x + 6.0, y + 46.0], [52.0, 14.0], 7.0, EARTH);
        art::flag(canvas, [x + 14.0, y + 54.0], RED);

        let facing = match state.last_action {
            Some(Action::Left) => Facing::Left,
            Some(Action::Right) => Facing::Right,
            Some(Action::Up) => Facing::Up,
            Some(Action::Down) | None => Facing::Down,
        };
        let [x, y] = at(state.cell);
        let aside = if state.cell == GOAL { 10.0 } else { 0.0 };
        art::person(canvas, [x + 32.0 + aside, y + 57.0], facing, COAT);
    }
}

impl Dynamics for CliffWalkingDynamics {
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

const GRASS: Color = Color::rgb(140, 190, 92);
const LIGHT_GRASS: Color = Color::rgb(154, 202, 104);
const DARK_GRASS: Color = Color::rgb(116, 166, 76);
const EARTH: Color = Color::rgb(196, 164, 112);
const ROCK: Color = Color::rgb(158, 120, 84);
const DARK_ROCK: Color = Color::rgb(118, 86, 62);
const ABYSS: Color = Color::rgb(58, 46, 46);
const RED: Color = Color::rgb(214, 62, 62);
const COAT: Color = Color::rgb(58, 110, 186);

/// Draws blades of grass.
fn tuft(canvas: &mut dyn Canvas, x: f64, y: f64) {
    for (dx, height) in [(0.0, 5.0), (4.0, 8.0), (8.0, 5.0)] {
        canvas.rect([x + dx, y - height], [2.0, height], DARK_GRASS);
    }
}

/// Draws a cell of the cliff's face, darker with depth, under an edge of grass.
fn rock(canvas: &mut dyn Canvas, x: f64, y: f64, grass: Color) {
    canvas.rect([x, y], [64.0, 34.0], ROCK);
    canvas.rect([x, y + 34.0], [64.0, 16.0], DARK_ROCK);
    canvas.rect([x, y + 50.0], [64.0, 14.0], ABYSS);
    for (dx, dy, width) in [(6.0, 18.0, 14.0), (38.0, 14.0, 18.0), (22.0, 27.0, 20.0)] {
        canvas.rect([x + dx, y + dy], [width, 3.0], DARK_ROCK);
    }
    for (dx, dy, width) in [(10.0, 41.0, 18.0), (44.0, 39.0, 12.0)] {
        canvas.rect([x + dx, y + dy], [width, 3.0], ABYSS);
    }
    for i in 0..4 {
        canvas.circle([x + 8.0 + 16.0 * f64::from(i), y], 8.0, grass);
    }
}

impl Native for CliffWalkingDynamics {
    type Packed = Cell;
    type Stream = WordStream;
    type Constants = [f64; 0];

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
        State::unpack(cell, (!fresh).then_some(Action::Up))
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
const fn cliff(id: &'static str) -> Registration {
    Registration::new::<CliffWalking>(id)
        .description("Walk along a cliff without falling off.")
        .exceptions(&[WHOLE_AT_RESET])
        .vector_entry_point(gym_native::entry_point::<CliffWalkingDynamics>)
        .light_step()
        .names(|_| Names::new(&["cell: 12 * row + column"], &[]))
        .actions(Action::VARIANTS)
        .keys(|_| Keys::new(json!({"Up": 0, "Right": 1, "Down": 2, "Left": 3})))
        .policy(Policy::rules(planning::DESCRIPTION, |env| {
            planning::controller(env, CliffWalkingDynamics::p)
        }))
}

#[cfg(not(test))]
gym_core::register!(
    cliff("CliffWalking-v0"),
    cliff("CliffWalking-v1").clip(Clip {
        seeds: 0..1,
        every: 1,
        frames: 40,
        size: (384, 128)
    }),
    cliff("CliffWalkingSlippery-v1")
        .description("Walk along a slippery cliff without falling off.")
        .kwargs(r#"{"is_slippery": true}"#),
);

#[cfg(test)]
mod tests {
    use gym_core::{Env, EnvExt, builder};

    use super::*;

    fn next(is_slippery: bool, cell: usize, action: Action) -> Vec<usize> {
        let cliff = CliffWalkingDynamics::new(Config { is_slippery }).unwrap();
        cliff
            .p()
            .outcomes(cell, action as usize)
            .iter()
            .map(|outcome| outcome.next)
            .collect()
    }

    #[test]
    fn moves_stop_at_the_border_and_slip_to_both_sides() {
        assert_eq!(
            Action::ALL.map(|action| next(false, 14, action)),
            [[2], [15], [26], [13]]
        );
        assert_eq!(next(false, 0, Action::Up), [0]);
        assert_eq!(next(false, 11, Action::Right), [11]);
        assert_eq!(next(true, 14, Action::Up), [13, 2, 15]);
    }

    #[test]
    fn the_cliff_throws_back_and_the_goal_ends() {
        let cliff = CliffWalkingDynamics::new(Config::default()).unwrap();
        let fall = Outcome {
            probability: 1.0,
            next: START,
            reward: -100.0,
            terminated: false,
        };
        assert_eq!(cliff.p().outcomes(START, Action::Right as usize), [fall]);
        let goal = Outcome {
            probability: 1.0,
            next: GOAL,
            reward: -1.0,
            terminated: true,
        };
        assert_eq!(cliff.p().outcomes(35, Action::Down as usize), [goal]);
    }

    #[test]
    fn rows_sum_to_one() {
        for is_slippery in [false, true] {
            let cliff = CliffWalkingDynamics::new(Config { is_slippery }).unwrap();
            assert_eq!((cliff.p().states(), cliff.p().actions()), (48, 4));
            for row in (0..48 * 4).map(|i| cliff.p().outcomes(i / 4, i % 4)) {
                assert_eq!(row.iter().map(|o| o.probability).sum::<f64>(), 1.0);
            }
        }
    }

    #[test]
    fn ansi_is_gymnasiums() {
        let mut env = CliffWalking::new(Config::default()).unwrap();
        env.reset(0).unwrap();
        let row = "o  o  o  o  o  o  o  o  o  o  o  o\n";
        let last = "x  C  C  C  C  C  C  C  C  C  C  T\n\n";
        assert_eq!(env.ansi().unwrap(), [row, row, row, last].concat());
    }
}
