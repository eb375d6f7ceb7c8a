//! Playground: nine rooms with doors and objects, and nothing to do.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`](crate::Action) |
//! | reward | 0 |
//! | start | doors, objects and the agent at random |
//! | end | never |
//! | limit | 100 steps |
//!
//! Source: minigrid 3.2.0, `envs/playground.py`.

use super::ids;
use crate::level::{Level, Rules, level};
use crate::rooms::KINDS;
use crate::{Cell, Draft, Generated, Pos, State};

/// Columns and rows of the grid, walls included.
const SIZE: u32 = 19;
const OBJECTS: u32 = 12;

level! {
    /// Arguments.
    Playground {}
}

impl Level for Playground {
    fn rules(&self) -> Result<Rules, String> {
        Ok(Rules::new(SIZE, SIZE, 100, ""))
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        draft.world.grid.surround();
        let (room_w, room_h) = (draft.width() / 3, draft.height() / 3);
        for (j, i) in (0..3).flat_map(|j| (0..3).map(move |i| (j, i))) {
            let (left, top) = (i * room_w, j * room_h);
            let (right, bottom) = (left + room_w, top + room_h);
            if i < 2 {
                draft.world.grid.vertical(right, top, room_h, Cell::WALL);
                let pos = Pos::new(right, draft.int(top + 1, bottom - 1)?);
                let color = draft.color()?;
                draft.put(pos, Cell::door(color, State::Closed));
            }
            if j < 2 {
                draft
                    .world
                    .grid
                    .horizontal(left, bottom, room_w, Cell::WALL);
                let pos = Pos::new(draft.int(left + 1, right - 1)?, bottom);
                let color = draft.color()?;
                draft.put(pos, Cell::door(color, State::Closed));
            }
        }
        draft.place_agent()?;
        for _ in 0..OBJECTS {
            let kind = draft.pick(&KINDS)?;
            let color = draft.color()?;
            draft.place(Cell::new(kind, color))?;
        }
        Ok(())
    }
}

ids! { Playground, "Play with doors and objects in nine rooms.":
    "MiniGrid-Playground-v0", "{}";
}
