//! Fetch: pick up the object that the mission names.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`] |
//! | reward | `1 - 0.9 * steps / max_steps` for the object, else 0 |
//! | start | keys and balls, and the agent, at random |
//! | end | terminated by picking up any object |
//! | limit | `5 * size * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/fetch.py`.

#![expect(non_snake_case, reason = "an argument has minigrid's name")]

use gym_core::{Generator, Outcome};

use super::{describe, ids, is_alike, names};
use crate::level::{Level, Rules, level};
use crate::{Action, Color, Draft, Generated, Kind, World};

const PHRASES: [&str; 5] = [
    "get a",
    "go get a",
    "fetch a",
    "go fetch a",
    "you must fetch a",
];
const KINDS: [Kind; 2] = [Kind::Key, Kind::Ball];

level! {
    /// Arguments.
    Fetch {
        /// Columns and rows of the grid, walls included.
        pub size: u32 = 8,
        /// The number of objects.
        pub numObjs: u32 = 3,
    }
}

impl Level for Fetch {
    fn rules(&self) -> Result<Rules, String> {
        let rules = Rules::square(self.size, 5, "").see_through();
        rules.missions(
            "{} {} {}",
            [PHRASES.to_vec(), Color::names(), names(&KINDS)],
        )
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        draft.world.grid.surround();
        let mut objects = Vec::new();
        for _ in 0..self.numObjs {
            let kind = draft.pick(&KINDS)?;
            let color = draft.color()?;
            let cell = draft.object(kind, color);
            draft.place(cell)?;
            objects.push(cell);
        }
        draft.place_agent()?;
        let target = draft.pick(&objects)?;
        let phrase = draft.pick(&PHRASES)?;
        draft.mission(format!("{phrase} {}", describe(target)));
        draft.world.targets.push(target);
        Ok(())
    }

    fn step(&self, world: &mut World, action: Action, _rng: &mut Generator) -> Outcome {
        let mut outcome = world.step(action);
        if !world.carrying.is_empty() {
            outcome.terminated = true;
            outcome.reward = if is_alike(world.carrying, world.target(0)) {
                world.reward()
            } else {
                0.0
            };
        }
        outcome
    }
}

ids! { Fetch, "Pick up the object that the mission names.":
    "MiniGrid-Fetch-5x5-N2-v0", r#"{"size": 5, "numObjs": 2}"#;
    "MiniGrid-Fetch-6x6-N2-v0", r#"{"size": 6, "numObjs": 2}"#;
    "MiniGrid-Fetch-8x8-N3-v0", "{}";
}
