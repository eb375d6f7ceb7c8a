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

use gym_core::{Generator, Outcome, Result};

use super::{describe, ids, names, square};
use crate::level::{Level, Rules, View, refuse};
use crate::rooms::{Rooms, grid_size};
use crate::{Action, Color, Draft, GridEnv, Kind, Making, World};

/// Columns and rows of a room, walls included.
const ROOM_SIZE: u32 = 6;

/// The environment.
pub type BlockedUnlockPickupEnv = GridEnv<BlockedUnlockPickup>;

gym_core::arguments! {
    /// Arguments.
    #[derive(Eq)]
    pub struct BlockedUnlockPickup {

        /// The arguments of every task.
        #[flatten]
        pub view: View,
    }
}

impl Level for BlockedUnlockPickup {
    type Action = Action;
    type Memory = u16;

    const NAME: &'static str = "BlockedUnlockPickup";

    fn view(&self) -> &View {
        &self.view
    }

    fn rules(&self) -> Result<Rules> {
        let [width, height] = grid_size(ROOM_SIZE, 2, 1).or_else(refuse::<Self, _>)?;
        let rules = Rules::new(width, height, square(ROOM_SIZE) * 16, "");
        rules.missions(
            "pick up the {} {}",
            [Color::names(), names(&[Kind::Box, Kind::Key])],
        )
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Making<u16> {
        let mut rooms = Rooms::new(draft, ROOM_SIZE, 2, 1)?;
        let target = rooms.add_object(1, 0, Some(Kind::Box), None)?;
        let (door, pos) = rooms.add_door(0, 0, Some(0), None, Some(true))?;
        let color = rooms.draft.color()?;
        rooms.block(pos, 0, color);
        rooms.add_object(0, 0, Some(Kind::Key), Some(door.color()))?;
        rooms.place_agent(Some((0, 0)))?;
        draft.mission(format!("pick up the {}", describe(target)));
        Ok(target.id())
    }

    fn step(
        &self,
        world: &mut World,
        target: &mut u16,
        action: Action,
        _rng: &mut Generator,
    ) -> Outcome {
        let mut outcome = world.step(action);
        if action == Action::Pickup && world.carrying.id() == *target {
            outcome.reward = world.reward();
            outcome.terminated = true;
        }
        outcome
    }

    fn remembers(&self, world: &World, target: &u16) -> bool {
        (1..=world.things.len()).contains(&usize::from(*target))
    }
}

const SENTENCE: &str =
    "Pick up the box in the other room, behind a locked door with a ball before it.";

ids! { BlockedUnlockPickup:
    "MiniGrid-BlockedUnlockPickup-v0", SENTENCE, "{}";
}
