//! BabyAI's levels of random instructions: instructions of all kinds, alone, joined, or in an order.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission`: the instruction |
//! | action | [`Action`](crate::Action) |
//! | reward | `1 - 0.9 * steps / max_steps` for the instruction, else 0 |
//! | start | a maze with objects; a room may be locked |
//! | end | terminated when the instruction is done |
//! | limit | if no other is given, `room_size * room_size` for each room and each way to walk |
//!
//! Source: minigrid 3.2.0, `envs/babyai/synth.py`.

use super::level_gen::Form;
use super::{LevelGen, Maze, Plan, babyai};
use crate::tasks::ids;

/// Defines a level of random instructions in a maze: `num_dists` other objects, and what differs
/// from [`LevelGen::DEFAULT`].
macro_rules! synth {
    ($(#[$doc:meta])* $name:ident { $($field:ident: $value:expr),* }) => {
        babyai! {
            $(#[$doc])*
            $name {
                /// The rooms.
                #[flatten]
                pub maze: Maze,
                /// The number of other objects.
                pub num_dists: u32 = 18,
            }
            plan |level| Plan { unblocking: true, ..level.maze.into() };
            make |level, rooms| {
                let distractors = level.num_dists;
                LevelGen { distractors, $($field: $value,)* ..LevelGen::DEFAULT }.make(rooms)
            };
        }
    };
}

synth! {
    /// Single instructions.
    Synth { locations: false, implicit_unlock: false, forms: &[Form::Single] }
}

synth! {
    /// Single instructions that may describe places.
    SynthLoc { implicit_unlock: false, forms: &[Form::Single] }
}

synth! {
    /// Instructions of all forms, which need no object in a locked room.
    SynthSeq { implicit_unlock: false }
}

babyai! {
    /// All of it in a small maze.
    MiniBossLevel {}
    plan |_| Plan { unblocking: true, ..Maze::new(5, 2, 2).into() };
    make |_, rooms| {
        let level = LevelGen {
            distractors: 7,
            locked_room_probability: 0.25,
            ..LevelGen::DEFAULT
        };
        level.make(rooms)
    };
}

synth! {
    /// All of it.
    BossLevel {}
}

synth! {
    /// All of it, without locked rooms.
    BossLevelNoUnlock { locked_room_probability: 0.0, implicit_unlock: false }
}

ids! { Synth, "Follow a single instruction.":
    "BabyAI-Synth-v0", "{}";
    "BabyAI-SynthS5R2-v0", r#"{"room_size": 5, "num_rows": 2}"#;
}

ids! { SynthLoc, "Follow a single instruction, which may describe places.":
    "BabyAI-SynthLoc-v0", "{}";
}

ids! { SynthSeq, "Follow instructions of all forms.":
    "BabyAI-SynthSeq-v0", "{}";
}

ids! { MiniBossLevel, "Follow instructions of all forms in a small maze.":
    "BabyAI-MiniBossLevel-v0", "{}";
}

ids! { BossLevel, "Follow instructions of all forms, through locked doors.":
    "BabyAI-BossLevel-v0", "{}";
}

ids! { BossLevelNoUnlock, "Follow instructions of all forms, without locked doors.":
    "BabyAI-BossLevelNoUnlock-v0", "{}";
}
