//! RedBlueDoors: open the red door, then the blue one.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`] |
//! | reward | `1 - 0.9 * steps / max_steps` for the blue door after the red one, else 0 |
//! | start | between two walls with a door each, the agent at random |
//! | end | terminated once the blue door is open, and by opening the red one after the blue one |
//! | limit | `20 * size * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/redbluedoors.py`.

use gym_core::{Generator, Outcome};

use super::ids;
use crate::draft::Area;
use crate::level::{Level, Rules, level};
use crate::{Action, Cell, Color, Draft, Generated, Pos, State, World};

level! {
    /// Arguments.
    RedBlueDoors {
        /// The number of rows; there are twice as many columns.
        pub size: u32 = 8,
    }
}

impl Level for RedBlueDoors {
    fn rules(&self) -> Result<Rules, String> {
        let rules = Rules::square(self.size, 20, "open the red door then the blue door");
        Ok(Rules {
            width: self.size.saturating_mul(2),
            ..rules
        })
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let size = draft.height();
        draft.world.grid.wall_rect(0, 0, 2 * size, size);
        draft.world.grid.wall_rect(size / 2, 0, size, size);
        draft.place_agent_in(Area::new(size / 2, 0, size, size), u32::MAX)?;
        let red = Pos::new(size / 2, draft.int(1, size - 1)?);
        draft.put(red, Cell::door(Color::Red, State::Closed));
        let blue = Pos::new(size / 2 + size - 1, draft.int(1, size - 1)?);
        draft.put(blue, Cell::door(Color::Blue, State::Closed));
        draft.world.places = vec![red, blue];
        Ok(())
    }

    fn step(&self, world: &mut World, action: Action, _rng: &mut Generator) -> Outcome {
        let is_open = |world: &World| {
            [0, 1].map(|door| world.grid.get(world.place(door)).is_door(State::Open))
        };
        let [red_before, blue_before] = is_open(world);
        let mut outcome = world.step(action);
        let [red_after, blue_after] = is_open(world);
        if blue_after {
            outcome.reward = if red_before { world.reward() } else { 0.0 };
            outcome.terminated = true;
        } else if red_after && blue_before {
            outcome.reward = 0.0;
            outcome.terminated = true;
        }
        outcome
    }
}

ids! { RedBlueDoors, "Open the red door, then the blue one.":
    "MiniGrid-RedBlueDoors-6x6-v0", r#"{"size": 6}"#;
    "MiniGrid-RedBlueDoors-8x8-v0", "{}";
}
