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

use gym_core::{Generator, Outcome, Result};

use super::{ids, level, square};
use crate::level::{Level, Rules, View, refuse};
use crate::rooms::{Rooms, grid_size};
use crate::{Action, Draft, GridEnv, Kind, Making, Pos, State, World};

/// Columns and rows of a room, walls included.
const ROOM_SIZE: u32 = 6;

/// The environment.
pub type UnlockEnv = GridEnv<Unlock>;

level! {
    /// Arguments.
    Unlock {}
}

impl Level for Unlock {
    type Action = Action;
    type Memory = Pos;

    const NAME: &'static str = "Unlock";

    fn view(&self) -> &View {
        &self.view
    }

    fn rules(&self) -> Result<Rules> {
        let [width, height] = grid_size(ROOM_SIZE, 2, 1).or_else(refuse::<Self, _>)?;
        Ok(Rules::new(
            width,
            height,
            square(ROOM_SIZE) * 8,
            "open the door",
        ))
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Making<Pos> {
        let mut rooms = Rooms::new(draft, ROOM_SIZE, 2, 1)?;
        let (door, pos) = rooms.add_door(0, 0, Some(0), None, Some(true))?;
        rooms.add_object(0, 0, Some(Kind::Key), Some(door.color()))?;
        rooms.place_agent(Some((0, 0)))?;
        Ok(pos)
    }

    fn step(
        &self,
        world: &mut World,
        door: &mut Pos,
        action: Action,
        _rng: &mut Generator,
    ) -> Outcome {
        let mut outcome = world.step(action);
        if action == Action::Toggle && world.grid.get(*door).is_door(State::Open) {
            outcome.reward = world.reward();
            outcome.terminated = true;
        }
        outcome
    }
}

ids! { Unlock, "Open a locked door with the key.":
    "MiniGrid-Unlock-v0", "{}";
}
