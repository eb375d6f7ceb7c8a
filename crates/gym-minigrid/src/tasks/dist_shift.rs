//! DistShift: reach the goal along strips of lava, which differ in training and in tests.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`](crate::Action): left, right, forward; the others have no effect here |
//! | reward | `1 - 0.9 * steps / max_steps` in the goal, else 0 |
//! | start | in the top left corner, looking right |
//! | end | terminated in the goal and in lava |
//! | limit | `4 * width * height` steps |
//!
//! Source: minigrid 3.2.0, `envs/distshift.py`.

use super::{DIRECTION, direction, ids};
use crate::level::{Level, Rules, level};
use crate::{Cell, Draft, Generated, Pos};

level! {
    /// Arguments.
    DistShift {
        /// The number of columns, walls included.
        pub width: u32 = 9,
        /// The number of rows, walls included.
        pub height: u32 = 7,
        /// Where the agent starts; at random if null.
        pub agent_start_pos: Option<[u32; 2]> = Some([1, 1]),
        /// The direction in which the agent looks first: right, down, left, up.
        pub agent_start_dir: u32 = 0,
        /// The row of the second strip of lava.
        pub strip2_row: u32 = 2,
    }
}

impl Level for DistShift {
    fn rules(&self) -> Result<Rules, String> {
        direction(self.agent_start_dir)?;
        let steps = self.width.saturating_mul(self.height).saturating_mul(4);
        Ok(Rules::new(
            self.width,
            self.height,
            steps,
            "get to the green goal square",
        )
        .see_through())
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let width = draft.width();
        draft.world.grid.surround();
        draft.put(Pos::new(width - 2, 1), Cell::GOAL);
        draft.world.grid.horizontal(3, 1, width - 6, Cell::LAVA);
        let row = Pos::from([0, self.strip2_row]).y;
        draft.world.grid.horizontal(3, row, width - 6, Cell::LAVA);
        match self.agent_start_pos {
            Some(pos) => draft.put_agent(pos, self.agent_start_dir as u8),
            None => draft.place_agent()?,
        }
        Ok(())
    }
}

ids! { DistShift, "Reach the goal along strips of lava.", excused DIRECTION:
    "MiniGrid-DistShift1-v0", r#"{"strip2_row": 2}"#;
    "MiniGrid-DistShift2-v0", r#"{"strip2_row": 5}"#;
}
