//! BabyAI's levels of picking up an object: pick an object up.
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
//! Source: minigrid 3.2.0, `envs/babyai/pickup.py`.

use super::level_gen::{Form, Verb};
use super::{Desc, Instr, LevelGen, Maze, Plan, all_reachable, babyai, check_reachable};
use crate::tasks::ids;
use crate::{Cell, Color, Generated, GenerationError};

fn pickup(object: Cell) -> Generated<Instr> {
    Ok(Instr::pickup(Desc::of(object), false))
}

babyai! {
    /// An object in a maze.
    Pickup {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
    }
    plan |level| level.maze.into();
    make |_, rooms| {
        rooms.place_agent(None)?;
        rooms.connect_all(&Color::SORTED)?;
        let objects = rooms.add_distractors(None, 18, false)?;
        check_reachable(rooms)?;
        pickup(rooms.draft.pick(&objects)?)
    };
}

babyai! {
    /// An object in a maze, in which others block the way to some.
    UnblockPickup {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
    }
    plan |level| level.maze.into();
    make |_, rooms| {
        rooms.place_agent(None)?;
        rooms.connect_all(&Color::SORTED)?;
        let objects = rooms.add_distractors(None, 20, false)?;
        if all_reachable(rooms.draft.world) {
            return Err(GenerationError::Rejected("every object can be reached"));
        }
        pickup(rooms.draft.pick(&objects)?)
    };
}

babyai! {
    /// An object that may be described by its place.
    PickupLoc {
        /// Columns and rows of the room, walls included.
        pub room_size: u32 = 8,
    }
    plan |level| Maze::new(level.room_size, 1, 1).into();
    make |_, rooms| {
        let level = LevelGen {
            distractors: 8,
            locked_room_probability: 0.0,
            unblocking: false,
            verbs: &[Verb::Pickup],
            forms: &[Form::Single],
            ..LevelGen::DEFAULT
        };
        level.make(rooms)
    };
}

babyai! {
    /// An object described by its kind, its colour or both.
    PickupDist {
        /// Whether picking up another object ends the episode.
        pub debug: bool = false,
    }
    plan |_| Maze::new(7, 1, 1).into();
    make |level, rooms| {
        let objects = rooms.add_distractors(None, 5, true)?;
        rooms.place_agent(Some((0, 0)))?;
        let object = rooms.draft.pick(&objects)?;
        let (kind, color) = (Some(object.kind()), Some(object.color()));
        let (kind, color) = rooms.draft.pick(&[(kind, None), (None, color), (kind, color)])?;
        Ok(Instr::pickup(Desc::new(kind, color, None), level.debug))
    };
}

babyai! {
    /// An object in the room above.
    PickupAbove {}
    plan |_| Plan::from(Maze::new(6, 3, 3)).max_steps(288);
    make |_, rooms| {
        let object = rooms.add_object(1, 0, None, None)?;
        rooms.add_door(1, 1, Some(3), None, Some(false))?;
        rooms.place_agent(Some((1, 1)))?;
        rooms.connect_all(&Color::SORTED)?;
        pickup(object)
    };
}

ids! { Pickup, "Pick up an object in a maze of rooms.", planned:
    "BabyAI-Pickup-v0", "{}";
}

ids! { UnblockPickup, "Pick up an object in a maze, past others.":
    "BabyAI-UnblockPickup-v0", "{}";
}

ids! { PickupLoc, "Pick up an object that is described by its place.":
    "BabyAI-PickupLoc-v0", "{}";
}

ids! { PickupDist, "Pick up an object in the room.", planned:
    "BabyAI-PickupDist-v0", "{}";
    "BabyAI-PickupDistDebug-v0", r#"{"debug": true}"#;
}

ids! { PickupAbove, "Pick up an object in the room above.", planned:
    "BabyAI-PickupAbove-v0", "{}";
}
