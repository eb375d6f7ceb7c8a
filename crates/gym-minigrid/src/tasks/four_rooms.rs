//! FourRooms: find the goal in four rooms with gaps between them.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`](crate::Action): left, right, forward; the others have no effect here |
//! | reward | `1 - 0.9 * steps / max_steps` in the goal, else 0 |
//! | start | the gaps, the agent and the goal at random |
//! | end | terminated in the goal |
//! | limit | 100 steps |
//!
//! Source: minigrid 3.2.0, `envs/fourrooms.py`.

use super::ids;
use crate::level::{Level, Rules, level};
use crate::{Cell, Draft, Generated, Pos};

/// Columns and rows of the grid, walls included.
const SIZE: u32 = 19;

level! {
    /// Arguments.
    FourRooms {
        /// Where the agent starts; at random if null.
        pub agent_pos: Option<[u32; 2]>,
        /// Where the goal lies; at random if null.
        pub goal_pos: Option<[u32; 2]>,
    }
}

impl Level for FourRooms {
    fn rules(&self) -> Result<Rules, String> {
        Ok(Rules::new(SIZE, SIZE, 100, "reach the goal"))
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        draft.world.grid.surround();
        let (room_w, room_h) = (draft.width() / 2, draft.height() / 2);
        for (j, i) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let (left, top) = (i * room_w, j * room_h);
            let (right, bottom) = (left + room_w, top + room_h);
            if i == 0 {
                draft.world.grid.vertical(right, top, room_h, Cell::WALL);
                let gap = Pos::new(right, draft.int(top + 1, bottom)?);
                draft.put(gap, Cell::EMPTY);
            }
            if j == 0 {
                draft
                    .world
                    .grid
                    .horizontal(left, bottom, room_w, Cell::WALL);
                let gap = Pos::new(draft.int(left + 1, right)?, bottom);
                draft.put(gap, Cell::EMPTY);
            }
        }
        match self.agent_pos {
            Some(pos) => {
                draft.put(pos.into(), Cell::EMPTY);
                let direction = draft.int(0, 4)? as u8;
                draft.put_agent(pos, direction);
            }
            None => draft.place_agent()?,
        }
        match self.goal_pos {
            Some(pos) => draft.put(pos.into(), Cell::GOAL),
            None => {
                draft.place(Cell::GOAL)?;
            }
        }
        Ok(())
    }
}

ids! { FourRooms, "Find the goal in four rooms.", planned:
    "MiniGrid-FourRooms-v0", "{}";
}
