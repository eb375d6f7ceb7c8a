//! Kinds of tasks on a grid.

use std::fmt;

use gym_core::spaces::MissionSpace;
use gym_core::{Arguments, Element, Error, Generator, Outcome, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::draft::{Draft, Making};
use crate::{Action, Cell, Pos, World};

gym_core::arguments! {
    /// The arguments of every task.
    #[derive(Eq)]
    pub struct View {
        /// The steps after which an episode is truncated; by default the task's own number.
        pub max_steps: Option<u32>,
        /// Whether walls do not hide what lies behind; by default as the task has it.
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

/// The fixed facts of a task with some arguments.
#[derive(Clone, Debug)]
pub struct Rules {
    /// The number of columns.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
    /// The steps after which an episode is truncated.
    pub max_steps: u32,
    /// Whether walls do not hide what lies behind.
    pub see_through_walls: bool,
    /// The missions.
    pub missions: MissionSpace,
}

impl Rules {
    /// A grid of this size, with one mission, and walls that hide what lies behind.
    pub fn new(width: u32, height: u32, max_steps: u32, mission: &str) -> Self {
        Self {
            width,
            height,
            max_steps,
            see_through_walls: false,
            missions: MissionSpace::new(mission, Vec::<Vec<String>>::new())
                .unwrap_or_else(|_| MissionSpace::any(mission)),
        }
    }

    /// Missions with words in the blanks `{}`.
    ///
    /// # Errors
    /// The errors of [`MissionSpace::new`].
    pub fn missions(self, pattern: &str, words: impl Into<Vec<Vec<&'static str>>>) -> Result<Self> {
        let missions = MissionSpace::new(pattern, words.into())?;
        Ok(Self { missions, ..self })
    }

    /// Walls do not hide what lies behind.
    #[must_use]
    pub fn see_through(self) -> Self {
        Self {
            see_through_walls: true,
            ..self
        }
    }
}

/// A kind of task on a grid. It is a struct of [`arguments!`](gym_core::arguments!), which has a
/// [`View`] among its fields.
///
/// [`GridEnv`](crate::GridEnv) makes an environment of it.
pub trait Level: Arguments + PartialEq + fmt::Debug + Clone + Send + Sync + 'static {
    /// The type of actions; [`Action`], unless the agent has fewer.
    type Action: Element + Copy + Into<Action>;
    /// What is remembered from the making of the level to its end, such as a target.
    type Memory: Memory;

    /// The name of the environment, without version.
    const NAME: &'static str;

    /// The arguments of every task.
    fn view(&self) -> &View;

    /// The facts that follow from the arguments.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range; [`refuse`] makes it.
    fn rules(&self) -> Result<Rules>;

    /// Makes a level: places walls, objects and the agent on an empty grid, and sets the mission if
    /// there are several.
    ///
    /// # Errors
    /// [`Stop`] if chance or the arguments left no room.
    fn generate(&self, draft: &mut Draft<'_>) -> Making<Self::Memory>;

    /// Takes a step. By default the episode ends in the goal and in lava.
    fn step(
        &self,
        world: &mut World,
        memory: &mut Self::Memory,
        action: Action,
        rng: &mut Generator,
    ) -> Outcome {
        let _ = (memory, rng);
        world.step(action)
    }

    /// What happens after the first observation.
    fn begin(&self, world: &mut World, memory: &Self::Memory) {
        let _ = (world, memory);
    }
}

/// What a level remembers, in a form that can be stored.
pub trait Memory:
    Clone + fmt::Debug + PartialEq + Send + Serialize + DeserializeOwned + 'static
{
    /// Whether this can be the memory of a world; a snapshot with another one is refused.
    fn fits(&self, world: &World) -> bool {
        let _ = world;
        true
    }
}

impl Memory for () {}

/// A place on the grid.
impl Memory for Pos {
    fn fits(&self, world: &World) -> bool {
        world.grid.contains(*self)
    }
}

/// An object.
impl Memory for Cell {
    fn fits(&self, world: &World) -> bool {
        self.is_valid(world.things.len())
    }
}

impl<M: Memory> Memory for [M; 2]
where
    [M; 2]: Serialize + DeserializeOwned,
{
    fn fits(&self, world: &World) -> bool {
        self.iter().all(|memory| memory.fits(world))
    }
}

impl<M: Memory> Memory for Vec<M> {
    fn fits(&self, world: &World) -> bool {
        self.iter().all(|memory| memory.fits(world))
    }
}

impl<A: Memory, B: Memory> Memory for (A, B) {
    fn fits(&self, world: &World) -> bool {
        self.0.fits(world) && self.1.fits(world)
    }
}

/// The error of an argument of a level.
pub fn refuse<L: Level, T>(reason: impl Into<String>) -> Result<T> {
    Err(Error::argument(L::NAME, reason))
}
