//! Windy gridworld: reach the goal across a wind that blows upwards.
//!
//! | | |
//! |---|---|
//! | observation | the cell, `row * 10 + column` from the top left; `Discrete(70)` |
//! | action | up, down, right, left, and with [`Config::king`] up-right, down-right, down-left, up-left; `Discrete(4)` or `Discrete(8)` |
//! | dynamics | the move, and the wind of the column it starts in; the edge stops both |
//! | reward | -1 for each step |
//! | start | the cell in row 3, column 0; with [`Config::stochastic`] any cell of column 0 |
//! | end | terminated at the goal, row 3, column 7 |
//! | limit | 200 steps |
//! | info | `wind`: by how many cells the last step was blown |
//!
//! Source: Sutton and Barto, "Reinforcement Learning: An Introduction" (2nd edition, 2018), example
//! 6.5 and exercises 6.9 and 6.10; the book starts in row 3 throughout.

use gym_core::canvas::{Canvas, Color};
use gym_core::keys::json;
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::{
    Dynamics, Env, Error, Generator, Keys, Policy, Registration, Reset, Result, Space, Stateful,
    Task, Transition, Value,
};
use serde::{Deserialize, Serialize};

/// The environment.
pub type WindyGridworld = Stateful<WindyGridworldDynamics>;

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    pub struct Config {
        /// Whether the agent moves along diagonals as well.
        pub king: bool,
        /// Whether the wind of a windy column is one cell weaker or stronger, each a third of the
        /// time.
        pub stochastic: bool,
    }
}

const ROWS: i64 = 7;
const COLUMNS: i64 = 10;
/// The number of cells by which each column's wind moves the agent up.
const WIND: [i64; COLUMNS as usize] = [0, 0, 0, 1, 1, 1, 2, 2, 1, 0];
const START_ROW: i64 = 3;
const GOAL: [i64; 2] = [3, 7]; // row, column
/// The rows and columns of each move.
const MOVES: [[i64; 2]; 8] = [
    [-1, 0],
    [1, 0],
    [0, 1],
    [0, -1],
    [-1, 1],
    [1, 1],
    [1, -1],
    [-1, -1],
];

/// The agent's cell, and the last wind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// The row, counted from the top.
    pub row: i64,
    /// The column, counted from the left.
    pub column: i64,
    /// The number of cells by which the last step was blown up.
    pub wind: i64,
}

/// The pure functions of the task.
#[derive(Clone, Copy, Debug)]
pub struct WindyGridworldDynamics {
    config: Config,
}

impl Task for WindyGridworldDynamics {
    type Config = Config;
    type State = State;
    type Observation = i64;
    type Action = usize;

    const NAME: &'static str = "WindyGridworld";

    fn new(config: Config) -> Result<Self> {
        Ok(Self { config })
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn observation_space(&self) -> Space {
        Space::discrete(ROWS * COLUMNS)
    }

    fn action_space(&self) -> Space {
        Space::discrete(if self.config.king { 8 } else { 4 })
    }

    fn start(&self, _reset: &Reset, rng: &mut Generator) -> Result<State> {
        let row = if self.config.stochastic {
            rng.integers(0, ROWS)
        } else {
            START_ROW
        };
        Ok(State {
            row,
            column: 0,
            wind: 0,
        })
    }

    fn is_valid(&self, state: &State) -> bool {
        (0..ROWS).contains(&state.row)
            && (0..COLUMNS).contains(&state.column)
            && (0..=3).contains(&state.wind)
    }

    fn info(&self, state: &State, visit: &mut dyn FnMut(&str, Value)) {
        visit("wind", Value::Int(state.wind));
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn_and_text(
            5,
            ((COLUMNS as f64 * CELL) as u32, (ROWS as f64 * CELL) as u32),
        )
    }

    fn ansi(&self, state: &State) -> Option<String> {
        let mut text = String::new();
        for row in 0..ROWS {
            text.extend((0..COLUMNS).map(|column| match [row, column] {
                cell if cell == [state.row, state.column] => '@',
                GOAL => 'G',
                _ => '.',
            }));
            text.push('\n');
        }
        text.extend(WIND.map(|wind| char::from(b'0' + wind as u8)));
        text.push('\n');
        Some(text)
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        canvas.clear(LINE);
        for (column, wind) in (0..COLUMNS).zip(WIND) {
            for row in 0..ROWS {
                let color = if [row, column] == GOAL {
                    MEADOW
                } else {
                    SKY[wind as usize]
                };
                canvas.rect(
                    [column as f64 * CELL + 1.0, row as f64 * CELL + 1.0],
                    [CELL - 2.0; 2],
                    color,
                );
            }
        }
        let center = [
            (state.column as f64 + 0.5) * CELL,
            (state.row as f64 + 0.5) * CELL,
        ];
        canvas.circle(center, CELL * 0.3, AGENT);
    }
}

impl Dynamics for WindyGridworldDynamics {
    fn transition(
        &self,
        state: &State,
        action: &usize,
        rng: &mut Generator,
    ) -> Result<Transition<State>> {
        let moves = if self.config.king {
            &MOVES[..]
        } else {
            &MOVES[..4]
        };
        let Some([down, right]) = moves.get(*action) else {
            return Err(Error::InvalidAction {
                action: action.to_string(),
                space: self.action_space().to_string(),
                hint: String::new(),
            });
        };
        let mean = WIND[state.column as usize];
        let wind = if self.config.stochastic && mean > 0 {
            mean + rng.integers(-1, 2)
        } else {
            mean
        };
        let row = (state.row + down - wind).clamp(0, ROWS - 1);
        let column = (state.column + right).clamp(0, COLUMNS - 1);
        Ok(Transition {
            state: State { row, column, wind },
            reward: -1.0,
            terminated: [row, column] == GOAL,
        })
    }

    fn observe(&self, state: &State) -> i64 {
        state.row * COLUMNS + state.column
    }
}

const CELL: f64 = 40.0; // pixels
const LINE: Color = Color::rgb(160, 170, 184);
/// The colours of the sky by the strength of the wind.
const SKY: [Color; 3] = [
    Color::rgb(240, 244, 248),
    Color::rgb(206, 222, 240),
    Color::rgb(170, 198, 230),
];
const MEADOW: Color = Color::rgb(128, 190, 110);
const AGENT: Color = Color::rgb(210, 84, 60);

/// A detour around the wind: right to the last column, down below the goal, and back.
fn around_the_wind(cell: &i64) -> usize {
    match (cell / COLUMNS, cell % COLUMNS) {
        (4.., 8..) => 3,
        (_, 9) => 1,
        _ => 2,
    }
}

/// The registration shared by both ids.
const fn gridworld(id: &'static str) -> Registration {
    Registration::new::<WindyGridworld>(id)
        .description("Reach the goal across a wind that blows upwards.")
        .max_episode_steps(200)
        .light_step()
        .keys(|env| match env.action_space() {
            Space::Discrete(space) if space.n() == 8 => Keys::new(json!({
                "Up": 0, "Down": 1, "Right": 2, "Left": 3, "E": 4, "C": 5, "Y": 6, "Q": 7
            })),
            _ => Keys::new(json!({"Up": 0, "Down": 1, "Right": 2, "Left": 3})),
        })
        .policy(Policy::rules("goes around the wind", |_| {
            reflex(around_the_wind)
        }))
}

gym_core::register!(
    gridworld("sutton/WindyGridworld-v0").clip(Clip {
        seeds: 0..1,
        every: 1,
        frames: 20,
        size: (200, 140)
    }),
    gridworld("sutton/WindyGridworldKings-v0")
        .kwargs(r#"{"king": true, "stochastic": true}"#)
        .description("Reach the goal across a wind that varies, with the moves of a king."),
);
