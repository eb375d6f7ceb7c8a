//! BabyAI's levels of going to an object: walk to an object, and stand before it.
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
//! Source: minigrid 3.2.0, `envs/babyai/goto.py`.

use super::level_gen::Verb;
use super::{Desc, Instr, LevelGen, Maze, babyai, check_reachable};
use crate::rooms::Rooms;
use crate::tasks::ids;
use crate::{Cell, Color, Generated, GenerationError, Kind, State};

fn go_to(object: Cell) -> Generated<Instr> {
    Ok(Instr::GoTo(Desc::of(object)))
}

babyai! {
    /// A red ball among grey objects.
    GoToRedBallGrey {
        /// Columns and rows of the room, walls included.
        pub room_size: u32 = 8,
        /// The number of other objects.
        pub num_dists: u32 = 7,
    }
    plan |level| Maze::new(level.room_size, 1, 1).into();
    make |level, rooms| {
        rooms.place_agent(None)?;
        let ball = rooms.add_object(0, 0, Some(Kind::Ball), Some(Color::Red))?;
        for object in rooms.add_distractors(None, level.num_dists, false)? {
            let pos = rooms.draft.world.thing(object).map(|thing| thing.pos).unwrap_or_default();
            rooms.draft.world.grid.set(pos, object.with_color(Color::Grey));
        }
        check_reachable(rooms)?;
        go_to(ball)
    };
}

babyai! {
    /// A red ball among other objects.
    GoToRedBall {
        /// Columns and rows of the room, walls included.
        pub room_size: u32 = 8,
        /// The number of other objects.
        pub num_dists: u32 = 7,
    }
    plan |level| Maze::new(level.room_size, 1, 1).into();
    make |level, rooms| {
        rooms.place_agent(None)?;
        let ball = rooms.add_object(0, 0, Some(Kind::Ball), Some(Color::Red))?;
        rooms.add_distractors(None, level.num_dists, false)?;
        check_reachable(rooms)?;
        go_to(ball)
    };
}

babyai! {
    /// The only object.
    GoToObj {
        /// Columns and rows of the room, walls included.
        pub room_size: u32 = 8,
    }
    plan |level| Maze::new(level.room_size, 1, 1).into();
    make |_, rooms| {
        rooms.place_agent(None)?;
        let object = rooms.add_distractors(None, 1, true)?[0];
        go_to(object)
    };
}

babyai! {
    /// An object in a room.
    GoToLocal {
        /// Columns and rows of the room, walls included.
        pub room_size: u32 = 8,
        /// The number of other objects.
        pub num_dists: u32 = 8,
    }
    plan |level| Maze::new(level.room_size, 1, 1).into();
    make |level, rooms| {
        rooms.place_agent(None)?;
        let objects = rooms.add_distractors(None, level.num_dists, false)?;
        check_reachable(rooms)?;
        go_to(rooms.draft.pick(&objects)?)
    };
}

babyai! {
    /// An object in a maze.
    GoTo {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
        /// The number of other objects.
        pub num_dists: u32 = 18,
        /// Whether all doors are open.
        pub doors_open: bool = false,
    }
    plan |level| level.maze.into();
    make |level, rooms| {
        rooms.place_agent(None)?;
        rooms.connect_all(&Color::SORTED)?;
        let objects = rooms.add_distractors(None, level.num_dists, false)?;
        check_reachable(rooms)?;
        let object = rooms.draft.pick(&objects)?;
        if level.doors_open {
            for pos in rooms.doors() {
                let grid = &mut rooms.draft.world.grid;
                grid.set(pos, grid.get(pos).with_state(State::Open));
            }
        }
        go_to(object)
    };
}

babyai! {
    /// An object in a locked room.
    GoToImpUnlock {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
    }
    plan |level| level.maze.into();
    make |_, rooms| {
        let (locked, _) = add_locked_room(rooms)?;
        rooms.connect_all(&Color::SORTED)?;
        for room in rooms.by_column() {
            rooms.add_distractors(Some(room), 2, false)?;
        }
        place_agent_outside(rooms, locked)?;
        check_reachable(rooms)?;
        let object = rooms.add_distractors(Some(locked), 1, false)?[0];
        go_to(object)
    };
}

/// Adds a locked door to a random room, and its key to a random room, which can be the same, as in
/// minigrid. Returns the room and the door.
pub(super) fn add_locked_room(rooms: &mut Rooms<'_, '_>) -> Generated<((i32, i32), Cell)> {
    let locked = rooms.random_room()?;
    let (door, _) = rooms.add_door(locked.0, locked.1, None, None, Some(true))?;
    let (i, j) = rooms.random_room()?;
    rooms.add_object(i, j, Some(Kind::Key), Some(door.color()))?;
    Ok((locked, door))
}

/// Places the agent in a random room other than `(i, j)`.
pub(super) fn place_agent_outside(rooms: &mut Rooms<'_, '_>, (i, j): (i32, i32)) -> Generated {
    let locked = rooms.index(i, j)?;
    loop {
        rooms.place_agent(None)?;
        if rooms.index_at(rooms.draft.world.agent) != locked {
            return Ok(());
        }
    }
}

babyai! {
    /// Several objects in a maze, in an order.
    GoToSeq {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
        /// The number of other objects.
        pub num_dists: u32 = 18,
    }
    plan |level| level.maze.into();
    make |level, rooms| {
        let level = LevelGen {
            distractors: level.num_dists,
            locked_room_probability: 0.0,
            locations: false,
            unblocking: false,
            verbs: &[Verb::GoTo],
            ..LevelGen::DEFAULT
        };
        level.make(rooms)
    };
}

babyai! {
    /// A red or a blue ball, of which there is one.
    GoToRedBlueBall {
        /// Columns and rows of the room, walls included.
        pub room_size: u32 = 8,
        /// The number of other objects.
        pub num_dists: u32 = 7,
    }
    plan |level| Maze::new(level.room_size, 1, 1).into();
    make |level, rooms| {
        rooms.place_agent(None)?;
        let objects = rooms.add_distractors(None, level.num_dists, false)?;
        let is_target = |object: &Cell| {
            object.is(Kind::Ball) && [Color::Red, Color::Blue].contains(&object.color())
        };
        if objects.iter().any(is_target) {
            return Err(GenerationError::Rejected("there is another red or blue ball"));
        }
        let color = rooms.draft.pick(&[Color::Red, Color::Blue])?;
        let ball = rooms.add_object(0, 0, Some(Kind::Ball), Some(color))?;
        check_reachable(rooms)?;
        go_to(ball)
    };
}

babyai! {
    /// A door of the room.
    GoToDoor {}
    plan |_| Maze::new(7, 3, 3).into();
    make |_, rooms| {
        let mut doors = Vec::new();
        for _ in 0..4 {
            doors.push(rooms.add_door(1, 1, None, None, None)?.0);
        }
        rooms.place_agent(Some((1, 1)))?;
        go_to(rooms.draft.pick(&doors)?)
    };
}

babyai! {
    /// An object or a door of the room.
    GoToObjDoor {}
    plan |_| Maze::new(8, 3, 3).into();
    make |_, rooms| {
        rooms.place_agent(Some((1, 1)))?;
        let mut objects = rooms.add_distractors(Some((1, 1)), 8, false)?;
        for _ in 0..4 {
            objects.push(rooms.add_door(1, 1, None, None, None)?.0);
        }
        check_reachable(rooms)?;
        go_to(rooms.draft.pick(&objects)?)
    };
}

ids! { GoToRedBallGrey, "Go to the red ball among grey objects.", planned:
    "BabyAI-GoToRedBallGrey-v0", "{}";
}

ids! { GoToRedBall, "Go to the red ball.", planned:
    "BabyAI-GoToRedBall-v0", "{}";
    "BabyAI-GoToRedBallNoDists-v0", r#"{"num_dists": 0}"#;
}

ids! { GoToObj, "Go to the only object.", planned:
    "BabyAI-GoToObj-v0", "{}";
    "BabyAI-GoToObjS4-v0", r#"{"room_size": 4}"#;
    "BabyAI-GoToObjS6-v1", r#"{"room_size": 6}"#;
}

ids! { GoToLocal, "Go to an object in the room.", planned:
    "BabyAI-GoToLocal-v0", "{}";
    "BabyAI-GoToLocalS5N2-v0", r#"{"room_size": 5, "num_dists": 2}"#;
    "BabyAI-GoToLocalS6N2-v0", r#"{"room_size": 6, "num_dists": 2}"#;
    "BabyAI-GoToLocalS6N3-v0", r#"{"room_size": 6, "num_dists": 3}"#;
    "BabyAI-GoToLocalS6N4-v0", r#"{"room_size": 6, "num_dists": 4}"#;
    "BabyAI-GoToLocalS7N4-v0", r#"{"room_size": 7, "num_dists": 4}"#;
    "BabyAI-GoToLocalS7N5-v0", r#"{"room_size": 7, "num_dists": 5}"#;
    "BabyAI-GoToLocalS8N2-v0", r#"{"room_size": 8, "num_dists": 2}"#;
    "BabyAI-GoToLocalS8N3-v0", r#"{"room_size": 8, "num_dists": 3}"#;
    "BabyAI-GoToLocalS8N4-v0", r#"{"room_size": 8, "num_dists": 4}"#;
    "BabyAI-GoToLocalS8N5-v0", r#"{"room_size": 8, "num_dists": 5}"#;
    "BabyAI-GoToLocalS8N6-v0", r#"{"room_size": 8, "num_dists": 6}"#;
    "BabyAI-GoToLocalS8N7-v0", r#"{"room_size": 8, "num_dists": 7}"#;
}

ids! { GoTo, "Go to an object in a maze of rooms.", planned:
    "BabyAI-GoTo-v0", "{}";
    "BabyAI-GoToOpen-v0", r#"{"doors_open": true}"#;
    "BabyAI-GoToObjMaze-v0", r#"{"num_dists": 1, "doors_open": false}"#;
    "BabyAI-GoToObjMazeOpen-v0", r#"{"num_dists": 1, "doors_open": true}"#;
    "BabyAI-GoToObjMazeS4R2-v0",
        r#"{"num_dists": 1, "room_size": 4, "num_rows": 2, "num_cols": 2}"#;
    "BabyAI-GoToObjMazeS4-v0", r#"{"num_dists": 1, "room_size": 4}"#;
    "BabyAI-GoToObjMazeS5-v0", r#"{"num_dists": 1, "room_size": 5}"#;
    "BabyAI-GoToObjMazeS6-v0", r#"{"num_dists": 1, "room_size": 6}"#;
    "BabyAI-GoToObjMazeS7-v0", r#"{"num_dists": 1, "room_size": 7}"#;
}

ids! { GoToImpUnlock, "Go to an object in a locked room.":
    "BabyAI-GoToImpUnlock-v0", "{}";
}

ids! { GoToSeq, "Go to several objects in an order.":
    "BabyAI-GoToSeq-v0", "{}";
    "BabyAI-GoToSeqS5R2-v0",
        r#"{"room_size": 5, "num_rows": 2, "num_cols": 2, "num_dists": 4}"#;
}

ids! { GoToRedBlueBall, "Go to the red or the blue ball.", planned:
    "BabyAI-GoToRedBlueBall-v0", "{}";
}

ids! { GoToDoor, "Go to a door.", planned:
    "BabyAI-GoToDoor-v0", "{}";
}

ids! { GoToObjDoor, "Go to an object or a door.", planned:
    "BabyAI-GoToObjDoor-v0", "{}";
}
