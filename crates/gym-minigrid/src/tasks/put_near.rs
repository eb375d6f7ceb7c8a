//! PutNear: put an object near another one.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`] |
//! | reward | `1 - 0.9 * steps / max_steps` for the right object dropped beside the other, else 0 |
//! | start | objects, none beside another, and the agent at random |
//! | end | terminated by picking up a wrong object, and by dropping one |
//! | limit | `5 * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/putnear.py`.

#![expect(non_snake_case, reason = "an argument has minigrid's name")]

use gym_core::{Generator, Outcome};

use super::{describe, distinct_objects, ids, is_alike, names};
use crate::level::{Level, Rules, level};
use crate::rooms::KINDS;
use crate::{Action, Color, Draft, Generated, World};

level! {
    /// Arguments.
    PutNear {
        /// Columns and rows of the grid, walls included.
        pub size: u32 = 6,
        /// The number of objects: at least 2.
        pub numObjs: u32 = 2,
    }
}

impl Level for PutNear {
    fn rules(&self) -> Result<Rules, String> {
        if self.numObjs < 2 {
            return Err(format!(
                "numObjs is {}: at least 2 are needed",
                self.numObjs
            ));
        }
        let rules = Rules::new(self.size, self.size, self.size.saturating_mul(5), "").see_through();
        let words = [Color::names(), names(&KINDS), Color::names(), names(&KINDS)];
        rules.missions("put the {} {} near the {} {}", words)
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        draft.world.grid.surround();
        let objects = distinct_objects(draft, self.numObjs, |objects, pos| {
            !objects.iter().any(|(_, other)| pos.is_near(*other))
        })?;
        draft.place_agent()?;
        let index = draft.int(0, objects.len() as i32)?;
        let target = loop {
            let target = draft.int(0, objects.len() as i32)?;
            if target != index {
                break target as usize;
            }
        };
        let (moved, (target, pos)) = (objects[index as usize].0, objects[target]);
        draft.mission(format!(
            "put the {} near the {}",
            describe(moved),
            describe(target)
        ));
        draft.world.targets.push(moved);
        draft.world.places.push(pos);
        Ok(())
    }

    fn step(&self, world: &mut World, action: Action, _rng: &mut Generator) -> Outcome {
        let before = world.carrying;
        let mut outcome = world.step(action);
        if action == Action::Pickup
            && !world.carrying.is_empty()
            && !is_alike(world.carrying, world.target(0))
        {
            outcome.terminated = true;
        }
        if action == Action::Drop && !before.is_empty() {
            if world.front() == before && world.front_pos().is_near(world.place(0)) {
                outcome.reward = world.reward();
            }
            outcome.terminated = true;
        }
        outcome
    }
}

ids! { PutNear, "Put an object near another one.":
    "MiniGrid-PutNear-6x6-N2-v0", "{}";
    "MiniGrid-PutNear-8x8-N3-v0", r#"{"size": 8, "numObjs": 3}"#;
}
