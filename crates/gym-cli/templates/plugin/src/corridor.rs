//! Corridor: find the way out of a dark corridor, on a slippery floor.
//!
//! | | |
//! |---|---|
//! | observation | the cell, from 0 at the left end; `Discrete(length)` |
//! | action | [`Action`]: left, right; `Discrete(2)` |
//! | dynamics | a step succeeds with probability `1 - slip`; otherwise nothing moves |
//! | reward | -1 for each step |
//! | start | any cell of the left half, each as likely as the other |
//! | end | terminated in the last cell |
//! | limit | 100 steps |
//! | info | `slipped`: whether the last step failed |

use gym_core::canvas::{Align, Canvas, Color};
use gym_core::keys::json;
use gym_core::render::Metadata;
use gym_core::{Dynamics, Error, Generator, Keys, Names, Registration, Reset, Result, Space, Stateful, Task, Transition, Value};
use serde::{Deserialize, Serialize};

/// The environment.
pub type Corridor = Stateful<CorridorDynamics>;

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    pub struct Config {
        /// The number of cells, from 2 to 100.
        pub length: i64 = 10,
        /// The probability that a step fails.
        pub slip: f64 = 0.2,
    }
}

gym_core::discrete! {
    /// A step along the corridor.
    pub enum Action {
        /// Towards cell 0.
        Left,
        /// Towards the way out.
        Right,
    }
}

/// The agent's cell, and how it got there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// The cell.
    pub cell: i64,
    /// Whether the last step failed.
    pub slipped: bool,
}

/// The pure functions of the task.
#[derive(Clone, Copy, Debug)]
pub struct CorridorDynamics {
    config: Config,
}

impl Task for CorridorDynamics {
    type Config = Config;
    type State = State;
    type Observation = i64;
    type Action = Action;

    const NAME: &'static str = "Corridor";

    fn new(config: Config) -> Result<Self> {
        let Config { length, slip } = config;
        if !(2..=100).contains(&length) {
            return Err(Error::argument(Self::NAME, format!("length is {length}: it must be between 2 and 100")));
        }
        if !(0.0..1.0).contains(&slip) {
            return Err(Error::argument(Self::NAME, format!("slip is {slip}: it must be from 0 to below 1")));
        }
        Ok(Self { config })
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn observation_space(&self) -> Space {
        Space::discrete(self.config.length)
    }

    fn action_space(&self) -> Space {
        Action::space()
    }

    fn start(&self, _reset: &Reset, rng: &mut Generator) -> Result<State> {
        Ok(State { cell: rng.integers(0, self.config.length / 2), slipped: false })
    }

    fn is_valid(&self, state: &State) -> bool {
        (0..self.config.length).contains(&state.cell)
    }

    fn info(&self, state: &State, visit: &mut dyn FnMut(&str, Value)) {
        visit("slipped", Value::Bool(state.slipped));
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn_and_text(5, (400, 100))
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        let width = 400.0 / self.config.length as f64;
        let left = |cell: i64| cell as f64 * width;
        canvas.clear(WALL);
        for cell in 0..self.config.length {
            let color = if cell == self.config.length - 1 { DAYLIGHT } else { FLOOR };
            canvas.rect([left(cell) + 1.0, 20.0], [width - 2.0, 60.0], color);
        }
        let color = if state.slipped { SLIPPED } else { AGENT };
        canvas.circle([left(state.cell) + width / 2.0, 50.0], width.min(40.0) * 0.35, color);
        canvas.text("Corridor", [8.0, 14.0], 8.0, Align::Left, Color::WHITE);
    }

    /// `A` is the agent, `>` the way out: what `cargo xtask play --terminal` shows.
    fn ansi(&self, state: &State) -> Option<String> {
        let last = self.config.length - 1;
        let cell = |cell| match cell {
            _ if cell == state.cell => 'A',
            _ if cell == last => '>',
            _ => '.',
        };
        Some((0..=last).map(cell).collect())
    }
}

impl Dynamics for CorridorDynamics {
    fn transition(&self, state: &State, action: &Action, rng: &mut Generator) -> Result<Transition<State>> {
        let last = self.config.length - 1;
        let slipped = rng.random() < self.config.slip;
        let cell = match action {
            _ if slipped => state.cell,
            Action::Left => (state.cell - 1).max(0),
            Action::Right => (state.cell + 1).min(last),
        };
        Ok(Transition { state: State { cell, slipped }, reward: -1.0, terminated: cell == last })
    }

    fn observe(&self, state: &State) -> i64 {
        state.cell
    }
}

const WALL: Color = Color::rgb(52, 56, 66);
const FLOOR: Color = Color::rgb(120, 126, 140);
const DAYLIGHT: Color = Color::rgb(250, 226, 150);
const AGENT: Color = Color::rgb(72, 160, 220);
const SLIPPED: Color = Color::rgb(222, 96, 80);

gym_core::register!(
    Registration::new::<Corridor>("plugin_name/Corridor-v0")
        .description("Find the way out of a dark corridor, on a slippery floor.")
        .max_episode_steps(100)
        .names(|_| Names::new(&["cell, from the left"], &[]))
        // the keys of `cargo xtask play`; without this line, the keys are digits
        .keys(|_| Keys::new(json!({"Left": 0, "Right": 1})))
);

#[cfg(test)]
mod tests {
    use gym_core::{Env, EnvExt};

    use super::*;

    #[test]
    fn the_way_out_is_on_the_right() -> Result<()> {
        let mut env = Corridor::new(Config { length: 4, slip: 0.0 })?;
        let start = env.reset(0)?;
        for cell in start + 1..=3 {
            let step = env.step(&Action::Right)?;
            assert_eq!((step.observation, step.reward, step.terminated), (cell, -1.0, cell == 3));
        }
        Ok(())
    }

    #[test]
    fn its_text_shows_agent_and_way_out() -> Result<()> {
        let mut env = Corridor::new(Config { length: 4, slip: 0.0 })?;
        env.reset(Reset::seed(0))?;
        assert!(["A..>", ".A.>"].map(|text| Some(text.to_owned())).contains(&env.ansi()));
        Ok(())
    }

    #[test]
    fn bad_arguments_are_refused() {
        assert!(Corridor::new(Config { length: 1, slip: 0.0 }).is_err());
        assert!(Corridor::new(Config { length: 4, slip: f64::NAN }).is_err());
    }
}
