//! Maps: the argument `maze_map`.

use gym_core::{Error, Result};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

/// The largest number of cells.
const MOST: usize = 10_000;
/// The largest number of walls: a model has up to 1000 shapes.
const MOST_WALLS: usize = 950;

/// A cell of a maze.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cell {
    /// 0: without a wall.
    Free,
    /// 1: a wall.
    Wall,
    /// `"g"`: may have the goal.
    Goal,
    /// `"r"`: may be the start.
    Start,
    /// `"c"`: may have the goal, or be the start.
    Both,
}

/// The cells of a maze, row by row, from the largest y to the smallest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Vec<Json>>", into = "Vec<Vec<Json>>")]
pub struct Map {
    rows: Vec<Vec<Cell>>,
}

impl Default for Map {
    /// A passage in the shape of a U: Gymnasium-Robotics' `U_MAZE`.
    fn default() -> Self {
        let rows = ["#####", "#   #", "### #", "#   #", "#####"];
        let cell = |c: char| if c == '#' { Cell::Wall } else { Cell::Free };
        let rows = rows.map(|row| row.chars().map(cell).collect());
        Self { rows: rows.into() }
    }
}

impl Map {
    /// Numbers of rows and columns.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.rows.len(), self.rows.first().map_or(0, Vec::len)]
    }

    /// The cell in a row and a column; `None` outside of the maze.
    #[must_use]
    pub fn get(&self, row: usize, column: usize) -> Option<Cell> {
        self.rows.get(row)?.get(column).copied()
    }

    /// The cells, each with its row and its column.
    pub(crate) fn cells(&self) -> impl Iterator<Item = (usize, usize, Cell)> {
        let rows = self.rows.iter().enumerate();
        rows.flat_map(|(i, row)| row.iter().enumerate().map(move |(j, cell)| (i, j, *cell)))
    }

    /// Refuses a map that is empty, too large, no rectangle, or has too many walls.
    pub(crate) fn check(&self) -> Result<()> {
        let [rows, columns] = self.size();
        let refuse = |reason: String| Err(Error::argument("maze_map", reason));
        if columns == 0 {
            return refuse("it has no cells: give a list of rows".to_owned());
        }
        if let Some(row) = self.rows.iter().position(|row| row.len() != columns) {
            let found = self.rows[row].len();
            return refuse(format!(
                "row {row} has {found} cells and row 0 has {columns}: give all rows the same length"
            ));
        }
        if rows * columns > MOST {
            return refuse(format!(
                "{rows} rows of {columns} are {} cells: give at most {MOST}",
                rows * columns
            ));
        }
        let walls = self
            .cells()
            .filter(|(_, _, cell)| *cell == Cell::Wall)
            .count();
        if walls > MOST_WALLS {
            return refuse(format!(
                "it has {walls} walls: give at most {MOST_WALLS}, without those that no free cell touches"
            ));
        }
        Ok(())
    }
}

impl TryFrom<Vec<Vec<Json>>> for Map {
    type Error = String;

    fn try_from(given: Vec<Vec<Json>>) -> std::result::Result<Self, String> {
        let mut rows = Vec::with_capacity(given.len());
        for (i, row) in given.iter().enumerate() {
            let mut cells = Vec::with_capacity(row.len());
            for (j, cell) in row.iter().enumerate() {
                cells.push(read(cell).ok_or_else(|| {
                    format!(
                        "the cell in row {i}, column {j} is {}: it is 0 (free), 1 (a wall), \"g\" (goal), \"r\" (start) or \
                         \"c\" (both)",
                        gym_core::printable(&cell.to_string())
                    )
                })?);
            }
            rows.push(cells);
        }
        Ok(Self { rows })
    }
}

fn read(cell: &Json) -> Option<Cell> {
    match (cell.as_f64(), cell.as_str()) {
        (Some(0.0), _) => Some(Cell::Free),
        (Some(1.0), _) => Some(Cell::Wall),
        (_, Some("g")) => Some(Cell::Goal),
        (_, Some("r")) => Some(Cell::Start),
        (_, Some("c")) => Some(Cell::Both),
        _ => None,
    }
}

impl From<Map> for Vec<Vec<Json>> {
    fn from(map: Map) -> Self {
        let write = |cell| match cell {
            Cell::Free => Json::from(0),
            Cell::Wall => Json::from(1),
            Cell::Goal => Json::from("g"),
            Cell::Start => Json::from("r"),
            Cell::Both => Json::from("c"),
        };
        let rows = map.rows.into_iter();
        rows.map(|row| row.into_iter().map(write).collect())
            .collect()
    }
}

impl gym_core::ArgumentType for Map {
    fn kind() -> String {
        "list of lists of cells".to_owned()
    }
}
