//! LavaGap: get through a gap in a strip of lava.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`](crate::Action): left, right, forward; the others have no effect here |
//! | reward | `1 - 0.9 * steps / max_steps` in the goal, else 0 |
//! | start | in the top left corner, looking right |
//! | end | terminated in the goal and in lava |
//! | limit | `4 * size * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/lavagap.py`.

use super::crossing::Obstacle;
use super::ids;
use crate::level::{Level, Rules, level};
use crate::{Cell, Draft, Generated, Pos};

level! {
    /// Arguments.
    LavaGap {
        /// Columns and rows of the grid, walls included: at least 5.
        pub size: u32,
        /// What the strip is made of.
        pub obstacle_type: Obstacle = Obstacle::Lava,
    }
}

impl Level for LavaGap {
    fn rules(&self) -> Result<Rules, String> {
        if self.size < 5 {
            return Err(format!("size is {}: it is at least 5", self.size));
        }
        Ok(Rules::square(self.size, 4, self.obstacle_type.mission()))
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let (width, height) = (draft.width(), draft.height());
        draft.world.grid.surround();
        draft.put_agent(Pos::new(1, 1), 0);
        draft.put(Pos::new(width - 2, height - 2), Cell::GOAL);
        let x = draft.int(2, width - 2)?;
        let gap = Pos::new(x, draft.int(1, height - 1)?);
        draft
            .world
            .grid
            .vertical(x, 1, height - 2, self.obstacle_type.cell());
        draft.put(gap, Cell::EMPTY);
        Ok(())
    }
}

ids! { LavaGap, "Get through a gap in a strip of lava.", planned:
    "MiniGrid-LavaGapS5-v0", r#"{"size": 5}"#;
    "MiniGrid-LavaGapS6-v0", r#"{"size": 6}"#;
    "MiniGrid-LavaGapS7-v0", r#"{"size": 7}"#;
}
