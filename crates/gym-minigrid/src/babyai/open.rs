//! BabyAI's levels of opening doors: open a door, or two in an order.
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
//! Source: minigrid 3.2.0, `envs/babyai/open.py`.

use gym_core::ArgumentType;
use serde::{Deserialize, Serialize};

use super::{Desc, Instr, Loc, Maze, Plan, babyai, check_reachable};
use crate::tasks::ids;
use crate::{Color, Kind};

/// How a door is described.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SelectBy {
    /// By its colour.
    Color,
    /// By its place, seen from the agent.
    Loc,
}

impl ArgumentType for SelectBy {
    fn kind() -> String {
        "`color` or `loc`".to_owned()
    }
}

babyai! {
    /// A door in a maze.
    Open {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
    }
    plan |level| level.maze.into();
    make |_, rooms| {
        rooms.place_agent(None)?;
        rooms.connect_all(&Color::SORTED)?;
        rooms.add_distractors(None, 18, false)?;
        check_reachable(rooms)?;
        let doors = rooms.doors();
        let door = rooms.draft.pick(&doors)?;
        Ok(Instr::open(Desc::of(rooms.draft.world.grid.get(door)), false))
    };
}

babyai! {
    /// The only door, which is red.
    OpenRedDoor {}
    plan |_| Maze::new(5, 1, 2).into();
    make |_, rooms| {
        let (door, _) = rooms.add_door(0, 0, Some(0), Some(Color::Red), Some(false))?;
        rooms.place_agent(Some((0, 0)))?;
        Ok(Instr::open(Desc::of(door), false))
    };
}

babyai! {
    /// A door of four.
    OpenDoor {
        /// The rooms.
        #[flatten]
        pub maze: Maze,
        /// Whether toggling another door ends the episode.
        pub debug: bool = false,
        /// How the door is described; at random if null.
        pub select_by: Option<SelectBy>,
    }
    plan |level| level.maze.into();
    make |level, rooms| {
        let colors = rooms.draft.subset(&Color::SORTED, 4)?;
        let mut doors = Vec::new();
        for (wall, color) in colors.into_iter().enumerate() {
            doors.push(rooms.add_door(1, 1, Some(wall), Some(color), Some(false))?.0);
        }
        let by = match level.select_by {
            Some(by) => by,
            None => rooms.draft.pick(&[SelectBy::Color, SelectBy::Loc])?,
        };
        let desc = match by {
            SelectBy::Color => Desc::of(doors[0]),
            SelectBy::Loc => Desc::new(Some(Kind::Door), None, Some(rooms.draft.pick(&Loc::ALL)?)),
        };
        rooms.place_agent(Some((1, 1)))?;
        Ok(Instr::open(desc, level.debug))
    };
}

babyai! {
    /// Two doors, one after the other.
    OpenTwoDoors {
        /// The colour of the first door; at random if null.
        pub first_color: Option<Color>,
        /// The colour of the second door; at random if null.
        pub second_color: Option<Color>,
        /// Whether toggling another door first ends the episode.
        pub strict: bool = false,
    }
    plan |_| Plan::from(Maze::new(6, 3, 3)).max_steps(720);
    make |level, rooms| {
        let colors = rooms.draft.subset(&Color::SORTED, 2)?;
        let first = level.first_color.unwrap_or(colors[0]);
        let second = level.second_color.unwrap_or(colors[1]);
        let (first, _) = rooms.add_door(1, 1, Some(2), Some(first), Some(false))?;
        let (second, _) = rooms.add_door(1, 1, Some(0), Some(second), Some(false))?;
        rooms.place_agent(Some((1, 1)))?;
        Ok(Instr::before(
            Instr::open(Desc::of(first), level.strict),
            Instr::open(Desc::of(second), false),
        ))
    };
}

babyai! {
    /// One or two doors of some, in an order.
    OpenDoorsOrder {
        /// The number of doors: from 2 to 4.
        pub num_doors: u32,
        /// Whether toggling another door ends the episode.
        pub debug: bool = false,
    }
    check |level| match level.num_doors {
        2..=4 => Ok(()),
        n => Err(format!("num_doors is {n}: from 2 to 4 are possible")),
    };
    plan |_| Plan::from(Maze::new(6, 3, 3)).max_steps(720);
    make |level, rooms| {
        let colors = rooms.draft.subset(&Color::SORTED, level.num_doors as usize)?;
        let mut doors = Vec::new();
        for color in colors {
            doors.push(rooms.add_door(1, 1, None, Some(color), Some(false))?.0);
        }
        rooms.place_agent(Some((1, 1)))?;
        let two = rooms.draft.subset(&doors, 2)?;
        let open = |index: usize| Instr::open(Desc::of(two[index]), level.debug);
        Ok(match rooms.draft.int(0, 3)? {
            0 => open(0),
            1 => Instr::before(open(0), open(1)),
            _ => Instr::after(open(0), open(1)),
        })
    };
}

ids! { Open, "Open a door in a maze of rooms.", planned:
    "BabyAI-Open-v0", "{}";
}

ids! { OpenRedDoor, "Open the red door.", planned:
    "BabyAI-OpenRedDoor-v0", "{}";
}

ids! { OpenDoor, "Open a door of four.", planned:
    "BabyAI-OpenDoor-v0", "{}";
    "BabyAI-OpenDoorDebug-v0", r#"{"debug": true, "select_by": null}"#;
    "BabyAI-OpenDoorColor-v0", r#"{"select_by": "color"}"#;
    "BabyAI-OpenDoorLoc-v0", r#"{"select_by": "loc"}"#;
}

ids! { OpenTwoDoors, "Open two doors in an order.":
    "BabyAI-OpenTwoDoors-v0", "{}";
    "BabyAI-OpenRedBlueDoors-v0", r#"{"first_color": "red", "second_color": "blue"}"#;
    "BabyAI-OpenRedBlueDoorsDebug-v0",
        r#"{"first_color": "red", "second_color": "blue", "strict": true}"#;
}

ids! { OpenDoorsOrder, "Open one or two doors in an order.":
    "BabyAI-OpenDoorsOrderN2-v0", r#"{"num_doors": 2}"#;
    "BabyAI-OpenDoorsOrderN4-v0", r#"{"num_doors": 4}"#;
    "BabyAI-OpenDoorsOrderN2Debug-v0", r#"{"debug": true, "num_doors": 2}"#;
    "BabyAI-OpenDoorsOrderN4Debug-v0", r#"{"debug": true, "num_doors": 4}"#;
}
