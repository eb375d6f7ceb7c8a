//! LockedRoom: find the key, unlock the door of its colour, and go to the goal behind it.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`](crate::Action) |
//! | reward | `1 - 0.9 * steps / max_steps` in the goal, else 0 |
//! | start | three rooms on each side of a corridor, which the agent is in; the goal lies in the locked room, the key in another |
//! | end | terminated in the goal |
//! | limit | `10 * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/lockedroom.py`.

use super::{ids, inside};
use crate::draft::Area;
use crate::level::{Level, Rules, level};
use crate::{Cell, Color, Draft, Generated, Kind, Pos, State};

const MISSION: &str = "get the {} key from the {} room, unlock the {} door and go to the goal";

level! {
    /// Arguments.
    LockedRoom {
        /// Columns and rows of the grid, walls included.
        pub size: u32 = 19,
    }
}

impl Level for LockedRoom {
    fn rules(&self) -> Result<Rules, String> {
        let rules = Rules::new(self.size, self.size, self.size.saturating_mul(10), "");
        rules.missions(MISSION, vec![Color::names(); 3])
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let (width, height) = (draft.width(), draft.height());
        draft.world.grid.surround();
        let (left, right) = (width / 2 - 2, width / 2 + 2);
        draft.world.grid.vertical(left, 0, height, Cell::WALL);
        draft.world.grid.vertical(right, 0, height, Cell::WALL);
        // each room and its door
        let mut rooms = Vec::new();
        for n in 0..3 {
            let y = n * (height / 3);
            draft.world.grid.horizontal(0, y, left, Cell::WALL);
            draft
                .world
                .grid
                .horizontal(right, y, width - right, Cell::WALL);
            let (room_w, room_h) = (left + 1, height / 3 + 1);
            rooms.push((Area::new(0, y, room_w, room_h), Pos::new(left, y + 3)));
            rooms.push((Area::new(right, y, room_w, room_h), Pos::new(right, y + 3)));
        }
        let locked = draft.int(0, rooms.len() as i32)? as usize;
        let goal = inside(draft, rooms[locked].0)?;
        draft.put(goal, Cell::GOAL);

        let mut rest = Color::SORTED.to_vec();
        let mut colors = Vec::new();
        for (index, (_, door)) in rooms.iter().enumerate() {
            let color = draft.pick(&rest)?;
            rest.retain(|other| *other != color);
            colors.push(color);
            let state = if index == locked {
                State::Locked
            } else {
                State::Closed
            };
            draft.put(*door, Cell::door(color, state));
        }
        let key_room = loop {
            let index = draft.int(0, rooms.len() as i32)? as usize;
            if index != locked {
                break index;
            }
        };
        let key = inside(draft, rooms[key_room].0)?;
        draft.put(key, Cell::new(Kind::Key, colors[locked]));
        draft.place_agent_in(Area::new(left, 0, right - left, height), u32::MAX)?;
        let (color, room) = (colors[locked].name(), colors[key_room].name());
        draft.mission(format!(
            "get the {color} key from the {room} room, unlock the {color} door and go to the goal"
        ));
        Ok(())
    }
}

ids! { LockedRoom, "Find the key, unlock the door, and go to the goal behind it.", planned:
    "MiniGrid-LockedRoom-v0", "{}";
}
