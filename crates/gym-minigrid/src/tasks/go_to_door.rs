//! GoToDoor: go to the door that the mission names, and say done.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`] |
//! | reward | `1 - 0.9 * steps / max_steps` for `done` beside the door, else 0 |
//! | start | a room of random size with four doors, the agent at random |
//! | end | terminated by `done` and by `toggle` |
//! | limit | `4 * size * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/gotodoor.py`.

use gym_core::{Generator, Outcome};

use super::ids;
use crate::draft::Area;
use crate::level::{Level, Rules, level};
use crate::{Action, Cell, Color, Draft, Generated, Pos, State, World};

level! {
    /// Arguments.
    GoToDoor {
        /// Columns and rows of the grid, walls included: at least 5.
        pub size: u32 = 5,
    }
}

impl Level for GoToDoor {
    fn rules(&self) -> Result<Rules, String> {
        if self.size < 5 {
            return Err(format!("size is {}: it is at least 5", self.size));
        }
        let rules = Rules::square(self.size, 4, "").see_through();
        rules.missions("go to the {} door", [Color::names()])
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let width = draft.int(5, draft.width() + 1)?;
        let height = draft.int(5, draft.height() + 1)?;
        draft.world.grid.wall_rect(0, 0, width, height);
        let doors = [
            Pos::new(draft.int(2, width - 2)?, 0),
            Pos::new(draft.int(2, width - 2)?, height - 1),
            Pos::new(0, draft.int(2, height - 2)?),
            Pos::new(width - 1, draft.int(2, height - 2)?),
        ];
        let mut colors = Vec::new();
        while colors.len() < doors.len() {
            let color = draft.color()?;
            if !colors.contains(&color) {
                colors.push(color);
            }
        }
        for (pos, color) in doors.into_iter().zip(&colors) {
            draft.put(pos, Cell::door(*color, State::Closed));
        }
        draft.place_agent_in(Area::new(0, 0, width, height), u32::MAX)?;
        let index = draft.int(0, doors.len() as i32)? as usize;
        draft.mission(format!("go to the {} door", colors[index].name()));
        draft.world.places.push(doors[index]);
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

ids! { GoToDoor, "Go to the door that the mission names, and say done.":
    "MiniGrid-GoToDoor-5x5-v0", "{}";
    "MiniGrid-GoToDoor-6x6-v0", r#"{"size": 6}"#;
    "MiniGrid-GoToDoor-8x8-v0", r#"{"size": 8}"#;
}
