//! Kinds of tasks on a grid.

use std::fmt;

use gym_core::spaces::MissionSpace;
use gym_core::{Generator, Outcome};

use crate::draft::{Draft, Generated};
use crate::{Action, World};

gym_core::arguments! {
    /// The arguments of every task.
    #[derive(Eq)]
    pub struct View {
        /// The steps after which an episode is truncated; by default the task's own number.
        pub max_steps: Option<u32>,
        /// Whether the agent sees through walls; the default depends on the task.
        pub see_through_walls: Option<bool>,
        /// The width of the square of cells that the agent sees: an odd number.
        pub agent_view_size: u32 = 7,
        /// Whether pictures are lighter where the agent sees.
        pub highlight: bool = true,
        /// The width of a cell in pictures.
        #[unit = "px"]
        pub tile_size: u32 = 32,
        /// Whether pictures show what the agent sees instead of the whole grid.
        pub agent_pov: bool = false,
        /// The width of the window. It changes nothing here, where a window has the size of the
        /// picture.
        #[unit = "px"]
        pub screen_size: u32 = 640,
    }
}

/// The settings of a task with certain arguments.
#[derive(Clone, Debug)]
pub struct Rules {
    /// The number of columns.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
    /// The time limit of an episode.
    pub max_steps: u32,
    /// Whether the agent sees through walls.
    pub see_through_walls: bool,
    /// The space of missions.
    pub missions: MissionSpace,
    /// The number of actions in the action space: all seven, or only the first. `step` of a level
    /// receives the others too, as in minigrid.
    pub actions: u32,
}

impl Rules {
    /// A grid of this size with one mission; walls block the view.
    pub fn new(width: u32, height: u32, max_steps: u32, mission: &str) -> Self {
        Self {
            width,
            height,
            max_steps,
            see_through_walls: false,
            missions: MissionSpace::new(mission, Vec::<Vec<String>>::new())
                .unwrap_or_else(|_| MissionSpace::any(mission)),
            actions: Action::ALL.len() as u32,
        }
    }

    /// A square grid whose time limit is `steps` per cell.
    pub fn square(size: u32, steps: u32, mission: &str) -> Self {
        let steps = size.saturating_mul(size).saturating_mul(steps);
        Self::new(size, size, steps, mission)
    }

    /// Sets the missions: `pattern`, with `words` in its blanks `{}`.
    ///
    /// # Errors
    /// The reason why there is no such [`MissionSpace`].
    pub fn missions(
        self,
        pattern: &str,
        words: impl Into<Vec<Vec<&'static str>>>,
    ) -> Result<Self, String> {
        let missions =
            MissionSpace::new(pattern, words.into()).map_err(|error| error.to_string())?;
        Ok(Self { missions, ..self })
    }

    /// Lets the agent see through walls.
    #[must_use]
    pub fn see_through(self) -> Self {
        Self {
            see_through_walls: true,
            ..self
        }
    }
}

/// A kind of task on a grid. It is a struct of its arguments and of those that all tasks share; the
/// macro [`level!`](crate::level!) defines it.
///
/// [`GridEnv`](crate::GridEnv) is its environment.
pub trait Level: AsRef<View> + fmt::Debug + Send + Sync + 'static {
    /// The name of the environment, without version; by default the name of the type.
    fn name(&self) -> &'static str {
        let path = std::any::type_name::<Self>();
        path.rsplit("::").next().unwrap_or(path)
    }

    /// Computes the settings from the arguments.
    ///
    /// # Errors
    /// The reason why an argument is invalid.
    fn rules(&self) -> Result<Rules, String>;

    /// Generates a level: places walls, objects and the agent on an empty grid, and sets the
    /// mission if there are several. Store objects and positions that end the episode in
    /// [`World::targets`] and [`World::places`].
    ///
    /// # Errors
    /// [`GenerationError`](crate::GenerationError) if the attempt failed or the arguments are impossible.
    fn generate(&self, draft: &mut Draft<'_>) -> Generated;

    /// Takes a step. By default the episode terminates in the goal and in lava.
    fn step(&self, world: &mut World, action: Action, rng: &mut Generator) -> Outcome {
        let _ = rng;
        world.step(action)
    }
}

/// Defines the struct of a [`Level`], like [`gym_core::arguments!`]. The macro adds the field
/// `view` for the arguments that all tasks share. The calling crate needs `serde`.
#[macro_export]
macro_rules! level {
    ($(#[$doc:meta])* $name:ident { $($arguments:tt)* }) => {
        $crate::gym_core::arguments! {
            $(#[$doc])*
            #[derive(Eq)]
            pub struct $name {
                $($arguments)*
                /// The arguments of every task.
                #[flatten]
                pub view: $crate::level::View,
            }
        }
    };
}
pub(crate) use level;
