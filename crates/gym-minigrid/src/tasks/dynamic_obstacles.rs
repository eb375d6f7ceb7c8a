//! DynamicObstacles: reach the goal without running into moving balls.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | left, right, forward: the first three of [`Action`]; the others turn left |
//! | reward | `1 - 0.9 * steps / max_steps` in the goal; -1 for moving forward against an obstacle; else 0 |
//! | start | in the top left corner, looking right; at random in the ids with `Random` |
//! | end | terminated in the goal and against an obstacle |
//! | limit | `4 * size * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/dynamicobstacles.py`.

use gym_core::registry::Exceptions;
use gym_core::{Generator, Outcome};

use super::{DIRECTION, direction, ids};
use crate::draft::{Area, MAX_CHOICES};
use crate::level::{Level, Rules, level};
use crate::{Action, Cell, Color, Draft, Generated, Kind, Pos, World};

/// The number of attempts to move an obstacle.
const MAX_TRIES: u32 = 100;

/// The number of actions: left, right, forward.
const ACTION_COUNT: usize = 3;

level! {
    /// Arguments.
    DynamicObstacles {
        /// Columns and rows of the grid, walls included.
        pub size: u32 = 8,
        /// Where the agent starts; at random if null.
        pub agent_start_pos: Option<[u32; 2]> = Some([1, 1]),
        /// The direction in which the agent looks first: right, down, left, up.
        pub agent_start_dir: u32 = 0,
        /// The number of obstacles; if it is above `size / 2 + 1`, it is `size / 2`.
        pub n_obstacles: u32 = 4,
    }
}

impl Level for DynamicObstacles {
    fn rules(&self) -> Result<Rules, String> {
        direction(self.agent_start_dir)?;
        let rules = Rules::square(self.size, 4, "get to the green goal square");
        Ok(Rules {
            actions: ACTION_COUNT as u32,
            ..rules.see_through()
        })
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        draft.world.grid.surround();
        draft.put(Pos::new(draft.width() - 2, draft.height() - 2), Cell::GOAL);
        match self.agent_start_pos {
            Some(pos) => draft.put_agent(pos, self.agent_start_dir as u8),
            None => draft.place_agent()?,
        }
        let is_few = u64::from(self.n_obstacles) * 2 <= u64::from(self.size) + 2;
        let count = if is_few {
            self.n_obstacles
        } else {
            self.size / 2
        };
        for _ in 0..count {
            let ball = draft.object(Kind::Ball, Color::Blue);
            draft.place_if(ball, draft.whole(), MAX_TRIES, |_, _| true)?;
            draft.world.targets.push(ball);
        }
        Ok(())
    }

    fn step(&self, world: &mut World, action: Action, rng: &mut Generator) -> Outcome {
        let action = match action {
            Action::Left | Action::Right | Action::Forward => action,
            _ => Action::Left,
        };
        let front = world.front();
        let hits = action == Action::Forward && !front.is_empty() && !front.is(Kind::Goal);
        for index in 0..world.targets.len() {
            let ball = world.targets[index];
            let Some(old) = world.thing(ball).map(|thing| thing.pos) else {
                continue;
            };
            let around = Area::new(old.x - 1, old.y - 1, 3, 3);
            // a ball with no free position around it stays
            if Draft::new(world, rng, MAX_CHOICES)
                .place_if(ball, around, MAX_TRIES, |_, _| true)
                .is_ok()
            {
                world.grid.set(old, Cell::EMPTY);
            }
        }
        let outcome = world.step(action);
        if hits {
            return Outcome {
                reward: -1.0,
                terminated: true,
                ..outcome
            };
        }
        outcome
    }
}

/// The conformance exceptions.
const EXCEPTIONS: Exceptions = &[
    DIRECTION[0],
    DIRECTION[1],
    ("action-validated", BEYOND),
    ("refusal-changes-nothing", BEYOND),
];

const BEYOND: &str = "an action beyond the space turns left, as in minigrid";

/// The names of the actions in the space.
const ACTIONS: &[(&str, &str)] = Action::VARIANTS.split_at(ACTION_COUNT).0;

ids! { DynamicObstacles, "Reach the goal without running into moving balls.", excused EXCEPTIONS, named ACTIONS:
    "MiniGrid-Dynamic-Obstacles-5x5-v0", r#"{"size": 5, "n_obstacles": 2}"#;
    "MiniGrid-Dynamic-Obstacles-Random-5x5-v0",
        r#"{"size": 5, "agent_start_pos": null, "n_obstacles": 2}"#;
    "MiniGrid-Dynamic-Obstacles-6x6-v0", r#"{"size": 6, "n_obstacles": 3}"#;
    "MiniGrid-Dynamic-Obstacles-Random-6x6-v0",
        r#"{"size": 6, "agent_start_pos": null, "n_obstacles": 3}"#;
    "MiniGrid-Dynamic-Obstacles-8x8-v0", "{}";
    "MiniGrid-Dynamic-Obstacles-16x16-v0", r#"{"size": 16, "n_obstacles": 8}"#;
}
