//! BabyAI's levels of several kinds: find an object, move two, or do one of several things.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission`: the instruction |
//! | action | [`Action`](crate::Action) |
//! | reward | `1 - 0.9 * steps / max_steps` for the instruction, else 0 |
//! | start | the agent, objects and doors at random |
//! | end | terminated when the instruction is done |
//! | limit | if no other is given, `room_size * room_size` for each room and each way to walk |
//!
//! Source: minigrid 3.2.0, `envs/babyai/other.py`.

use super::{Desc, Instr, Maze, Plan, babyai};
use crate::rooms::KINDS;
use crate::tasks::key_corridor::add_corridor;
use crate::tasks::{ids, square};
use crate::{Color, Kind};

babyai! {
    /// Go to an object or a door, open it, or pick it up.
    ActionObjDoor {}
    plan |_| Maze::new(7, 3, 3).into();
    make |_, rooms| {
        let mut objects = rooms.add_distractors(Some((1, 1)), 5, true)?;
        for _ in 0..4 {
            objects.push(rooms.add_door(1, 1, None, None, Some(false))?.0);
        }
        rooms.place_agent(Some((1, 1)))?;
        let object = rooms.draft.pick(&objects)?;
        let desc = Desc::of(object);
        Ok(if rooms.draft.bool()? {
            Instr::GoTo(desc)
        } else if object.is(Kind::Door) {
            Instr::open(desc, false)
        } else {
            Instr::pickup(desc, false)
        })
    };
}

babyai! {
    /// Pick up the only object, which may be in any room.
    FindObjS5 {
        /// Columns and rows of each room, walls included.
        pub room_size: u32 = 5,
    }
    plan |level| Plan::from(Maze::new(level.room_size, 3, 3)).max_steps(square(level.room_size).saturating_mul(20));
    make |_, rooms| {
        let (i, j) = rooms.random_room()?;
        let object = rooms.add_object(i, j, None, None)?;
        rooms.place_agent(Some((1, 1)))?;
        rooms.connect_all(&Color::SORTED)?;
        Ok(Instr::pickup(Desc::kind(object), false))
    };
}

babyai! {
    /// Find the key, unlock the room, and pick up the object in it.
    KeyCorridor {
        /// The number of rows of rooms.
        pub num_rows: u32 = 3,
        /// The kind of the object: `key`, `ball` or `box`.
        pub obj_type: Kind = Kind::Ball,
        /// Columns and rows of each room, walls included.
        pub room_size: u32 = 6,
    }
    check |level| match KINDS.contains(&level.obj_type) {
        true => Ok(()),
        false => Err("obj_type is `key`, `ball` or `box`".into()),
    };
    plan |level| {
        Plan::from(Maze::new(level.room_size, level.num_rows, 3)).max_steps(square(level.room_size).saturating_mul(30))
    };
    make |level, rooms| {
        let object = add_corridor(rooms, level.obj_type)?;
        Ok(Instr::pickup(Desc::kind(object), false))
    };
}

babyai! {
    /// Pick up the only ball.
    OneRoomS8 {
        /// Columns and rows of the room, walls included.
        pub room_size: u32 = 8,
    }
    plan |level| Maze::new(level.room_size, 1, 1).into();
    make |_, rooms| {
        let ball = rooms.add_object(0, 0, Some(Kind::Ball), None)?;
        rooms.place_agent(None)?;
        Ok(Instr::pickup(Desc::kind(ball), false))
    };
}

babyai! {
    /// Put two objects next to two of the other half of the room.
    MoveTwoAcross {
        /// Columns and rows of each room, walls included.
        pub room_size: u32,
        /// The number of objects in each room: from 2 to 9.
        pub objs_per_room: u32,
    }
    check |level| match level.objs_per_room {
        2..=9 => Ok(()),
        n => Err(format!("objs_per_room is {n}: from 2 to 9 are possible")),
    };
    plan |level| Plan::from(Maze::new(level.room_size, 1, 2)).max_steps(square(level.room_size).saturating_mul(16));
    make |level, rooms| {
        rooms.place_agent(Some((0, 0)))?;
        let left = rooms.add_distractors(Some((0, 0)), level.objs_per_room, true)?;
        let right = rooms.add_distractors(Some((1, 0)), level.objs_per_room, true)?;
        rooms.remove_wall(0, 0, 0)?;
        let left = rooms.draft.subset(&left, 2)?;
        let right = rooms.draft.subset(&right, 2)?;
        Ok(Instr::before(
            Instr::put_next(Desc::of(left[0]), Desc::of(right[0])),
            Instr::put_next(Desc::of(right[1]), Desc::of(left[1])),
        ))
    };
}

ids! { ActionObjDoor, "Go to an object or a door, open it, or pick it up.":
    "BabyAI-ActionObjDoor-v0", "{}";
}

ids! { FindObjS5, "Find an object in a maze of rooms.":
    "BabyAI-FindObjS5-v0", "{}";
    "BabyAI-FindObjS6-v0", r#"{"room_size": 6}"#;
    "BabyAI-FindObjS7-v0", r#"{"room_size": 7}"#;
}

ids! { KeyCorridor, "Find the key, unlock the room, and pick up the ball in it.":
    "BabyAI-KeyCorridor-v0", "{}";
    "BabyAI-KeyCorridorS3R1-v0", r#"{"room_size": 3, "num_rows": 1}"#;
    "BabyAI-KeyCorridorS3R2-v0", r#"{"room_size": 3, "num_rows": 2}"#;
    "BabyAI-KeyCorridorS3R3-v0", r#"{"room_size": 3, "num_rows": 3}"#;
    "BabyAI-KeyCorridorS4R3-v0", r#"{"room_size": 4, "num_rows": 3}"#;
    "BabyAI-KeyCorridorS5R3-v0", r#"{"room_size": 5, "num_rows": 3}"#;
    "BabyAI-KeyCorridorS6R3-v0", r#"{"room_size": 6, "num_rows": 3}"#;
}

ids! { OneRoomS8, "Pick up the ball in a room.":
    "BabyAI-OneRoomS8-v0", "{}";
    "BabyAI-OneRoomS12-v0", r#"{"room_size": 12}"#;
    "BabyAI-OneRoomS16-v0", r#"{"room_size": 16}"#;
    "BabyAI-OneRoomS20-v0", r#"{"room_size": 20}"#;
}

ids! { MoveTwoAcross, "Move two objects across a room.":
    "BabyAI-MoveTwoAcrossS5N2-v0", r#"{"room_size": 5, "objs_per_room": 2}"#;
    "BabyAI-MoveTwoAcrossS8N9-v0", r#"{"room_size": 8, "objs_per_room": 9}"#;
}
