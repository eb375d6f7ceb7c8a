//! BlockedUnlockPickup: pick up the box in the other room, behind a locked door with a ball before it.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`] |
//! | reward | `1 - 0.9 * steps / max_steps` for the box, else 0 |
//! | start | the agent and the key in the left of two rooms, the box in the right one |
//! | end | terminated by picking up the box |
//! | limit | 576 steps |
//!
//! Source: minigrid 3.2.0, `envs/blockedunlockpickup.py`.

use gym_core::{Generator, Outcome};

use super::unlock_pickup::{ROOM_SIZE, add_locked_box};
use super::{describe, ids, names, pick_up, square};
use crate::level::{Level, Rules, level};
use crate::rooms::{Rooms, grid_size};
use crate::{Action, Color, Draft, Generated, Kind, World};

level! {
    /// Arguments.
    BlockedUnlockPickup {}
}

impl Level for BlockedUnlockPickup {
    fn rules(&self) -> Result<Rules, String> {
        let [width, height] = grid_size(ROOM_SIZE, 2, 1)?;
        let rules = Rules::new(width, height, square(ROOM_SIZE) * 16, "");
        rules.missions(
            "pick up the {} {}",
            [Color::names(), names(&[Kind::Box, Kind::Key])],
        )
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let mut rooms = Rooms::new(draft, ROOM_SIZE, 2, 1)?;
        let target = add_locked_box(&mut rooms, true, 0)?;
        draft.mission(format!("pick up the {}", describe(target)));
        draft.world.targets.push(target);
        Ok(())
    }

    fn step(&self, world: &mut World, action: Action, _rng: &mut Generator) -> Outcome {
        pick_up(world, action)
    }
}

ids! { BlockedUnlockPickup, "Pick up the box behind a locked and blocked door.":
    "MiniGrid-BlockedUnlockPickup-v0", "{}";
}
