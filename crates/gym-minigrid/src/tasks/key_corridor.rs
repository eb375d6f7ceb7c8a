//! KeyCorridor: find the key, unlock the room, and pick up the object in it.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`] |
//! | reward | `1 - 0.9 * steps / max_steps` for the object, else 0 |
//! | start | three columns of rooms: the key lies in the left one, the object in a locked room of the right one, the agent in the corridor between them |
//! | end | terminated by picking up the object |
//! | limit | `30 * room_size * room_size` steps |
//!
//! Source: minigrid 3.2.0, `envs/keycorridor.py`.

use gym_core::{Generator, Outcome};

use super::{describe, ids, pick_up, square};
use crate::level::{Level, Rules, level};
use crate::rooms::{KINDS, Rooms, grid_size};
use crate::{Action, Cell, Color, Draft, Generated, Kind, World};

const COLUMNS: u32 = 3;

/// Turns the middle rooms into a corridor with the agent. Places an object in a locked room on the
/// right, and the key on the left. Returns the object.
pub(crate) fn add_corridor(rooms: &mut Rooms<'_, '_>, kind: Kind) -> Generated<Cell> {
    for j in 1..rooms.rows {
        rooms.remove_wall(1, j, 3)?;
    }
    let row = rooms.draft.int(0, rooms.rows)?;
    let (door, _) = rooms.add_door(2, row, Some(2), None, Some(true))?;
    let target = rooms.add_object(2, row, Some(kind), None)?;
    let row = rooms.draft.int(0, rooms.rows)?;
    rooms.add_object(0, row, Some(Kind::Key), Some(door.color()))?;
    rooms.place_agent(Some((1, rooms.rows / 2)))?;
    rooms.connect_all(&Color::SORTED)?;
    Ok(target)
}

level! {
    /// Arguments.
    KeyCorridor {
        /// The number of rows of rooms.
        pub num_rows: u32 = 3,
        /// The kind of the object: `key`, `ball` or `box`.
        pub obj_type: Kind = Kind::Ball,
        /// Columns and rows of a room, walls included.
        pub room_size: u32 = 6,
    }
}

impl Level for KeyCorridor {
    fn rules(&self) -> Result<Rules, String> {
        let [width, height] = grid_size(self.room_size, COLUMNS, self.num_rows)?;
        if !KINDS.contains(&self.obj_type) {
            return Err("obj_type is `key`, `ball` or `box`".into());
        }
        let rules = Rules::new(width, height, square(self.room_size).saturating_mul(30), "");
        rules.missions(
            "pick up the {} {}",
            [Color::names(), vec![self.obj_type.name()]],
        )
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let mut rooms = Rooms::new(draft, self.room_size, COLUMNS, self.num_rows)?;
        let target = add_corridor(&mut rooms, self.obj_type)?;
        draft.mission(format!("pick up the {}", describe(target)));
        draft.world.targets.push(target);
        Ok(())
    }

    fn step(&self, world: &mut World, action: Action, _rng: &mut Generator) -> Outcome {
        pick_up(world, action)
    }
}

ids! { KeyCorridor, "Find the key, unlock the room, and pick up the object in it.":
    "MiniGrid-KeyCorridorS3R1-v0", r#"{"room_size": 3, "num_rows": 1}"#;
    "MiniGrid-KeyCorridorS3R2-v0", r#"{"room_size": 3, "num_rows": 2}"#;
    "MiniGrid-KeyCorridorS3R3-v0", r#"{"room_size": 3, "num_rows": 3}"#;
    "MiniGrid-KeyCorridorS4R3-v0", r#"{"room_size": 4, "num_rows": 3}"#;
    "MiniGrid-KeyCorridorS5R3-v0", r#"{"room_size": 5, "num_rows": 3}"#;
    "MiniGrid-KeyCorridorS6R3-v0", r#"{"room_size": 6, "num_rows": 3}"#;
}
