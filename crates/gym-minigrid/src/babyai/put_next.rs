//! BabyAI's levels of putting objects next to others: put an object next to another one.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission`: the instruction |
//! | action | [`Action`](crate::Action) |
//! | reward | `1 - 0.9 * steps / max_steps` for the instruction, else 0 |
//! | start | the agent and the objects at random |
//! | end | terminated when the instruction is done |
//! | limit | if no other is given, `room_size * room_size` for each room and each way to walk |
//!
//! Source: minigrid 3.2.0, `envs/babyai/putnext.py`.

use super::{Desc, Instr, Maze, Plan, babyai, check_reachable};
use crate::tasks::{ids, square};

babyai! {
    /// Two objects of a room.
    PutNextLocal {
        /// Columns and rows of the room, walls included.
        pub room_size: u32 = 8,
        /// The number of objects: from 2 to 18.
        pub num_objs: u32 = 8,
    }
    check |level| match level.num_objs {
        2..=18 => Ok(()),
        n => Err(format!("num_objs is {n}: from 2 to 18 objects can differ")),
    };
    plan |level| Maze::new(level.room_size, 1, 1).into();
    make |level, rooms| {
        rooms.place_agent(None)?;
        let objects = rooms.add_distractors(None, level.num_objs, true)?;
        check_reachable(rooms)?;
        let two = rooms.draft.subset(&objects, 2)?;
        Ok(Instr::put_next(Desc::of(two[0]), Desc::of(two[1])))
    };
}

babyai! {
    /// Objects of two halves of a room.
    PutNext {
        /// Columns and rows of each room, walls included.
        pub room_size: u32,
        /// The number of objects in each room: up to 9.
        pub objs_per_room: u32,
        /// Whether the agent carries the object from the start.
        pub start_carrying: bool = false,
    }
    check |level| match level.objs_per_room {
        1..=9 => Ok(()),
        n => Err(format!("objs_per_room is {n}: from 1 to 9 are possible")),
    };
    plan |level| Plan {
        start_carrying: level.start_carrying,
        ..Plan::from(Maze::new(level.room_size, 1, 2)).max_steps(square(level.room_size).saturating_mul(8))
    };
    make |level, rooms| {
        rooms.place_agent(Some((0, 0)))?;
        let left = rooms.add_distractors(Some((0, 0)), level.objs_per_room, true)?;
        let right = rooms.add_distractors(Some((1, 0)), level.objs_per_room, true)?;
        rooms.remove_wall(0, 0, 0)?;
        let (a, b) = (rooms.draft.pick(&left)?, rooms.draft.pick(&right)?);
        let (a, b) = if rooms.draft.bool()? { (b, a) } else { (a, b) };
        Ok(Instr::put_next(Desc::of(a), Desc::of(b)))
    };
}

ids! { PutNextLocal, "Put an object of a room next to another one.":
    "BabyAI-PutNextLocal-v0", "{}";
    "BabyAI-PutNextLocalS5N3-v0", r#"{"room_size": 5, "num_objs": 3}"#;
    "BabyAI-PutNextLocalS6N4-v0", r#"{"room_size": 6, "num_objs": 4}"#;
}

ids! { PutNext, "Put an object next to one of the other half of a room.":
    "BabyAI-PutNextS4N1-v0", r#"{"room_size": 4, "objs_per_room": 1}"#;
    "BabyAI-PutNextS5N2-v0", r#"{"room_size": 5, "objs_per_room": 2}"#;
    "BabyAI-PutNextS5N1-v0", r#"{"room_size": 5, "objs_per_room": 1}"#;
    "BabyAI-PutNextS6N3-v0", r#"{"room_size": 6, "objs_per_room": 3}"#;
    "BabyAI-PutNextS7N4-v0", r#"{"room_size": 7, "objs_per_room": 4}"#;
    "BabyAI-PutNextS5N2Carrying-v0",
        r#"{"room_size": 5, "objs_per_room": 2, "start_carrying": true}"#;
    "BabyAI-PutNextS6N3Carrying-v0",
        r#"{"room_size": 6, "objs_per_room": 3, "start_carrying": true}"#;
    "BabyAI-PutNextS7N4Carrying-v0",
        r#"{"room_size": 7, "objs_per_room": 4, "start_carrying": true}"#;
}
