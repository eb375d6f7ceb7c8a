//! Kinds of tasks on a grid, and the environment that each makes.

use std::fmt;
use std::sync::Arc;

use gym_core::canvas::Canvas;
use gym_core::keys::json;
use gym_core::render::Metadata;
use gym_core::spaces::{BoxSpace, DictSpace, MissionSpace, array_of};
use gym_core::{
    Arguments, DType, Dynamics, Element, Env, Error, Generator, Keys, Outcome, Registration, Reset,
    Result, Space, Stateful, Task, Transition, Value,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::draft::{Draft, Making, Stop};
use crate::picture::Picture;
use crate::view::MAX_VIEW;
use crate::{Action, Cell, Grid, World};

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
/// [`GridEnv`] makes an environment of it.
pub trait Level: Arguments + PartialEq + fmt::Debug + Clone + Send + Sync + 'static {
    /// The type of actions; [`Action`], unless the agent has fewer.
    type Action: Element + Copy + Into<Action>;
    /// What is remembered from the making of the level to its end, such as a target.
    type Memory: Clone + fmt::Debug + PartialEq + Send + Serialize + DeserializeOwned + 'static;

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

    /// Whether a stored memory fits a stored world.
    fn remembers(&self, world: &World, memory: &Self::Memory) -> bool {
        let _ = (world, memory);
        true
    }
}

/// The error of an argument of a level.
pub fn refuse<L: Level, T>(reason: impl Into<String>) -> Result<T> {
    Err(Error::argument(L::NAME, reason))
}

/// The environment of a [`Level`].
pub type GridEnv<L> = Stateful<GridDynamics<L>>;

/// The pure functions of a [`Level`].
#[derive(Clone)]
pub struct GridDynamics<L: Level> {
    level: Arc<L>,
    rules: Arc<Rules>,
    see_through_walls: bool,
    picture: Arc<Picture>,
}

impl<L: Level> fmt::Debug for GridDynamics<L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.level.fmt(f)
    }
}

/// A world, and what its level remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Episode<M> {
    /// The grid, the agent and the mission.
    pub world: World,
    /// What the level remembers.
    pub memory: M,
    /// Whether [`Level::begin`] is still to come.
    fresh: bool,
}

impl<L: Level> GridDynamics<L> {
    /// The level.
    pub fn level(&self) -> &L {
        &self.level
    }

    /// The facts that follow from the arguments.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    fn size(&self) -> i32 {
        self.level.view().agent_view_size as i32
    }

    /// The world after [`Level::begin`].
    fn begun(&self, episode: &Episode<L::Memory>) -> World {
        let mut world = episode.world.clone();
        if episode.fresh {
            self.level.begin(&mut world, &episode.memory);
        }
        world
    }
}

impl<L: Level> Task for GridDynamics<L> {
    type Config = L;
    type State = Episode<L::Memory>;
    type Observation = Value;
    type Action = L::Action;

    const NAME: &'static str = L::NAME;

    fn new(config: L) -> Result<Self> {
        let view = config.view();
        let size = view.agent_view_size;
        if size % 2 == 0 || !(3..=MAX_VIEW).contains(&size) {
            return refuse::<L, _>(format!(
                "agent_view_size is {size}: it is an odd number from 3 to {MAX_VIEW}"
            ));
        }
        let mut rules = config.rules()?;
        let sides = 3..=Grid::MAX_SIDE;
        if !(sides.contains(&rules.width) && sides.contains(&rules.height)) {
            return refuse::<L, _>(format!(
                "the grid has {} by {} cells: from 3 to {} each are possible",
                rules.width,
                rules.height,
                Grid::MAX_SIDE
            ));
        }
        rules.max_steps = view.max_steps.unwrap_or(rules.max_steps);
        if view.max_steps == Some(0) {
            return refuse::<L, _>("max_steps is 0: an episode has at least one step");
        }
        let picture = Picture::new(view, &rules).or_else(refuse::<L, _>)?;
        Ok(Self {
            see_through_walls: view.see_through_walls.unwrap_or(rules.see_through_walls),
            picture: picture.into(),
            rules: rules.into(),
            level: config.into(),
        })
    }

    fn config(&self) -> &L {
        &self.level
    }

    fn observation_space(&self) -> Space {
        let size = self.size() as usize;
        let image = BoxSpace::uniform(0.0, 255.0, [size, size, 3], DType::U8).map(Space::from);
        let members = [
            ("direction", Space::discrete(4)),
            ("image", image.unwrap_or_else(|_| Space::discrete(1))),
            ("mission", self.rules.missions.clone().into()),
        ];
        DictSpace::new(members).map_or_else(|_| Space::discrete(1), Space::from)
    }

    fn action_space(&self) -> Space {
        // the corners of a larger space would not fit
        let all = (0..Action::ALL.len() as i64).rev();
        let last = all
            .into_iter()
            .find(|&n| L::Action::from_value(&Value::Int(n)).is_some());
        Space::discrete(last.unwrap_or_default() + 1)
    }

    fn start(&self, _reset: &Reset, rng: &mut Generator) -> Result<Self::State> {
        let Rules {
            width,
            height,
            max_steps,
            ref missions,
            ..
        } = *self.rules;
        let mut world = World::new(width as i32, height as i32, max_steps);
        if missions.words().is_empty() {
            world.mission.push_str(missions.pattern());
        }
        let mut draft = Draft::new(&mut world, rng);
        let memory = self.level.generate(&mut draft).or_else(|stop| {
            refuse::<L, _>(match stop {
                Stop::Again(reason) => format!("{reason}: reset with another seed"),
                Stop::Impossible(reason) => reason,
            })
        })?;
        if !world.grid.contains(world.agent) || !world.grid.get(world.agent).can_overlap() {
            return refuse::<L, _>(format!(
                "the agent starts at {:?}, which is not free",
                [world.agent.x, world.agent.y]
            ));
        }
        world.carrying = Cell::EMPTY;
        Ok(Episode {
            world,
            memory,
            fresh: true,
        })
    }

    fn is_valid(&self, state: &Self::State) -> bool {
        let Rules { width, height, .. } = *self.rules;
        state.world.is_valid(width as i32, height as i32)
            && self.rules.missions.has(&state.world.mission)
            && self.level.remembers(&state.world, &state.memory)
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn_and_text(10, self.picture.size())
    }

    fn ansi(&self, state: &Self::State) -> Option<String> {
        Some(format!(
            "{}\n{}",
            self.begun(state).text(),
            state.world.mission
        ))
    }

    fn draw(&self, state: &Self::State, canvas: &mut dyn Canvas) {
        self.picture
            .draw(&self.begun(state), self.see_through_walls, canvas);
    }
}

impl<L: Level> Dynamics for GridDynamics<L> {
    fn transition(
        &self,
        state: &Self::State,
        action: &L::Action,
        rng: &mut Generator,
    ) -> Result<Transition<Self::State>> {
        let mut state = state.clone();
        let Outcome {
            reward, terminated, ..
        } = self.advance(&mut state, *action, rng);
        Ok(Transition {
            state,
            reward,
            terminated,
        })
    }

    fn observe(&self, state: &Self::State) -> Value {
        let mut observation = Value::Null;
        self.observe_into(state, &mut observation);
        observation
    }

    fn observe_into(&self, state: &Self::State, observation: &mut Value) {
        let world = &state.world;
        let size = self.size();
        if !matches!(observation, Value::Dict(entries) if entries.len() == 3) {
            *observation = Value::from([
                ("direction", Value::Null),
                ("image", Value::Null),
                ("mission", Value::Text(String::new())),
            ]);
        }
        let Value::Dict(entries) = observation else {
            return;
        };
        let [(_, direction), (_, image), (_, mission)] = entries.as_mut_slice() else {
            return;
        };
        *direction = Value::Int(world.direction.into());
        let shape = [size as usize, size as usize, 3];
        if let Some(image) = array_of(image, DType::U8, &shape).as_mut_slice() {
            let view = world.view(size);
            let visible = view.visible(&world.grid, self.see_through_walls);
            view.write(&world.grid, &visible, world.carrying, image);
        }
        match mission {
            Value::Text(text) if *text == world.mission => {}
            Value::Text(text) => text.clone_from(&world.mission),
            other => *other = Value::Text(world.mission.clone()),
        }
    }

    fn truncates(&self, state: &Self::State) -> bool {
        state.world.step_count >= state.world.max_steps
    }

    fn step(
        &self,
        state: &mut Self::State,
        action: &L::Action,
        rng: &mut Generator,
        observation: &mut Value,
    ) -> Result<Outcome> {
        let outcome = self.advance(state, *action, rng);
        self.observe_into(state, observation);
        Ok(outcome)
    }
}

impl<L: Level> GridDynamics<L> {
    fn advance(
        &self,
        state: &mut Episode<L::Memory>,
        action: L::Action,
        rng: &mut Generator,
    ) -> Outcome {
        let Episode {
            world,
            memory,
            fresh,
        } = state;
        if std::mem::take(fresh) {
            self.level.begin(world, memory);
        }
        self.level.step(world, memory, action.into(), rng)
    }
}

/// The registration of a level under an id.
pub const fn register<L: Level>(id: &'static str, description: &'static str) -> Registration {
    Registration::new::<GridEnv<L>>(id)
        .description(description)
        .exceptions(&[(
            "arguments-matter.screen_size",
            "a window has the size of the picture",
        )])
        .light_step()
        .actions(Action::VARIANTS)
        .keys(|env| {
            let all = [
                ("Left", 0),
                ("Right", 1),
                ("Up", 2),
                ("Tab", 3),
                ("LeftShift", 4),
                ("Space", 5),
                ("Enter", 6),
            ];
            let count = match env.action_space() {
                Space::Discrete(space) => space.n(),
                _ => 0,
            };
            let keys = all.iter().filter(|(_, action)| *action < count);
            Keys::new(json!(
                keys.copied().collect::<std::collections::BTreeMap<_, _>>()
            ))
        })
}
