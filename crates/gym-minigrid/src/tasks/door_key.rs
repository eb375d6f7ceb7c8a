//! DoorKey: pick up the key, open the door, and get to the goal.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`](crate::Action) |
//! | reward | `1 - 0.9 * steps / max_steps` in the goal, else 0 |
//! | start | a wall with a locked door divides the room; the agent and the key are on its left |
//! | end | terminated in the goal |
//! | limit | `10 * size * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/doorkey.py`.

use super::ids;
use crate::draft::Area;
use crate::level::{Level, Rules, level};
use crate::{Cell, Color, Draft, Generated, Kind, Pos, State};

level! {
    /// Arguments.
    DoorKey {
        /// Columns and rows of the grid, walls included.
        pub size: u32 = 8,
    }
}

impl Level for DoorKey {
    fn rules(&self) -> Result<Rules, String> {
        let mission = "use the key to open the door and then get to the goal";
        Ok(Rules::square(self.size, 10, mission))
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let (width, height) = (draft.width(), draft.height());
        draft.world.grid.surround();
        draft.put(Pos::new(width - 2, height - 2), Cell::GOAL);
        let split = draft.int(2, width - 2)?;
        draft.world.grid.vertical(split, 0, height, Cell::WALL);
        let left = Area::new(0, 0, split, height);
        draft.place_agent_in(left, u32::MAX)?;
        let door = Pos::new(split, draft.int(1, height - 2)?);
        draft.put(door, Cell::door(Color::Yellow, State::Locked));
        let key = Cell::new(Kind::Key, Color::Yellow);
        draft.place_if(key, left, u32::MAX, |_, _| true)?;
        Ok(())
    }
}

ids! { DoorKey, "Pick up the key, open the door, and get to the goal.", planned:
    "MiniGrid-DoorKey-5x5-v0", r#"{"size": 5}"#;
    "MiniGrid-DoorKey-6x6-v0", r#"{"size": 6}"#;
    "MiniGrid-DoorKey-8x8-v0", r#"{"size": 8}"#;
    "MiniGrid-DoorKey-16x16-v0", r#"{"size": 16}"#;
}
