//! MultiRoom: traverse a chain of rooms, through doors, to the goal in the last one.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`](crate::Action) |
//! | reward | `1 - 0.9 * steps / max_steps` in the goal, else 0 |
//! | start | in the first room, at random |
//! | end | terminated in the goal |
//! | limit | 20 steps for each room |
//!
//! Source: minigrid 3.2.0, `envs/multiroom.py`.

#![expect(non_snake_case, reason = "arguments have minigrid's names")]

use super::ids;
use crate::draft::Area;
use crate::level::{Level, Rules, level};
use crate::{Cell, Color, Draft, Generated, Pos, State};

/// The smallest width of a room.
const MIN_SIZE: i32 = 4;

/// A room, and the door through which the agent enters it.
type Room = (Area, Pos);

level! {
    /// Arguments.
    MultiRoom {
        /// The least number of rooms.
        pub minNumRooms: u32,
        /// The greatest number of rooms.
        pub maxNumRooms: u32,
        /// The widest room, walls included: at least 4.
        pub maxRoomSize: u32 = 10,
        /// The number of columns.
        pub width: u32 = 25,
        /// The number of rows.
        pub height: u32 = 25,
    }
}

impl Level for MultiRoom {
    fn rules(&self) -> Result<Rules, String> {
        let (least, most) = (self.minNumRooms, self.maxNumRooms);
        if least == 0 || least > most || most > 1000 {
            return Err(format!(
                "from {least} to {most} rooms: from 1 to 1000 are possible"
            ));
        }
        if !(4..=255).contains(&self.maxRoomSize) {
            return Err(format!(
                "maxRoomSize is {}: from 4 to 255 are possible",
                self.maxRoomSize
            ));
        }
        Ok(Rules::new(
            self.width,
            self.height,
            most * 20,
            "traverse the rooms to get to the goal",
        ))
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let (least, most) = (self.minNumRooms as i32, self.maxNumRooms as i32);
        let count = draft.int(least, most + 1)? as usize;
        let mut rooms = Vec::new();
        while rooms.len() < count {
            let x = draft.int(0, draft.width() - 2)?;
            // as in minigrid, the range of rows uses the width of the grid
            let door = Pos::new(x, draft.int(0, draft.width() - 2)?);
            let mut chain = Vec::new();
            self.add_room(draft, count, &mut chain, 2, door)?;
            if chain.len() > rooms.len() {
                rooms = chain;
            }
        }
        let mut last = None;
        for (index, (Area { top, size }, door)) in rooms.iter().enumerate() {
            draft.world.grid.wall_rect(top.x, top.y, size.x, size.y);
            if index > 0 {
                let mut colors = Color::SORTED.to_vec();
                colors.retain(|color| Some(*color) != last);
                let color = draft.pick(&colors)?;
                draft.put(*door, Cell::door(color, State::Closed));
                last = Some(color);
            }
        }
        draft.place_agent_in(rooms[0].0, u32::MAX)?;
        draft.place_if(Cell::GOAL, rooms[rooms.len() - 1].0, u32::MAX, |_, _| true)?;
        Ok(())
    }
}

impl MultiRoom {
    /// Adds a room with a door in its wall `entry`, and up to `left - 1` further rooms behind it.
    /// Returns whether the room fits.
    fn add_room(
        &self,
        draft: &mut Draft<'_>,
        left: usize,
        rooms: &mut Vec<Room>,
        entry: usize,
        door: Pos,
    ) -> Generated<bool> {
        let max = self.maxRoomSize as i32;
        let width = draft.int(MIN_SIZE, max + 1)?;
        let height = draft.int(MIN_SIZE, max + 1)?;
        let top = if rooms.is_empty() {
            door
        } else {
            match entry {
                0 | 2 => {
                    let y = draft.int(door.y - height + 2, door.y)?;
                    Pos::new(
                        if entry == 0 {
                            door.x - width + 1
                        } else {
                            door.x
                        },
                        y,
                    )
                }
                _ => {
                    let x = draft.int(door.x - width + 2, door.x)?;
                    Pos::new(
                        x,
                        if entry == 1 {
                            door.y - height + 1
                        } else {
                            door.y
                        },
                    )
                }
            }
        };
        let end = top + Pos::new(width, height);
        if top.x < 0 || top.y < 0 || end.x > draft.width() || end.y >= draft.height() {
            return Ok(false);
        }
        let others = rooms.split_last().map_or(&[][..], |(_, others)| others);
        let is_apart = |(other, _): &Room| {
            let other_end = other.top + other.size;
            end.x < other.top.x
                || other_end.x <= top.x
                || end.y < other.top.y
                || other_end.y <= top.y
        };
        if !others.iter().all(is_apart) {
            return Ok(false);
        }
        rooms.push((Area::new(top.x, top.y, width, height), door));
        if left == 1 {
            return Ok(true);
        }
        for _ in 0..8 {
            let walls: Vec<usize> = (0..4).filter(|wall| *wall != entry).collect();
            let exit = draft.pick(&walls)?;
            let along = draft.int(1, if exit % 2 == 0 { height } else { width } - 1)?;
            let door = top
                + match exit {
                    0 => Pos::new(width - 1, along),
                    1 => Pos::new(along, height - 1),
                    2 => Pos::new(0, along),
                    _ => Pos::new(along, 0),
                };
            if self.add_room(draft, left - 1, rooms, (exit + 2) % 4, door)? {
                break;
            }
        }
        Ok(true)
    }
}

ids! { MultiRoom, "Traverse a chain of rooms to the goal.", planned:
    "MiniGrid-MultiRoom-N2-S4-v0", r#"{"minNumRooms": 2, "maxNumRooms": 2, "maxRoomSize": 4}"#;
    "MiniGrid-MultiRoom-N4-S5-v0", r#"{"minNumRooms": 6, "maxNumRooms": 6, "maxRoomSize": 5}"#;
    "MiniGrid-MultiRoom-N4-S5-v1", r#"{"minNumRooms": 4, "maxNumRooms": 4, "maxRoomSize": 5}"#;
    "MiniGrid-MultiRoom-N6-v0", r#"{"minNumRooms": 6, "maxNumRooms": 6}"#;
}
