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

use gym_core::{Generator, Outcome};

use super::{describe, ids, pick_up, square};
use crate::level::{Level, Rules, level};
use crate::rooms::{Rooms, grid_size};
use crate::{Action, Cell, Color, Draft, Generated, Kind, World};

/// Columns and rows of a room, walls included.
pub(super) const ROOM_SIZE: u32 = 6;

/// Places a box in the right of two rooms, behind a locked door, optionally with a ball in front of
/// it. The left room gets the key and the agent, both rooms get other objects. Returns the box.
pub(crate) fn add_locked_box(
    rooms: &mut Rooms<'_, '_>,
    blocked: bool,
    distractors: u32,
) -> Generated<Cell> {
    let target = rooms.add_object(1, 0, Some(Kind::Box), None)?;
    let (door, pos) = rooms.add_door(0, 0, Some(0), None, Some(true))?;
    if blocked {
        let color = rooms.draft.color()?;
        rooms.block(pos, 0, color);
    }
    rooms.add_object(0, 0, Some(Kind::Key), Some(door.color()))?;
    rooms.add_distractors(None, distractors, true)?;
    rooms.place_agent(Some((0, 0)))?;
    Ok(target)
}

level! {
    /// Arguments.
    UnlockPickup {}
}

impl Level for UnlockPickup {
    fn rules(&self) -> Result<Rules, String> {
        let [width, height] = grid_size(ROOM_SIZE, 2, 1)?;
        let rules = Rules::new(width, height, square(ROOM_SIZE) * 8, "");
        rules.missions("pick up the {} box", [Color::names()])
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let mut rooms = Rooms::new(draft, ROOM_SIZE, 2, 1)?;
        let target = add_locked_box(&mut rooms, false, 0)?;
        draft.mission(format!("pick up the {}", describe(target)));
        draft.world.targets.push(target);
        Ok(())
    }

    fn step(&self, world: &mut World, action: Action, _rng: &mut Generator) -> Outcome {
        pick_up(world, action)
    }
}

ids! { UnlockPickup, "Pick up the box in the other room, behind a locked door.":
    "MiniGrid-UnlockPickup-v0", "{}";
}
