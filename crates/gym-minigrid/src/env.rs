//! The environment of a level.

use std::any::{Any, TypeId};
use std::marker::PhantomData;
use std::sync::Arc;

use gym_core::canvas::Canvas;
use gym_core::keys::json;
use gym_core::registry::{Build, Clip};
use gym_core::render::Metadata;
use gym_core::spaces::{BoxSpace, DictSpace, array_of};
use gym_core::{
    Arguments, BoxEnv, DType, Env, Error, Generator, Inspect, Keys, Names, Outcome, Policy,
    Registration, Reset, Result, Snapshot, Space, Value,
};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::advice::{Read, advice, generate, read};
use crate::draft::{GenerationError, MAX_CHOICES};
use crate::level::{Level, Rules, View};
use crate::picture::Picture;
use crate::view::MAX_VIEW;
use crate::{Action, Grid, World, vector};

/// The environment of a [`Level`].
///
/// Its [`Facts`] and, after the first reset, its [`World`] are layers of the environment:
/// `env.layer::<World>()` finds them through wrappers.
#[derive(Clone, Debug)]
pub struct GridEnv {
    level: Arc<dyn Level>,
    /// The arguments, as JSON, and how another level is read from others.
    config: Arc<Json>,
    read: Read,
    facts: Arc<Facts>,
    picture: Arc<Picture>,
    episode: Option<Episode>,
}

/// The settings of an environment, computed from its arguments.
#[derive(Clone, Debug)]
pub struct Facts {
    /// The arguments that all tasks share.
    pub view: View,
    /// The task's rules. `max_steps` and `see_through_walls` have the values in use.
    pub rules: Rules,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Episode {
    world: World,
    rng: Generator,
}

impl GridEnv {
    /// Makes the environment of a level.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    pub fn new<L: Level + Arguments>(level: L) -> Result<Self> {
        let config = serde_json::to_value(&level);
        Self::of(Arc::new(level), config, read::<L>)
    }

    fn of(level: Arc<dyn Level>, config: serde_json::Result<Json>, read: Read) -> Result<Self> {
        let name = level.name();
        let mut config = config.map_err(|error| Error::argument(name, error.to_string()))?;
        let facts = Facts::new(&*level).map_err(|mut reason| {
            if let Some(advice) = advice(&*level, read, &config) {
                reason += &format!("; {advice}");
            }
            Error::argument(name, reason)
        })?;
        let picture = Picture::new(&facts).map_err(|reason| Error::argument(name, reason))?;
        // store the value in use; `max_steps` stays as given, because the value in use can depend
        // on the mission
        config["see_through_walls"] = facts.rules.see_through_walls.into();
        Ok(Self {
            level,
            config: config.into(),
            read,
            picture: picture.into(),
            facts: facts.into(),
            episode: None,
        })
    }

    /// The settings, computed from the arguments.
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    /// The grid, the agent and the mission; `None` before the first reset.
    pub fn world(&self) -> Option<&World> {
        self.episode.as_ref().map(|episode| &episode.world)
    }

    fn start(&self, mut rng: Generator) -> Result<Episode> {
        match generate(&*self.level, &self.facts, &mut rng, MAX_CHOICES) {
            Ok(world) => Ok(Episode { world, rng }),
            Err(error) => {
                let reason = match error {
                    GenerationError::Impossible(reason) => reason,
                    GenerationError::Rejected(reason) => reason.to_owned(),
                };
                let advice = advice(&*self.level, self.read, &self.config)
                    .unwrap_or_else(|| "change several arguments".to_owned());
                let reason = format!("{reason}; {advice}");
                Err(Error::argument(self.level.name(), reason))
            }
        }
    }

    /// Returns the world that frames show: the agent already carries its pending object.
    fn shown(&self) -> Option<World> {
        let mut world = self.world()?.clone();
        world.begin();
        Some(world)
    }
}

impl Facts {
    pub(crate) fn new(level: &dyn Level) -> Result<Self, String> {
        let view: View = level.as_ref().clone();
        let mut rules = level.rules()?;
        let size = view.agent_view_size;
        if size.is_multiple_of(2) || !(3..=MAX_VIEW).contains(&size) {
            return Err(format!(
                "agent_view_size is {size}: it is an odd number from 3 to {MAX_VIEW}"
            ));
        }
        let sides = 3..=Grid::MAX_SIDE;
        if !(sides.contains(&rules.width) && sides.contains(&rules.height)) {
            return Err(format!(
                "the grid has {} by {} cells: from 3 to {} each are possible",
                rules.width,
                rules.height,
                Grid::MAX_SIDE
            ));
        }
        rules.max_steps = view.max_steps.unwrap_or(rules.max_steps);
        rules.see_through_walls = view.see_through_walls.unwrap_or(rules.see_through_walls);
        if rules.max_steps == 0 {
            return Err("max_steps is 0: an episode has at least one step".into());
        }
        Ok(Self { view, rules })
    }

    fn is_valid(&self, world: &World) -> bool {
        let Rules { width, height, .. } = self.rules;
        world.is_valid(width as i32, height as i32) && self.rules.missions.has(&world.mission)
    }

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

    /// Writes the agent's view, a square of `size` by `size` cells, to `image`.
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

impl Env for GridEnv {
    type Observation = Value;
    type Action = Action;

    fn observation_space(&self) -> Space {
        self.facts.observation_space()
    }

    fn action_space(&self) -> Space {
        Space::discrete(self.facts.rules.actions.into())
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        let rng = reset.generator(self.episode.as_ref().map(|episode| &episode.rng))?;
        let episode = self.start(rng)?;
        self.facts.observe(&episode.world, observation);
        self.episode = Some(episode);
        Ok(())
    }

    fn step_into(&mut self, action: &Action, observation: &mut Value) -> Result<Outcome> {
        let Some(Episode { world, rng }) = &mut self.episode else {
            return Err(Error::ResetNeeded("step"));
        };
        world.begin();
        let outcome = self.level.step(world, *action, rng);
        self.facts.observe(world, observation);
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::with_config(self.level.name(), &*self.config, &self.episode)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let is_valid = |episode: &Episode| self.facts.is_valid(&episode.world);
        self.episode = snapshot.for_config(self.level.name(), &*self.config, is_valid)?;
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
        self.level.name().to_owned()
    }

    fn any_layer(&self, layer: TypeId) -> Option<&dyn Any> {
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

    fn inspect(&self) -> Option<&dyn Inspect> {
        Some(self)
    }

    fn inspect_mut(&mut self) -> Option<&mut dyn Inspect> {
        Some(self)
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.episode.as_mut().map(|episode| &mut episode.rng)
    }

    fn close(&mut self) {
        self.episode = None;
    }
}

impl Inspect for GridEnv {
    fn state(&self) -> Option<Json> {
        serde_json::to_value(self.shown()?).ok()
    }

    fn set_state(&mut self, state: Json) -> Result<()> {
        let world = serde_json::from_value(state)
            .map_err(|error| Error::argument("state", error.to_string()))?;
        let episode = self
            .episode
            .as_mut()
            .ok_or(Error::ResetNeeded("set_state"))?;
        if !self.facts.is_valid(&world) {
            return Err(Error::argument("state", "it is not one of this grid"));
        }
        episode.world = world;
        Ok(())
    }

    fn arguments(&self) -> Json {
        (*self.config).clone()
    }
}

/// The entry point of levels of one type, for registrations.
#[derive(Debug)]
pub struct Entry<L>(PhantomData<L>);

impl<L: Level + Arguments + Clone> Build for Entry<L> {
    type Config = L;
    type Env = GridEnv;

    fn build(level: L, _version: u32) -> Result<GridEnv> {
        GridEnv::new(level)
    }
}

/// The clip on the page of a level that has a good policy.
const CLIP: Clip = Clip {
    seeds: 1..2,
    every: 1,
    frames: 24,
    size: (96, 96),
};

/// The conformance exceptions of every level.
pub(crate) const WINDOW: (&str, &str) = (
    "arguments-matter.screen_size",
    "a window has the size of the picture",
);

/// Returns the registration of a level under the id `id`. `policy` is the good policy.
pub const fn register<L: Level + Arguments + Clone>(
    id: &'static str,
    description: &'static str,
    policy: Option<Policy>,
) -> Registration {
    let registration = Registration::new::<Entry<L>>(id)
        .description(description)
        .exceptions(&[WINDOW])
        .vector_entry_point(vector::entry_point::<L>)
        .light_step()
        .actions(Action::VARIANTS)
        .names(|_| Names::new(&["direction: 0 right, 1 down, 2 left, 3 up"], &[]))
        .keys(keys);
    match policy {
        Some(policy) => registration.policy(policy).clip(CLIP),
        None => registration,
    }
}

/// Returns the keys of the actions in the task's action space.
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
