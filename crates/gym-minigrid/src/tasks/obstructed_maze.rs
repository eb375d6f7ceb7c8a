//! ObstructedMaze: find the blue ball behind locked doors, whose keys lie in boxes, and which balls obstruct.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`] |
//! | reward | `1 - 0.9 * steps / max_steps` for the blue ball, else 0 |
//! | start | two rooms, or three by three with locked doors on the way to the corners; the ball lies in a corner |
//! | end | terminated by picking up the blue ball |
//! | limit | 144 steps for each room to visit |
//!
//! Source: minigrid 3.2.0, `envs/obstructedmaze.py` and `envs/obstructedmaze_v1.py`.

use gym_core::registry::Exceptions;
use gym_core::{Generator, Outcome};

use super::{ids, pick_up, square};
use crate::env::WINDOW;
use crate::level::{Level, Rules, level};
use crate::rooms::{Rooms, grid_size};
use crate::{Action, Color, Draft, Generated, Kind, Pos, World};

/// Columns and rows of a room, walls included.
const ROOM_SIZE: u32 = 6;
/// The colour of the ball to find.
const BALL: Color = Color::SORTED[0];
/// The colour of the balls that block doors.
const BLOCKING: Color = Color::SORTED[1];
/// The colour of boxes.
const BOX: Color = Color::SORTED[2];
/// Columns and rows of the rooms beside the middle room.
const SIDES: [(i32, i32); 4] = [(2, 1), (1, 2), (0, 1), (1, 0)];
const CORNERS: [(i32, i32); 4] = [(2, 0), (2, 2), (0, 2), (0, 0)];

fn rules(columns: u32, rows: u32, visited: u32) -> Result<Rules, String> {
    let [width, height] = grid_size(ROOM_SIZE, columns, rows)?;
    if visited == 0 {
        return Err("num_rooms_visited is 0: at least one room is visited".into());
    }
    let steps = visited.saturating_mul(4 * square(ROOM_SIZE));
    Rules::new(width, height, steps, "").missions("pick up the {} ball", [vec![BALL.name()]])
}

fn mission(draft: &mut Draft<'_>) {
    draft.mission(format!("pick up the {} ball", BALL.name()));
}

/// Adds a locked door, optionally with a ball in front of it.
fn add_locked_door(
    rooms: &mut Rooms<'_, '_>,
    (column, row): (i32, i32),
    wall: usize,
    color: Color,
    blocked: bool,
) -> Generated {
    let (_, pos): (_, Pos) = rooms.add_door(column, row, Some(wall), Some(color), Some(true))?;
    if blocked {
        rooms.block(pos, wall, BLOCKING);
    }
    Ok(())
}

/// Places a key in a room, optionally in a box.
fn add_key(
    rooms: &mut Rooms<'_, '_>,
    (column, row): (i32, i32),
    color: Color,
    in_box: bool,
) -> Generated {
    let key = rooms.draft.object(Kind::Key, color);
    let cell = if in_box {
        rooms.draft.box_of(BOX, key)
    } else {
        key
    };
    rooms.place(column, row, cell).map(|_| ())
}

level! {
    /// Arguments.
    ObstructedMaze1Dlhb {
        /// Whether the key lies in a box.
        pub key_in_box: bool = true,
        /// Whether a ball stands before the door.
        pub blocked: bool = true,
    }
}

impl Level for ObstructedMaze1Dlhb {
    fn rules(&self) -> Result<Rules, String> {
        rules(2, 1, 2)
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let mut rooms = Rooms::new(draft, ROOM_SIZE, 2, 1)?;
        let colors = rooms.draft.subset(&Color::SORTED, Color::SORTED.len())?;
        add_locked_door(&mut rooms, (0, 0), 0, colors[0], self.blocked)?;
        add_key(&mut rooms, (0, 0), colors[0], self.key_in_box)?;
        let target = rooms.add_object(1, 0, Some(Kind::Ball), Some(BALL))?;
        rooms.place_agent(Some((0, 0)))?;
        mission(draft);
        draft.world.targets.push(target);
        Ok(())
    }

    fn step(&self, world: &mut World, action: Action, _rng: &mut Generator) -> Outcome {
        pick_up(world, action)
    }
}

/// Defines the maze of three by three rooms. With `$late_keys`, keys are placed after the doors of
/// their room, so that a blocking ball cannot replace a key.
macro_rules! full {
    ($name:ident, $late_keys:literal) => {
        level! {
            /// Arguments.
            $name {
                /// The column and row of the room in which the agent starts.
                pub agent_room: [u32; 2] = [1, 1],
                /// Whether keys lie in boxes.
                pub key_in_box: bool = true,
                /// Whether balls stand before the locked doors.
                pub blocked: bool = true,
                /// The number of rooms around the middle one that have locked doors: up to 4.
                pub num_quarters: u32 = 4,
                /// The number of rooms to visit, which decides the limit of steps.
                pub num_rooms_visited: u32 = 25,
            }
        }

        impl Level for $name {
            fn rules(&self) -> Result<Rules, String> {
                let ([column, row], quarters) = (self.agent_room, self.num_quarters);
                if column > 2 || row > 2 {
                    return Err(format!(
                        "agent_room is [{column}, {row}]: there are 3 by 3 rooms"
                    ));
                }
                if !(1..=4).contains(&quarters) {
                    return Err(format!(
                        "num_quarters is {quarters}: from 1 to 4 are possible"
                    ));
                }
                rules(3, 3, self.num_rooms_visited)
            }

            fn generate(&self, draft: &mut Draft<'_>) -> Generated {
                let mut rooms = Rooms::new(draft, ROOM_SIZE, 3, 3)?;
                let colors = rooms.draft.subset(&Color::SORTED, Color::SORTED.len())?;
                let quarters = self.num_quarters as usize;
                for (i, room) in SIDES.into_iter().enumerate().take(quarters) {
                    rooms.add_door(1, 1, Some(i), Some(colors[i]), Some(false))?;
                    let walls = [(i + 3) % 4, (i + 1) % 4];
                    let colors = [colors[(i + 5) % 6], colors[(i + 1) % 6]];
                    for (wall, color) in walls.into_iter().zip(colors) {
                        add_locked_door(&mut rooms, room, wall, color, self.blocked)?;
                        if !$late_keys {
                            add_key(&mut rooms, room, color, self.key_in_box)?;
                        }
                    }
                    for color in colors.into_iter().filter(|_| $late_keys) {
                        add_key(&mut rooms, room, color, self.key_in_box)?;
                    }
                }
                let (column, row) = rooms.draft.pick(&CORNERS[..quarters])?;
                let target = rooms.add_object(column, row, Some(Kind::Ball), Some(BALL))?;
                let [column, row] = self.agent_room.map(|n| n as i32);
                rooms.place_agent(Some((column, row)))?;
                mission(draft);
                draft.world.targets.push(target);
                Ok(())
            }

            fn step(&self, world: &mut World, action: Action, _rng: &mut Generator) -> Outcome {
                pick_up(world, action)
            }
        }
    };
}
full!(ObstructedMazeFull, false);
full!(ObstructedMazeFullV1, true);

ids! { ObstructedMaze1Dlhb, "Find the blue ball behind obstructed doors.":
    "MiniGrid-ObstructedMaze-1Dl-v0", r#"{"key_in_box": false, "blocked": false}"#;
    "MiniGrid-ObstructedMaze-1Dlh-v0", r#"{"key_in_box": true, "blocked": false}"#;
    "MiniGrid-ObstructedMaze-1Dlhb-v0", "{}";
}

const VISITED: Exceptions = &[
    WINDOW,
    (
        "arguments-matter.num_rooms_visited",
        "it sets the limit alone, which is thousands of steps away",
    ),
];

ids! { ObstructedMazeFull, "Find the blue ball behind obstructed doors.", excused VISITED:
    "MiniGrid-ObstructedMaze-2Dl-v0",
        r#"{"agent_room": [2, 1], "key_in_box": false, "blocked": false, "num_quarters": 1, "num_rooms_visited": 4}"#;
    "MiniGrid-ObstructedMaze-2Dlh-v0",
        r#"{"agent_room": [2, 1], "key_in_box": true, "blocked": false, "num_quarters": 1, "num_rooms_visited": 4}"#;
    "MiniGrid-ObstructedMaze-2Dlhb-v0",
        r#"{"agent_room": [2, 1], "key_in_box": true, "blocked": true, "num_quarters": 1, "num_rooms_visited": 4}"#;
    "MiniGrid-ObstructedMaze-1Q-v0",
        r#"{"agent_room": [1, 1], "key_in_box": true, "blocked": true, "num_quarters": 1, "num_rooms_visited": 5}"#;
    "MiniGrid-ObstructedMaze-2Q-v0",
        r#"{"agent_room": [2, 1], "key_in_box": true, "blocked": true, "num_quarters": 2, "num_rooms_visited": 11}"#;
    "MiniGrid-ObstructedMaze-Full-v0", "{}";
}

ids! { ObstructedMazeFullV1, "Find the blue ball behind obstructed doors.", excused VISITED:
    "MiniGrid-ObstructedMaze-2Dlhb-v1",
        r#"{"agent_room": [2, 1], "key_in_box": true, "blocked": true, "num_quarters": 1, "num_rooms_visited": 4}"#;
    "MiniGrid-ObstructedMaze-1Q-v1",
        r#"{"agent_room": [1, 1], "key_in_box": true, "blocked": true, "num_quarters": 1, "num_rooms_visited": 5}"#;
    "MiniGrid-ObstructedMaze-2Q-v1",
        r#"{"agent_room": [2, 1], "key_in_box": true, "blocked": true, "num_quarters": 2, "num_rooms_visited": 11}"#;
    "MiniGrid-ObstructedMaze-Full-v1", "{}";
}
