//! Crossing: get through the gaps in rivers of lava, or in walls.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`](crate::Action): left, right, forward; the others have no effect here |
//! | reward | `1 - 0.9 * steps / max_steps` in the goal, else 0 |
//! | start | in the top left corner, looking right |
//! | end | terminated in the goal and in lava |
//! | limit | `4 * size * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/crossing.py`.

use gym_core::ArgumentType;
use serde::{Deserialize, Serialize};

use super::ids;
use crate::level::{Level, Rules, level};
use crate::{Cell, Draft, Generated, Pos};

/// The kind of obstacle in the agent's way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Obstacle {
    /// Lava, which can be seen across and ends the episode.
    Lava,
    /// Walls.
    Wall,
}

impl Obstacle {
    pub(crate) fn cell(self) -> Cell {
        match self {
            Self::Lava => Cell::LAVA,
            Self::Wall => Cell::WALL,
        }
    }

    pub(crate) fn mission(self) -> &'static str {
        match self {
            Self::Lava => "avoid the lava and get to the green goal square",
            Self::Wall => "find the opening and get to the green goal square",
        }
    }
}

impl ArgumentType for Obstacle {
    fn kind() -> String {
        "`lava` or `wall`".to_owned()
    }
}

level! {
    /// Arguments.
    Crossing {
        /// Columns and rows of the grid, walls included; an odd number.
        pub size: u32 = 9,
        /// The number of rivers.
        pub num_crossings: u32 = 1,
        /// What the rivers are made of.
        pub obstacle_type: Obstacle = Obstacle::Lava,
    }
}

impl Level for Crossing {
    fn rules(&self) -> Result<Rules, String> {
        if self.size.is_multiple_of(2) {
            return Err(format!("size is {}: it is an odd number", self.size));
        }
        Ok(Rules::square(self.size, 4, self.obstacle_type.mission()))
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let (width, height) = (draft.width(), draft.height());
        draft.world.grid.surround();
        draft.put_agent(Pos::new(1, 1), 0);
        draft.put(Pos::new(width - 2, height - 2), Cell::GOAL);

        // for each river: whether it is vertical, and its column or row
        let down = (2..height - 2).step_by(2).map(|x| (true, x));
        let mut rivers: Vec<(bool, i32)> = down
            .chain((2..width - 2).step_by(2).map(|y| (false, y)))
            .collect();
        draft.shuffle(&mut rivers);
        rivers.truncate(self.num_crossings as usize);
        rivers.sort_unstable();
        let of = |down: bool| {
            let rivers = rivers.iter().filter(move |river| river.0 == down);
            rivers.map(|river| river.1).collect::<Vec<i32>>()
        };
        let (columns, rows) = (of(true), of(false));
        for &y in &rows {
            draft
                .world
                .grid
                .horizontal(1, y, width - 2, self.obstacle_type.cell());
        }
        for &x in &columns {
            draft
                .world
                .grid
                .vertical(x, 1, height - 2, self.obstacle_type.cell());
        }

        // a path to the goal: for each step, whether it crosses a vertical river
        let mut path: Vec<bool> = columns
            .iter()
            .map(|_| true)
            .chain(rows.iter().map(|_| false))
            .collect();
        draft.shuffle(&mut path);
        let limits = |rivers: &[i32], last: i32| [&[0], rivers, &[last]].concat();
        let (columns, rows) = (limits(&columns, height - 1), limits(&rows, width - 1));
        let (mut i, mut j) = (0, 0);
        for crosses_column in path {
            let gap = if crosses_column {
                i += 1;
                Pos::new(columns[i], draft.int(rows[j] + 1, rows[j + 1])?)
            } else {
                j += 1;
                Pos::new(draft.int(columns[i] + 1, columns[i + 1])?, rows[j])
            };
            draft.put(gap, Cell::EMPTY);
        }
        Ok(())
    }
}

ids! { Crossing, "Get across rivers of lava to the goal.", planned:
    "MiniGrid-LavaCrossingS9N1-v0", r#"{"size": 9, "num_crossings": 1}"#;
    "MiniGrid-LavaCrossingS9N2-v0", r#"{"size": 9, "num_crossings": 2}"#;
    "MiniGrid-LavaCrossingS9N3-v0", r#"{"size": 9, "num_crossings": 3}"#;
    "MiniGrid-LavaCrossingS11N5-v0", r#"{"size": 11, "num_crossings": 5}"#;
}

ids! { Crossing, "Get through the gaps in walls to the goal.", planned:
    "MiniGrid-SimpleCrossingS9N1-v0",
        r#"{"size": 9, "num_crossings": 1, "obstacle_type": "wall"}"#;
    "MiniGrid-SimpleCrossingS9N2-v0",
        r#"{"size": 9, "num_crossings": 2, "obstacle_type": "wall"}"#;
    "MiniGrid-SimpleCrossingS9N3-v0",
        r#"{"size": 9, "num_crossings": 3, "obstacle_type": "wall"}"#;
    "MiniGrid-SimpleCrossingS11N5-v0",
        r#"{"size": 11, "num_crossings": 5, "obstacle_type": "wall"}"#;
}
