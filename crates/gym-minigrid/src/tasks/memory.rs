//! Memory: look at an object, and go to the one of two objects that equals it.
//!
//! | | |
//! |---|---|
//! | observation | `image`: kind, colour and state of the 7 by 7 cells before the agent; `direction`; `mission` |
//! | action | [`Action`]; `pickup` does what `toggle` does |
//! | reward | `1 - 0.9 * steps / max_steps` beside the object of the same kind, else 0 |
//! | start | in a small room with an object, or in the hallway to the two others, looking right |
//! | end | terminated beside either object |
//! | limit | `5 * size * size` steps |
//!
//! Source: minigrid 3.2.0, `envs/memory.py`.

use gym_core::registry::Exceptions;
use gym_core::{Generator, Outcome};

use super::ids;
use crate::env::WINDOW;
use crate::level::{Level, Rules, level};
use crate::{Action, Cell, Color, Draft, Generated, Kind, Pos, World};

level! {
    /// Arguments.
    Memory {
        /// Columns and rows of the grid, walls included; an odd number.
        pub size: u32 = 7,
        /// Whether the length of the hallway is random.
        pub random_length: bool = false,
    }
}

impl Level for Memory {
    fn rules(&self) -> Result<Rules, String> {
        if self.size.is_multiple_of(2) || self.size < 7 {
            return Err(format!(
                "size is {}: it is an odd number from 7 on",
                self.size
            ));
        }
        let mission = "go to the matching object at the end of the hallway";
        Ok(Rules::square(self.size, 5, mission))
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Generated {
        let (width, height) = (draft.width(), draft.height());
        let middle = height / 2;
        let (upper, lower) = (middle - 2, middle + 2);
        draft.world.grid.surround();
        let end = if self.random_length {
            draft.int(4, width - 2)?
        } else {
            width - 3
        };
        let grid = &mut draft.world.grid;
        grid.horizontal(1, upper, 4, Cell::WALL);
        grid.horizontal(1, lower, 4, Cell::WALL);
        for y in [upper + 1, lower - 1] {
            grid.set(Pos::new(4, y), Cell::WALL);
            grid.horizontal(5, y, end - 5, Cell::WALL);
        }
        for y in (0..height).filter(|y| *y != middle) {
            grid.set(Pos::new(end, y), Cell::WALL);
        }
        grid.vertical(end + 2, 0, height, Cell::WALL);

        let x = draft.int(1, end + 1)?;
        draft.put_agent(Pos::new(x, middle), 0);
        let kinds = [Kind::Key, Kind::Ball];
        let shown = draft.pick(&kinds)?;
        draft.put(Pos::new(1, middle - 1), Cell::new(shown, Color::Green));
        let [above, below] = draft.pick(&[[Kind::Ball, Kind::Key], kinds])?;
        draft.put(
            Pos::new(end + 1, middle - 2),
            Cell::new(above, Color::Green),
        );
        draft.put(
            Pos::new(end + 1, middle + 2),
            Cell::new(below, Color::Green),
        );
        let (above_pos, below_pos) = (Pos::new(end + 1, middle - 1), Pos::new(end + 1, middle + 1));
        draft.world.places = if shown == above {
            vec![above_pos, below_pos]
        } else {
            vec![below_pos, above_pos]
        };
        Ok(())
    }

    fn step(&self, world: &mut World, action: Action, _rng: &mut Generator) -> Outcome {
        let action = if action == Action::Pickup {
            Action::Toggle
        } else {
            action
        };
        let mut outcome = world.step(action);
        if world.agent == world.place(0) {
            outcome.reward = world.reward();
            outcome.terminated = true;
        }
        if world.agent == world.place(1) {
            outcome.reward = 0.0;
            outcome.terminated = true;
        }
        outcome
    }
}

const LENGTH: Exceptions = &[
    WINDOW,
    (
        "arguments-matter.random_length",
        "a grid of 7 columns has room for one length",
    ),
];

ids! { Memory, "Look at an object, and go to the one that equals it.", excused LENGTH:
    "MiniGrid-MemoryS17Random-v0", r#"{"size": 17, "random_length": true}"#;
    "MiniGrid-MemoryS13Random-v0", r#"{"size": 13, "random_length": true}"#;
    "MiniGrid-MemoryS13-v0", r#"{"size": 13}"#;
    "MiniGrid-MemoryS11-v0", r#"{"size": 11}"#;
    "MiniGrid-MemoryS9-v0", r#"{"size": 9}"#;
    "MiniGrid-MemoryS7-v0", r#"{"size": 7}"#;
}
