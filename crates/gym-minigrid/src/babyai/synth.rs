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

babyai! {
    /// Single instructions.
    Synth {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
        /// The number of other objects.
        pub num_dists: u32 = 18,
    }
    plan |level| Plan { unblocking: true, ..level.maze.into() };
    make |level, rooms| {
        let level = LevelGen {
            distractors: level.num_dists,
            locations: false,
            implicit_unlock: false,
            forms: &[Form::Single],
            ..LevelGen::DEFAULT
        };
        level.make(rooms)
    };
}

babyai! {
    /// Single instructions that may describe places.
    SynthLoc {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
        /// The number of other objects.
        pub num_dists: u32 = 18,
    }
    plan |level| Plan { unblocking: true, ..level.maze.into() };
    make |level, rooms| {
        let level = LevelGen {
            distractors: level.num_dists,
            implicit_unlock: false,
            forms: &[Form::Single],
            ..LevelGen::DEFAULT
        };
        level.make(rooms)
    };
}

babyai! {
    /// Instructions of all forms, which need no object in a locked room.
    SynthSeq {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
        /// The number of other objects.
        pub num_dists: u32 = 18,
    }
    plan |level| Plan { unblocking: true, ..level.maze.into() };
    make |level, rooms| {
        let level = LevelGen {
            distractors: level.num_dists,
            implicit_unlock: false,
            ..LevelGen::DEFAULT
        };
        level.make(rooms)
    };
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

babyai! {
    /// All of it.
    BossLevel {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
        /// The number of other objects.
        pub num_dists: u32 = 18,
    }
    plan |level| Plan { unblocking: true, ..level.maze.into() };
    make |level, rooms| {
        let level = LevelGen {
            distractors: level.num_dists,
            ..LevelGen::DEFAULT
        };
        level.make(rooms)
    };
}

babyai! {
    /// All of it, without locked rooms.
    BossLevelNoUnlock {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
        /// The number of other objects.
        pub num_dists: u32 = 18,
    }
    plan |level| Plan { unblocking: true, ..level.maze.into() };
    make |level, rooms| {
        let level = LevelGen {
            distractors: level.num_dists,
            locked_room_probability: 0.0,
            implicit_unlock: false,
            ..LevelGen::DEFAULT
        };
        level.make(rooms)
    };
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
