//! Mazes: a map of cells, the walls that it stands for, and the task of an agent between them.

mod ids;
mod map;
mod task;
mod way;

pub(crate) use ids::mazes;
pub use map::{Cell, Map};
pub(crate) use task::{Agent, make};
pub(crate) use way::Way;

use gym_core::registry::Exceptions;
use gym_core::{Error, Kwargs, Result};
use serde_json::Value as Json;

use crate::RewardType;

gym_core::arguments! {
    /// The arguments that all mazes share.
    pub struct MazeArguments {
        /// The cells, row by row from the largest y to the smallest: 1 is a wall, 0 is free, `"g"`
        /// may have the goal, `"r"` may be the start, and `"c"` may be both. Without letters, each
        /// free cell may be both. At most 10,000 cells and 950 walls.
        pub maze_map: Map,
        /// The reward: `"sparse"`, which is 1 within 0.45 m of the goal and 0 elsewhere, or
        /// `"dense"`, the exponential of minus the distance in m.
        pub reward_type: RewardType,
        /// Whether the episode goes on at the goal.
        pub continuing_task: bool = true,
        /// Whether an agent that reaches the goal gets another one, in a continuing task.
        #[versions = 4..]
        pub reset_target: bool = false,
    }
}

/// What conformance cannot see of a maze.
pub(crate) const AT_THE_GOAL: Exceptions = &[
    ("arguments-matter.continuing_task", UNREACHED),
    ("arguments-matter.reset_target", UNREACHED),
];
const UNREACHED: &str = "it matters at the goal, which random actions do not reach";

/// The extent of the noise of goals and starts, as a share of a cell.
const NOISE: f64 = 0.25;

/// A map in the world: the places of goals and starts.
#[derive(Clone, Debug)]
pub(crate) struct Maze {
    map: Map,
    /// The width of a cell in m.
    scale: f64,
    /// The height of the walls, as a share of the width of a cell.
    height: f64,
    goals: Vec<[f64; 2]>,
    starts: Vec<[f64; 2]>,
    /// Whether it has the rules of AntMaze-v3: all free cells do not stand in for letters that a
    /// map with other letters lacks, starts are as near to goals as in a maze with cells of 1 m,
    /// and a step is rewarded after the goal has changed.
    old: bool,
}

impl Maze {
    /// The maze of a map, with cells of a width of `scale` m.
    pub(crate) fn new(map: &Map, scale: f64, height: f64, old: bool) -> Result<Self> {
        map.check()?;
        let mut maze = Self {
            map: map.clone(),
            scale,
            height,
            goals: Vec::new(),
            starts: Vec::new(),
            old,
        };
        let places = |kind: Cell| -> Vec<[f64; 2]> {
            let cells = map.cells().filter(|(_, _, cell)| *cell == kind);
            cells
                .map(|(row, column, _)| maze.center(row, column))
                .collect()
        };
        let [mut goals, mut starts] = [Cell::Goal, Cell::Start].map(places);
        let [mut both, free] = [Cell::Both, Cell::Free].map(places);
        let lacking = (goals.is_empty(), starts.is_empty(), both.is_empty());
        match lacking {
            (true, true, true) => both = free,
            (false, true, true) if !old => starts = free,
            (true, false, true) if !old => goals = free,
            _ => {}
        }
        goals.extend(&both);
        starts.extend(&both);
        (maze.goals, maze.starts) = (goals, starts);
        for (what, letter, cells) in [("goal", 'g', &maze.goals), ("start", 'r', &maze.starts)] {
            if cells.is_empty() {
                let reason =
                    format!("no cell may be the {what}: mark one \"{letter}\", \"c\" or 0");
                return Err(Error::argument("maze_map", reason));
            }
        }
        match maze.goals.iter().find(|goal| maze.only_start_is(goal)) {
            Some(_) => {
                let reason = "the only cell for the start is also one for the goal, and an episode starts apart from its \
                              goal: mark another cell \"r\" or \"c\"";
                Err(Error::argument("maze_map", reason))
            }
            None => Ok(maze),
        }
    }

    /// Whether this place is the only start.
    fn only_start_is(&self, place: &[f64; 2]) -> bool {
        matches!(&self.starts[..], [start] if start == place)
    }

    /// The centre of a cell.
    fn center(&self, row: usize, column: usize) -> [f64; 2] {
        let [rows, columns] = self.map.size().map(|n| n as f64 / 2.0 * self.scale);
        [
            (column as f64 + 0.5) * self.scale - columns,
            rows - (row as f64 + 0.5) * self.scale,
        ]
    }

    /// The row and the column of the cell around a place; `None` outside of the maze.
    fn cell(&self, [x, y]: [f64; 2]) -> Option<[usize; 2]> {
        let [rows, columns] = self.map.size().map(|n| n as f64 / 2.0);
        let cell = [rows - y / self.scale, columns + x / self.scale];
        let [row, column] = cell.map(|x| if x >= 0.0 { x as usize } else { usize::MAX });
        self.map.get(row, column).map(|_| [row, column])
    }

    /// The height of the middle of the walls, in m.
    pub(crate) fn middle(&self) -> f64 {
        self.height / 2.0 * self.scale
    }

    /// The distance from which the free camera sees the whole maze, in m.
    pub(crate) fn extent(&self) -> f64 {
        let [rows, columns] = self.map.size();
        rows.max(columns) as f64 * self.scale
    }

    /// The agent's model, in MJCF, with the walls and a site that shows the goal.
    pub(crate) fn model(&self, agent: &str) -> Result<String> {
        let Some((before, after)) = agent.split_once("</worldbody>") else {
            let reason = "the model has no `<worldbody>`, to which the walls could be added";
            return Err(Error::argument("xml_file", reason));
        };
        let (middle, half) = (self.middle(), 0.5 * self.scale);
        let walls = self.map.cells().filter(|(_, _, cell)| *cell == Cell::Wall);
        let mut text = before.trim_start().to_owned();
        for (row, column, _) in walls {
            let [x, y] = self.center(row, column);
            text += &format!(
                "<geom name=\"block_{row}_{column}\" type=\"box\" pos=\"{x} {y} {middle}\" size=\"{half} {half} {middle}\" \
                 contype=\"1\" conaffinity=\"1\" rgba=\"0.7 0.5 0.3 1\"/>\n"
            );
        }
        let radius = 0.2 * self.scale;
        text += &format!(
            "<site name=\"target\" pos=\"0 0 {middle}\" size=\"{radius}\" rgba=\"1 0 0 0.7\"/></worldbody>{after}"
        );
        Ok(text)
    }

    /// The place that a reset option names: the centre of the cell `[row, column]`.
    fn place(&self, options: &Kwargs, name: &str) -> Result<Option<[f64; 2]>> {
        let Some(given) = options.get(name).filter(|given| !given.is_null()) else {
            return Ok(None);
        };
        let index = |k: usize| given.get(k).and_then(Json::as_u64);
        let (cell, [rows, columns]) = ([index(0), index(1)], self.map.size());
        let wrong = |why: &str| {
            let reason = format!(
                "{given} {why}: give [row, column] of a cell without a wall, of {rows} rows and {columns} columns"
            );
            Err(Error::argument(name, reason))
        };
        let [Some(row), Some(column)] = cell else {
            return wrong("is not a cell");
        };
        let (row, column) = (row as usize, column as usize);
        match self.map.get(row, column) {
            None => wrong("is outside of the maze"),
            Some(_) if given.as_array().is_none_or(|cell| cell.len() != 2) => {
                wrong("is not a cell")
            }
            Some(Cell::Wall) => wrong("is a wall"),
            Some(_) => Ok(Some(self.center(row, column))),
        }
    }

    /// The places of goal and start that reset options name.
    pub(crate) fn places(&self, options: &Kwargs) -> Result<[Option<[f64; 2]>; 2]> {
        let places = [
            self.place(options, "goal_cell")?,
            self.place(options, "reset_cell")?,
        ];
        if let [Some(goal), None] = &places
            && self.only_start_is(goal)
        {
            let reason = "it is the only cell for the start, and an episode starts apart from its goal: give `reset_cell` too";
            return Err(Error::argument("goal_cell", reason));
        }
        Ok(places)
    }
}
