//! The environment of a task.

use std::marker::PhantomData;
use std::sync::{Arc, OnceLock};

use gym_core::canvas::Canvas;
use gym_core::registry::Build;
use gym_core::render::Metadata;
use gym_core::spaces::BoxSpace;
use gym_core::vector::lockstep::Lockstep;
use gym_core::{
    Array, Env, Error, Generator, Inspect, Outcome, RandomState, Reset, Result, Seed, Snapshot,
    Space, Value,
};
use gym_mujoco::Data;
use gym_mujoco::tasks::{Common as Camera, Place, Stride, Worlds};
use gym_mujoco::view::View;
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};

use crate::arguments::Common;
use crate::observation::{Layout, Observation};
use crate::pixels::Pixels;
use crate::start::Start;
use crate::task::{Domain, Task};
use crate::world::World;

/// The environment of a task.
///
/// A reset with the seed `s` starts the first episode of a task that dm_control loads with
/// `RandomState(s)`; a reset without a seed starts its next episode. If the state diverges,
/// dm_control raises `PhysicsError`; this environment continues from MuJoCo's reset of the
/// simulation.
#[derive(Clone, Debug)]
pub struct ControlEnv {
    /// The name of the domain.
    name: &'static str,
    /// All arguments, as JSON.
    config: Arc<Json>,
    /// The shared arguments.
    common: Arc<Common>,
    task: Arc<dyn Task>,
    /// The number of timesteps per step.
    timesteps: usize,
    world: World,
    view: View,
    observation_space: Space,
    action_space: Space,
    layout: Layout,
    /// The number of steps of an episode, which can be fractional or infinite.
    limit: f64,
    seen: Observation,
    pixels: Option<Pixels>,
    /// The properties of a step, if the task's worlds can step together.
    stride: Option<Stride>,
    episode: Option<Box<Episode>>,
    /// A copy of the data with current derived arrays, computed on request if the episode's arrays
    /// are older than its state.
    resumed: OnceLock<Box<Data>>,
    /// The place of this environment's step in a group, while several environments step together.
    place: Option<Place>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Episode {
    rng: RandomState,
    /// The generator that `Env::generator` returns, for wrappers.
    generator: Generator,
    constants: Vec<f64>,
    steps: u64,
    data: Data,
}

/// The bound of a control without a range, in the action space.
const UNBOUNDED: f64 = 1e10;

impl ControlEnv {
    /// Makes the environment.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    pub fn new<D: Domain>(config: &D::Config) -> Result<Self> {
        let json = serde_json::to_value(config);
        let json = json.map_err(|error| Error::argument(D::NAME, error.to_string()))?;
        let common = config.as_ref();
        let world = World::new(&D::text(config)?, common.mujoco.0)?;
        common.check(&world.model)?;
        let task = Arc::new(D::new(config, &world.model)?);
        Self::of((D::NAME, task), (json, common), world, D::TIMESTEPS)
    }

    fn of(
        (name, task): (&'static str, Arc<dyn Task>),
        (config, common): (Json, &Common),
        world: World,
        timesteps: usize,
    ) -> Result<Self> {
        let model = &*world.model;
        let camera = Camera {
            camera_id: Some(common.camera_id),
            ..Camera::default()
        };
        let view = View::of_task(model, &camera)?;
        let mut data = Data::new(model);
        world.settle(&mut data);
        let mut seen = Observation::default();
        task.observe(model, &data, &mut seen);
        let layout = seen.layout();
        let pixels = common.pixels.map(Pixels::new).transpose()?;
        let observation_space = match &pixels {
            Some(pixels) => pixels.space()?,
            None => layout.space(common.flat, common.dtype)?,
        };
        let bounds = |side: usize| -> Vec<f64> {
            let ranges = model
                .actuator_ctrlrange
                .iter()
                .zip(&model.actuator_ctrllimited);
            ranges
                .map(|(range, limited)| {
                    if *limited {
                        range[side]
                    } else {
                        [-UNBOUNDED, UNBOUNDED][side]
                    }
                })
                .collect()
        };
        let action_space = BoxSpace::new(bounds(0), bounds(1))?.into();
        let step = model.opt.timestep * timesteps as f64;
        let limit = common
            .time_limit
            .map_or(f64::INFINITY, |limit| limit / step);
        // an image needs all frames
        let reads = match pixels {
            None => task.reads(model),
            Some(_) => None,
        };
        let stride = reads.map(|reads| Stride {
            steps: timesteps,
            settles: true,
            contact_forces: false,
            reads,
        });
        Ok(Self {
            name,
            config: config.into(),
            common: common.clone().into(),
            task,
            timesteps,
            world,
            view,
            observation_space,
            action_space,
            layout,
            limit,
            seen,
            pixels,
            stride,
            episode: None,
            resumed: OnceLock::new(),
            place: None,
        })
    }

    /// The data of the physics; `None` before the first reset.
    pub fn data(&self) -> Option<&Data> {
        let data = &self.episode.as_ref()?.data;
        if !data.is_behind() {
            return Some(data);
        }
        Some(self.resumed.get_or_init(|| {
            let mut data = data.clone();
            self.world.resume(&mut data);
            Box::new(data)
        }))
    }

    /// Whether the last step was computed together with other worlds: see [`Data::is_behind`].
    pub fn is_behind(&self) -> bool {
        self.episode
            .as_ref()
            .is_some_and(|episode| episode.data.is_behind())
    }

    fn start(&mut self, reset: &Reset) -> Result<Box<Episode>> {
        let model = &self.world.model;
        let seed = match (&reset.seed, &self.episode) {
            (None, None) => Some(Seed::from_os()?),
            (seed, _) => seed.clone(),
        };
        // the old data is reused, not cloned: a clone would allocate its contacts again
        let mut episode = self.episode.take().unwrap_or_else(|| {
            Box::new(Episode {
                rng: RandomState::new(0),
                generator: Generator::from(0),
                constants: Vec::new(),
                steps: 0,
                data: Data::new(model),
            })
        });
        if let Some(seed) = &seed {
            episode.rng = RandomState::from_seed(seed);
            episode.generator = Generator::new(seed);
        }
        episode.steps = 0;
        episode.data.reset(model);
        self.world.settle(&mut episode.data);
        let Episode {
            rng,
            constants,
            data,
            ..
        } = &mut *episode;
        self.task.start(&mut Start {
            world: &mut self.world,
            data,
            rng,
            constants,
            seeded: seed.is_some(),
        })?;
        let common = &*self.common;
        for (given, numbers) in [
            (&common.qpos, &mut data.qpos),
            (&common.qvel, &mut data.qvel),
        ] {
            if let Some(given) = given {
                numbers.copy_from_slice(given);
            }
        }
        self.world.settle(data);
        Ok(episode)
    }

    /// Draws the state `data` on a canvas of the size `size`.
    fn picture(&self, data: &Data, size: (u32, u32), canvas: &mut dyn Canvas) {
        let model = &self.world.model;
        if self.common.visualize_reward {
            let coloured = self.world.coloured(self.task.reward(model, data));
            return self.view.draw(&coloured, data, size, canvas);
        }
        self.view.draw(model, data, size, canvas);
    }

    fn observe(&mut self, observation: &mut Value) {
        let Some(episode) = &self.episode else { return };
        if let Some(mut pixels) = self.pixels.take() {
            let draw = |size, canvas: &mut dyn Canvas| self.picture(&episode.data, size, canvas);
            pixels.write(draw, observation);
            self.pixels = Some(pixels);
            return;
        }
        let common = &*self.common;
        let (model, data) = (&*self.world.model, &episode.data);
        self.seen.clear();
        self.task.observe(model, data, &mut self.seen);
        self.seen
            .write(&self.layout, common.flat, common.dtype, observation);
    }
}

impl Env for ControlEnv {
    type Observation = Value;
    type Action = Array;

    fn observation_space(&self) -> Space {
        self.observation_space.clone()
    }

    fn action_space(&self) -> Space {
        self.action_space.clone()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        self.resumed.take();
        self.episode = Some(self.start(reset)?);
        self.observe(observation);
        Ok(())
    }

    fn step_into(&mut self, action: &Array, observation: &mut Value) -> Result<Outcome> {
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("step"));
        };
        let model = &self.world.model;
        if action.shape() != [model.nu()] || !action.is_finite() {
            return Err(self.action_space.refuse_action(action));
        }
        for (control, number) in episode.data.ctrl.iter_mut().zip(action.iter_f64()) {
            *control = number;
        }
        self.resumed.take();
        let data = &mut episode.data;
        let stride = self.stride.as_ref();
        if !stride.is_some_and(|stride| data.catch_up(model, stride)) {
            self.world.step(data, self.timesteps);
        }
        episode.steps += 1;
        let reward = self.task.reward(model, &episode.data);
        let truncated = episode.steps as f64 >= self.limit;
        let terminated = !truncated && self.task.is_over(&episode.data);
        self.observe(observation);
        Ok(Outcome {
            reward,
            terminated,
            truncated,
        })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::with_config(self.name, &*self.config, &self.episode)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let model = &self.world.model;
        let most = self.limit.min(1e15);
        let is_valid = |episode: &Episode| {
            episode.data.check(model).is_ok()
                && episode.data.is_computed()
                && episode.steps as f64 <= most
                && self.task.has(&episode.constants)
        };
        let mut episode = snapshot.for_config(self.name, &*self.config, is_valid)?;
        if let Some(Episode {
            constants, data, ..
        }) = &mut episode
        {
            if !constants.is_empty() {
                self.world
                    .change(|model| self.task.apply(constants, model))?;
            }
            data.resume(&self.world.model);
        }
        self.episode = episode.map(Box::new);
        self.resumed.take();
        Ok(())
    }

    fn metadata(&self) -> Metadata {
        let step = self.world.model.opt.timestep * self.timesteps as f64;
        let common = &self.common;
        Metadata::drawn((1.0 / step).round() as u32, (common.width, common.height))
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        if let Some(data) = self.data() {
            let size = (self.common.width, self.common.height);
            self.picture(data, size, canvas);
        }
    }

    fn describe(&self) -> String {
        self.name.to_owned()
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.episode.as_mut().map(|episode| &mut episode.generator)
    }

    fn inspect(&self) -> Option<&dyn Inspect> {
        Some(self)
    }

    fn inspect_mut(&mut self) -> Option<&mut dyn Inspect> {
        Some(self)
    }

    fn close(&mut self) {
        self.episode = None;
        self.resumed.take();
    }
}

impl Lockstep for ControlEnv {
    type Group = Worlds;

    fn begin_reset(&mut self, _: &Reset, _: &mut Worlds) {
        self.place = None;
    }

    fn begin_step(&mut self, action: &Array, worlds: &mut Worlds) {
        let model = &self.world.model;
        let fits = action.shape() == [model.nu()] && action.is_finite();
        // an episode with drawn constants has a model of its own, so its world steps alone
        let episode = self.episode.as_deref();
        let episode = episode.filter(|episode| fits && episode.constants.is_empty());
        self.place = episode
            .and_then(|episode| worlds.begin(model, self.stride.as_ref()?, &episode.data, action));
    }

    fn collect(&mut self, worlds: &mut Worlds) {
        if let (Some(place), Some(episode)) = (self.place.take(), &mut self.episode) {
            worlds.collect(place, &mut episode.data);
        }
    }
}

/// The state is `qpos` and `qvel`.
impl Inspect for ControlEnv {
    fn state(&self) -> Option<Json> {
        let Data { qpos, qvel, .. } = self.data()?;
        Some(json!({"qpos": qpos, "qvel": qvel}))
    }

    fn set_state(&mut self, state: Json) -> Result<()> {
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("set_state"));
        };
        let numbers = |name: &str| -> Result<Vec<f64>> {
            serde_json::from_value(state[name].clone())
                .map_err(|error| Error::argument(name, format!("a list of numbers: {error}")))
        };
        let mut data = episode.data.clone();
        (data.qpos, data.qvel) = (numbers("qpos")?, numbers("qvel")?);
        let checked = data.check(&self.world.model);
        checked.map_err(|error| Error::argument("state", error.to_string()))?;
        self.world.settle(&mut data);
        episode.data = data;
        self.resumed.take();
        Ok(())
    }

    fn arguments(&self) -> Json {
        (*self.config).clone()
    }
}

/// The entry point of a domain's environments, for registrations.
#[derive(Debug)]
pub struct Of<D>(PhantomData<D>);

impl<D: Domain> Build for Of<D> {
    type Config = D::Config;
    type Env = ControlEnv;

    fn build(config: D::Config, _version: u32) -> Result<ControlEnv> {
        ControlEnv::new::<D>(&config)
    }
}
