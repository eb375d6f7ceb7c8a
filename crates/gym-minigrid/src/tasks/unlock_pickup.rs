//! UnlockPickup: pick up the box in the other room, behind a locked door.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`] |
//! | reward | `1 - 0.9 * steps / max_steps` for the box, else 0 |
//! | start | the agent and the key in the left of two rooms, the box in the right one |
//! | end | terminated by picking up the box |
//! | limit | 288 steps |
//!
//! Source: minigrid 3.2.0, `envs/unlockpickup.py`.

use gym_core::{Generator, Outcome, Result};

use super::{describe, ids, level, pick_up, square};
use crate::level::{Level, Rules, View, refuse};
use crate::rooms::{Rooms, grid_size};
use crate::{Action, Cell, Color, Draft, GridEnv, Kind, Making, World};

/// Columns and rows of a room, walls included.
const ROOM_SIZE: u32 = 6;

/// The environment.
pub type UnlockPickupEnv = GridEnv<UnlockPickup>;

level! {
    /// Arguments.
    UnlockPickup {}
}

impl Level for UnlockPickup {
    type Action = Action;
    type Memory = Cell;

    const NAME: &'static str = "UnlockPickup";

    fn view(&self) -> &View {
        &self.view
    }

    fn rules(&self) -> Result<Rules> {
        let [width, height] = grid_size(ROOM_SIZE, 2, 1).or_else(refuse::<Self, _>)?;
        let rules = Rules::new(width, height, square(ROOM_SIZE) * 8, "");
        rules.missions("pick up the {} box", [Color::names()])
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Making<Cell> {
        let mut rooms = Rooms::new(draft, ROOM_SIZE, 2, 1)?;
        let target = rooms.add_object(1, 0, Some(Kind::Box), None)?;
        let (door, _) = rooms.add_door(0, 0, Some(0), None, Some(true))?;
        rooms.add_object(0, 0, Some(Kind::Key), Some(door.color()))?;
        rooms.place_agent(Some((0, 0)))?;
        draft.mission(format!("pick up the {}", describe(target)));
        Ok(target)
    }

    fn step(
        &self,
        world: &mut World,
        target: &mut Cell,
        action: Action,
        _rng: &mut Generator,
    ) -> Outcome {
        pick_up(world, *target, action)
    }
}

ids! { UnlockPickup, "Pick up the box in the other room, behind a locked door.":
    "MiniGrid-UnlockPickup-v0", "{}";
}
