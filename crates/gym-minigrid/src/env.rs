//! The environment of a level.

use std::any::{Any, TypeId};
use std::sync::Arc;

use gym_core::canvas::Canvas;
use gym_core::keys::json;
use gym_core::render::Metadata;
use gym_core::spaces::{BoxSpace, DictSpace, array_of};
use gym_core::vector::lockstep::{Lockstep, Together};
use gym_core::{
    BoxEnv, Configure, DType, Element, Env, Error, Generator, Keys, Outcome, Registration, Reset,
    Result, Snapshot, Space, Value,
};
use serde::{Deserialize, Serialize};

use crate::draft::{Draft, Stop};
use crate::level::{Level, Memory, Rules, View, refuse};
use crate::picture::Picture;
use crate::view::MAX_VIEW;
use crate::{Action, Cell, Grid, World};

/// The environment of a [`Level`].
///
/// Its [`World`], once it was reset, and its [`Facts`] are layers of the environment:
/// `env.unwrapped::<World>()` finds them through wrappers, whatever the level.
#[derive(Clone, Debug)]
pub struct GridEnv<L: Level> {
    level: Arc<L>,
    facts: Arc<Facts>,
    picture: Arc<Picture>,
    episode: Option<Episode<L::Memory>>,
}

/// What follows from the arguments of an environment.
#[derive(Clone, Debug)]
pub struct Facts {
    /// The arguments of every task.
    pub view: View,
    /// Those that follow from the others; `max_steps` and `see_through_walls` are those in use.
    pub rules: Rules,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Episode<M> {
    world: World,
    memory: M,
    rng: Generator,
    /// Whether [`Level::begin`] is still to come.
    fresh: bool,
}

impl<M> Episode<M> {
    /// What happens between the first observation and the first step.
    fn begin(&mut self, level: &impl Level<Memory = M>) {
        if std::mem::take(&mut self.fresh) {
            level.begin(&mut self.world, &self.memory);
        }
    }
}

impl<L: Level> GridEnv<L> {
    /// The environment of a level.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    pub fn new(level: L) -> Result<Self> {
        let view = level.view().clone();
        let mut rules = level.rules()?;
        let size = view.agent_view_size;
        if size % 2 == 0 || !(3..=MAX_VIEW).contains(&size) {
            return refuse::<L, _>(format!(
                "agent_view_size is {size}: it is an odd number from 3 to {MAX_VIEW}"
            ));
        }
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
        rules.see_through_walls = view.see_through_walls.unwrap_or(rules.see_through_walls);
        if rules.max_steps == 0 {
            return refuse::<L, _>("max_steps is 0: an episode has at least one step");
        }
        let facts = Facts { view, rules };
        let picture = Picture::new(&facts).or_else(refuse::<L, _>)?;
        Ok(Self {
            level: level.into(),
            picture: picture.into(),
            facts: facts.into(),
            episode: None,
        })
    }

    /// The level.
    pub fn level(&self) -> &L {
        &self.level
    }

    /// What follows from its arguments.
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    /// The grid, the agent and the mission; `None` before the first reset.
    pub fn world(&self) -> Option<&World> {
        self.episode.as_ref().map(|episode| &episode.world)
    }

    /// What the level remembers; `None` before the first reset.
    pub fn memory(&self) -> Option<&L::Memory> {
        self.episode.as_ref().map(|episode| &episode.memory)
    }

    fn start(&self, mut rng: Generator) -> Result<Episode<L::Memory>> {
        let Rules {
            width,
            height,
            max_steps,
            ref missions,
            ..
        } = self.facts.rules;
        let mut world = World::new(width as i32, height as i32, max_steps);
        if missions.words().is_empty() {
            world.mission.push_str(missions.pattern());
        }
        let memory = self.level.generate(&mut Draft::new(&mut world, &mut rng));
        let memory = memory.or_else(|stop| {
            refuse::<L, _>(match stop {
                Stop::Again(reason) => format!("{reason}: reset with another seed"),
                Stop::Impossible(reason) => reason,
            })
        })?;
        if !world.grid.contains(world.agent) || !world.grid.get(world.agent).can_overlap() {
            let place = [world.agent.x, world.agent.y];
            return refuse::<L, _>(format!("the agent starts at {place:?}, which is not free"));
        }
        Ok(Episode {
            world,
            memory,
            rng,
            fresh: true,
        })
    }

    fn is_valid(&self, Episode { world, memory, .. }: &Episode<L::Memory>) -> bool {
        let Rules { width, height, .. } = self.facts.rules;
        world.is_valid(width as i32, height as i32)
            && self.facts.rules.missions.has(&world.mission)
            && memory.fits(world)
    }

    /// The world as pictures show it.
    fn shown(&self) -> Option<World> {
        let mut episode = self.episode.clone()?;
        episode.begin(&*self.level);
        Some(episode.world)
    }
}

impl Facts {
    /// The space of observations.
    pub fn observation_space(&self) -> Space {
        let size = self.view.agent_view_size as usize;
        let image = BoxSpace::uniform(0.0, 255.0, [size, size, 3], DType::U8).map(Space::from);
        let members = [
            ("direction", Space::discrete(4)),
            ("image", image.unwrap_or_else(|_| Space::discrete(1))),
            ("mission", self.rules.missions.clone().into()),
        ];
        DictSpace::new(members).map_or_else(|_| Space::discrete(1), Space::from)
    }

    /// Writes what the agent sees in a square of cells.
    pub(crate) fn look(&self, world: &World, size: u32, image: &mut Value) {
        let shape = [size as usize, size as usize, 3];
        if let Some(image) = array_of(image, DType::U8, &shape).as_mut_slice() {
            let view = world.view(size as i32);
            let visible = view.visible(&world.grid, self.rules.see_through_walls);
            view.write(&world.grid, &visible, world.carrying, image);
        }
    }

    fn observe(&self, world: &World, observation: &mut Value) {
        if !matches!(observation, Value::Dict(entries) if entries.len() == 3) {
            let mission = Value::Text(String::new());
            *observation = [
                ("direction", Value::Null),
                ("image", Value::Null),
                ("mission", mission),
            ]
            .into();
        }
        let Value::Dict(entries) = observation else {
            return;
        };
        let [(_, direction), (_, image), (_, mission)] = entries.as_mut_slice() else {
            return;
        };
        *direction = Value::Int(world.direction.into());
        self.look(world, self.view.agent_view_size, image);
        match mission {
            Value::Text(text) if *text == world.mission => {}
            Value::Text(text) => text.clone_from(&world.mission),
            other => *other = Value::Text(world.mission.clone()),
        }
    }
}

impl<L: Level> Env for GridEnv<L> {
    type Observation = Value;
    type Action = L::Action;

    fn observation_space(&self) -> Space {
        self.facts.observation_space()
    }

    fn action_space(&self) -> Space {
        let is_action = |n: &i64| L::Action::from_value(&Value::Int(*n)).is_some();
        Space::discrete((0..Action::ALL.len() as i64).filter(is_action).count() as i64)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        let rng = reset.generator(self.episode.as_ref().map(|episode| &episode.rng))?;
        let episode = self.start(rng)?;
        self.facts.observe(&episode.world, observation);
        self.episode = Some(episode);
        Ok(())
    }

    fn step_into(&mut self, action: &L::Action, observation: &mut Value) -> Result<Outcome> {
        let Self {
            level,
            facts,
            episode,
            ..
        } = self;
        let episode = episode.as_mut().ok_or(Error::ResetNeeded("step"))?;
        episode.begin(&**level);
        let Episode {
            world, memory, rng, ..
        } = episode;
        let outcome = level.step(world, memory, (*action).into(), rng);
        facts.observe(world, observation);
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::with_config(L::NAME, &*self.level, &self.episode)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.episode =
            snapshot.for_config(L::NAME, &*self.level, |episode| self.is_valid(episode))?;
        Ok(())
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn_and_text(10, self.picture.size())
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        if let Some(world) = self.shown() {
            self.picture.draw(&world, &self.facts, canvas);
        }
    }

    fn ansi(&self) -> Option<String> {
        let world = self.shown()?;
        Some(format!("{}\n{}", world.text(), world.mission))
    }

    fn describe(&self) -> String {
        L::NAME.to_owned()
    }

    fn layer(&self, layer: TypeId) -> Option<&dyn Any> {
        let layers: [Option<&dyn Any>; 3] = [
            Some(self),
            self.world().map(|world| world as &dyn Any),
            Some(&*self.facts),
        ];
        layers
            .into_iter()
            .flatten()
            .find(|any| (**any).type_id() == layer)
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.episode.as_mut().map(|episode| &mut episode.rng)
    }

    fn close(&mut self) {
        self.episode = None;
    }
}

impl<L: Level> Configure for GridEnv<L> {
    type Config = L;

    fn configure(level: L, _version: u32) -> Result<Self> {
        Self::new(level)
    }
}

/// The shared part of the steps of a vector: there is none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nothing;

impl Together for Nothing {
    const LEN: usize = 1;

    fn solve(&mut self) {}

    fn clear(&mut self) {}
}

/// A native vector steps environments of their own type, without the cost of erased ones.
impl<L: Level> Lockstep for GridEnv<L> {
    type Group = Nothing;

    fn begin_reset(&mut self, _reset: &Reset, _group: &mut Nothing) {}

    fn begin_step(&mut self, _action: &L::Action, _group: &mut Nothing) {}

    fn collect(&mut self, _group: &mut Nothing) {}
}

/// The registration of a level under an id.
pub const fn register<L: Level>(id: &'static str, description: &'static str) -> Registration {
    Registration::new::<GridEnv<L>>(id)
        .description(description)
        .exceptions(&[(
            "arguments-matter.screen_size",
            "a window has the size of the picture",
        )])
        .lockstep::<GridEnv<L>>()
        .light_step()
        .actions(Action::VARIANTS)
        .keys(keys)
}

/// The keys of the actions that there are.
fn keys(env: &BoxEnv) -> Keys {
    let all = json!({"Left": 0, "Right": 1, "Up": 2, "P": 3, "D": 4, "Space": 5, "Enter": 6});
    let space = env.action_space();
    let mut keys = Keys::new(all);
    keys.actions.retain(|(_, action)| {
        action
            .as_i64()
            .is_some_and(|n| space.contains(&Value::Int(n)))
    });
    keys
}
