//! GoToObject: go to the object that the mission names, and say done.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`] |
//! | reward | `1 - 0.9 * steps / max_steps` for `done` beside the place of the object, else 0 |
//! | start | objects and the agent at random |
//! | end | terminated by `done` and by `toggle` |
//! | limit | `5 * size * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/gotoobject.py`.

#![expect(non_snake_case, reason = "an argument has minigrid's name")]

use gym_core::{Generator, Outcome};

use super::{describe, distinct_objects, ids, names};
use crate::level::{Level, Rules, level};
use crate::rooms::KINDS;
use crate::{Action, Color, Draft, Generated, World};

level! {
    /// Arguments.
    GoToObject {
        /// Columns and rows of the grid, walls included.
        pub size: u32 = 6,
        /// The number of objects.
        pub numObjs: u32 = 2,
    }
}

impl Level for GoToObject {
    fn rules(&self) -> Result<Rules, String> {
        let rules = Rules::square(self.size, 5, "").see_through();
        rules.missions("go to the {} {}", [Color::names(), names(&KINDS)])
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        draft.world.grid.surround();
        let objects = distinct_objects(draft, self.numObjs, |_, _| true)?;
        draft.place_agent()?;
        let (target, pos) = draft.pick(&objects)?;
        draft.mission(format!("go to the {}", describe(target)));
        draft.world.places.push(pos);
        Ok(())
    }

    fn step(&self, world: &mut World, action: Action, _rng: &mut Generator) -> Outcome {
        let mut outcome = world.step(action);
        outcome.terminated |= matches!(action, Action::Toggle | Action::Done);
        if action == Action::Done && world.agent.distance(world.place(0)) == 1 {
            outcome.reward = world.reward();
        }
        outcome
    }
}

ids! { GoToObject, "Go to the object that the mission names, and say done.":
    "MiniGrid-GoToObject-6x6-N2-v0", "{}";
    "MiniGrid-GoToObject-8x8-N2-v0", r#"{"size": 8, "numObjs": 2}"#;
}
