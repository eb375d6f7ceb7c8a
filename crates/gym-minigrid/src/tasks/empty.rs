//! Empty: cross an empty room to the goal.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`](crate::Action): left, right, forward; the others have no effect here |
//! | reward | `1 - 0.9 * steps / max_steps` in the goal, else 0 |
//! | start | in the top left corner, looking right; at random in the ids with `Random` |
//! | end | terminated in the goal |
//! | limit | `4 * size * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/empty.py`.

use super::{DIRECTION, direction, ids};
use crate::level::{Level, Rules, level};
use crate::{Cell, Draft, Generated, Pos};

level! {
    /// Arguments.
    Empty {
        /// Columns and rows of the grid, walls included.
        pub size: u32 = 8,
        /// Where the agent starts; at random if null.
        pub agent_start_pos: Option<[u32; 2]> = Some([1, 1]),
        /// The direction in which the agent looks first: right, down, left, up.
        pub agent_start_dir: u32 = 0,
    }
}

impl Level for Empty {
    fn rules(&self) -> Result<Rules, String> {
        direction(self.agent_start_dir)?;
        Ok(Rules::square(self.size, 4, "get to the green goal square").see_through())
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        draft.world.grid.surround();
        draft.put(Pos::new(draft.width() - 2, draft.height() - 2), Cell::GOAL);
        match self.agent_start_pos {
            Some(pos) => draft.put_agent(pos, self.agent_start_dir as u8),
            None => draft.place_agent()?,
        }
        Ok(())
    }
}

ids! { Empty, "Cross an empty room to the goal.", planned, excused DIRECTION:
    "MiniGrid-Empty-5x5-v0", r#"{"size": 5}"#;
    "MiniGrid-Empty-Random-5x5-v0", r#"{"size": 5, "agent_start_pos": null}"#;
    "MiniGrid-Empty-6x6-v0", r#"{"size": 6}"#;
    "MiniGrid-Empty-Random-6x6-v0", r#"{"size": 6, "agent_start_pos": null}"#;
    "MiniGrid-Empty-8x8-v0", "{}";
    "MiniGrid-Empty-16x16-v0", r#"{"size": 16}"#;
}
