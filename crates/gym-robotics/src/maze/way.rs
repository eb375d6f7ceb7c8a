//! The way through a maze, for a good policy.

use super::{Cell, Map, Maze};

/// The distances of all cells from the one with the goal.
#[derive(Debug, Default)]
pub(crate) struct Way {
    goal: Option<[usize; 2]>,
    /// The number of cells to the goal, row by row; `None` where no way leads to it.
    lengths: Vec<Option<u32>>,
}

impl Way {
    /// The place to go to from `place`: the middle of the next cell, or the goal in its own cell.
    pub(crate) fn next(&mut self, maze: &Maze, place: [f64; 2], goal: [f64; 2]) -> [f64; 2] {
        let (Some(own), Some(last)) = (maze.cell(place), maze.cell(goal)) else {
            return goal;
        };
        if self.goal != Some(last) {
            self.goal = Some(last);
            self.measure(&maze.map, last);
        }
        let length = |cell: &[usize; 2]| self.length(&maze.map, *cell);
        let nearest = neighbours(own).filter_map(|cell| Some((length(&cell)?, cell)));
        match nearest.min() {
            Some((_, [row, column])) if own != last => maze.center(row, column),
            _ => goal,
        }
    }

    fn length(&self, map: &Map, [row, column]: [usize; 2]) -> Option<u32> {
        map.get(row, column)?;
        self.lengths[row * map.size()[1] + column]
    }

    fn measure(&mut self, map: &Map, goal: [usize; 2]) {
        let [rows, columns] = map.size();
        self.lengths.clear();
        self.lengths.resize(rows * columns, None);
        self.lengths[goal[0] * columns + goal[1]] = Some(0);
        let mut reached = vec![goal];
        for length in 1.. {
            let mut next = Vec::new();
            for [row, column] in reached.drain(..).flat_map(neighbours) {
                let free = map.get(row, column).is_some_and(|cell| cell != Cell::Wall);
                if free && self.lengths[row * columns + column].is_none() {
                    self.lengths[row * columns + column] = Some(length);
                    next.push([row, column]);
                }
            }
            if next.is_empty() {
                return;
            }
            reached = next;
        }
    }
}

/// The cells beside a cell; some are outside of the maze.
fn neighbours([row, column]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    [
        [row.wrapping_sub(1), column],
        [row + 1, column],
        [row, column.wrapping_sub(1)],
        [row, column + 1],
    ]
    .into_iter()
}
