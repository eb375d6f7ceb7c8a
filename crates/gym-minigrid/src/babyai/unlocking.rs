//! BabyAI's levels of unlocking doors: find the key of a door, and unlock it.
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
//! Source: minigrid 3.2.0, `envs/babyai/unlock.py`.

use super::go_to::{add_locked_room, place_agent_outside};
use super::{Desc, Instr, Maze, Plan, babyai, check_reachable};
use crate::tasks::ids;
use crate::tasks::unlock_pickup::add_locked_box;
use crate::{Color, Kind};

babyai! {
    /// A locked door in a maze.
    Unlock {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
    }
    plan |level| level.maze.into();
    make |_, rooms| {
        let (locked, door) = add_locked_room(rooms)?;
        let mut colors = Color::SORTED.to_vec();
        if rooms.draft.bool()? {
            colors.retain(|color| *color != door.color());
        }
        rooms.connect_all(&colors)?;
        for room in rooms.by_column() {
            rooms.add_distractors(Some(room), 3, false)?;
        }
        place_agent_outside(rooms, locked)?;
        check_reachable(rooms)?;
        Ok(Instr::open(Desc::of(door), false))
    };
}

babyai! {
    /// The locked door of the room, with the key in it.
    UnlockLocal {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
        /// Whether there are other objects.
        pub distractors: bool = false,
    }
    plan |level| level.maze.into();
    make |level, rooms| {
        let (door, _) = rooms.add_door(1, 1, None, None, Some(true))?;
        rooms.add_object(1, 1, Some(Kind::Key), Some(door.color()))?;
        if level.distractors {
            rooms.add_distractors(Some((1, 1)), 3, true)?;
        }
        rooms.place_agent(Some((1, 1)))?;
        Ok(Instr::open(Desc::kind(door), false))
    };
}

babyai! {
    /// The locked door of the room, with the key in a box.
    KeyInBox {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
    }
    plan |level| level.maze.into();
    make |_, rooms| {
        let (door, _) = rooms.add_door(1, 1, None, None, Some(true))?;
        let key = rooms.draft.object(Kind::Key, door.color());
        let color = rooms.draft.color()?;
        let cell = rooms.draft.box_of(color, key);
        rooms.place(1, 1, cell)?;
        rooms.place_agent(Some((1, 1)))?;
        Ok(Instr::open(Desc::kind(door), false))
    };
}

babyai! {
    /// The box behind a locked door.
    UnlockPickup {
        /// Whether there are other objects.
        pub distractors: bool = false,
    }
    plan |_| Maze::new(6, 1, 2).into();
    make |level, rooms| {
        let target = add_locked_box(rooms, false, if level.distractors { 4 } else { 0 })?;
        Ok(Instr::pickup(Desc::of(target), false))
    };
}

babyai! {
    /// The box behind a locked door with a ball before it.
    BlockedUnlockPickup {}
    plan |_| Plan::from(Maze::new(6, 1, 2)).max_steps(576);
    make |_, rooms| {
        let target = add_locked_box(rooms, true, 0)?;
        Ok(Instr::pickup(Desc::kind(target), false))
    };
}

babyai! {
    /// The ball behind a locked door, whose key lies behind another one.
    UnlockToUnlock {}
    plan |_| Plan::from(Maze::new(6, 1, 3)).max_steps(1080);
    make |_, rooms| {
        let colors = rooms.draft.subset(&Color::SORTED, 2)?;
        rooms.add_door(0, 0, Some(0), Some(colors[0]), Some(true))?;
        rooms.add_object(2, 0, Some(Kind::Key), Some(colors[0]))?;
        rooms.add_door(1, 0, Some(0), Some(colors[1]), Some(true))?;
        rooms.add_object(1, 0, Some(Kind::Key), Some(colors[1]))?;
        let ball = rooms.add_object(0, 0, Some(Kind::Ball), None)?;
        rooms.place_agent(Some((1, 0)))?;
        Ok(Instr::pickup(Desc::kind(ball), false))
    };
}

ids! { Unlock, "Unlock a door in a maze of rooms.":
    "BabyAI-Unlock-v0", "{}";
}

ids! { UnlockLocal, "Unlock the door of the room.":
    "BabyAI-UnlockLocal-v0", "{}";
    "BabyAI-UnlockLocalDist-v0", r#"{"distractors": true}"#;
}

ids! { KeyInBox, "Find the key in a box, and unlock the door.":
    "BabyAI-KeyInBox-v0", "{}";
}

ids! { UnlockPickup, "Pick up the box behind a locked door.":
    "BabyAI-UnlockPickup-v0", "{}";
    "BabyAI-UnlockPickupDist-v0", r#"{"distractors": true}"#;
}

ids! { BlockedUnlockPickup, "Pick up the box behind a locked and blocked door.":
    "BabyAI-BlockedUnlockPickup-v0", "{}";
}

ids! { UnlockToUnlock, "Unlock two doors to reach a ball.":
    "BabyAI-UnlockToUnlock-v0", "{}";
}
