//! Unlock: open a locked door with the key.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`] |
//! | reward | `1 - 0.9 * steps / max_steps` for the open door, else 0 |
//! | start | the agent and the key in the left of two rooms |
//! | end | terminated by opening the door |
//! | limit | 288 steps |
//!
//! Source: minigrid 3.2.0, `envs/unlock.py`.

use gym_core::{Generator, Outcome};

use super::{ids, square};
use crate::level::{Level, Rules, level};
use crate::rooms::{Rooms, grid_size};
use crate::{Action, Draft, Generated, Kind, State, World};

/// Columns and rows of a room, walls included.
const ROOM_SIZE: u32 = 6;

level! {
    /// Arguments.
    Unlock {}
}

impl Level for Unlock {
    fn rules(&self) -> Result<Rules, String> {
        let [width, height] = grid_size(ROOM_SIZE, 2, 1)?;
        Ok(Rules::new(
            width,
            height,
            square(ROOM_SIZE) * 8,
            "open the door",
        ))
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let mut rooms = Rooms::new(draft, ROOM_SIZE, 2, 1)?;
        let (door, pos) = rooms.add_door(0, 0, Some(0), None, Some(true))?;
        rooms.add_object(0, 0, Some(Kind::Key), Some(door.color()))?;
        rooms.place_agent(Some((0, 0)))?;
        draft.world.places.push(pos);
        Ok(())
    }

    fn step(&self, world: &mut World, action: Action, _rng: &mut Generator) -> Outcome {
        let mut outcome = world.step(action);
        if action == Action::Toggle && world.grid.get(world.place(0)).is_door(State::Open) {
            outcome.reward = world.reward();
            outcome.terminated = true;
        }
        outcome
    }
}

ids! { Unlock, "Open a locked door with the key.":
    "MiniGrid-Unlock-v0", "{}";
}
