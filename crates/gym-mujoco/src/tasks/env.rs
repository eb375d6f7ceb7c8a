//! The environment of a task.

use std::fmt;
use std::sync::OnceLock;

use gym_core::canvas::Canvas;
use gym_core::render::Metadata;
use gym_core::spaces::BoxSpace;
use gym_core::vector::lockstep::Lockstep;
use gym_core::{
    Array, Configure, DType, Env, Error, Generator, Inspect, Outcome, Reset, Result, Snapshot,
    Space, Value,
};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::{Value as Json, json};

use super::Simulated;
use super::arguments::TaskArguments;
use super::simulation::Simulation;
use super::together::{Place, Worlds};
use crate::lanes::Derived;
use crate::math::MAXVAL;
use crate::{Data, Revision};

/// Takes an entry of `info`.
pub type Visit<'a> = &'a mut dyn FnMut(&str, f64);

/// A task: the parts in which the environments of this crate differ.
pub trait Task: Clone + fmt::Debug + Send + Sync + Sized + 'static {
    /// The derived arrays that steps, observations and `info` read, beside positions and
    /// velocities. Vectors then step several worlds together, and compute other arrays only on
    /// request. With `None`, worlds step one by one.
    const READS: Option<&'static [Derived]> = None;

    /// The task's arguments.
    type Config: TaskArguments;
    /// The values that a step measures for the reward and `info`.
    type Step: Copy + fmt::Debug + PartialEq + Send + Serialize + DeserializeOwned;

    /// Builds the task for a version.
    ///
    /// # Errors
    /// If the model lacks a part that the task needs.
    fn new(config: &Self::Config, version: u32, simulation: &Simulation) -> Result<Self>;

    /// Draws the initial positions and velocities of an episode.
    fn start(&self, simulation: &Simulation, data: &mut Data, rng: &mut Generator);

    /// Takes a step with an action of any precision. Returns the measured values, the reward, and
    /// whether the episode terminates.
    fn step(
        &self,
        simulation: &Simulation,
        data: &mut Data,
        action: &Array,
    ) -> (Self::Step, f64, bool);

    /// The elements of the observation.
    fn observe(&self, simulation: &Simulation, data: &Data) -> impl Iterator<Item = f64>;

    /// Passes the entries of `info` to `visit`: after a step, or with `None` after a reset.
    fn info(
        &self,
        simulation: &Simulation,
        data: &Data,
        step: Option<&Self::Step>,
        visit: Visit<'_>,
    );

    /// The entry of `info` after which lengths and velocities of the tendons are inserted; `None`
    /// if `info` does not have them.
    fn tendons_follow(&self) -> Option<&'static str> {
        None
    }
}

/// The environment of a task in one of its versions.
#[derive(Clone, Debug)]
pub struct MujocoEnv<T: Task> {
    /// The version and the arguments. A snapshot must have the same.
    arguments: (u32, T::Config),
    task: T,
    simulation: Simulation,
    observation_space: Space,
    action_space: Space,
    observations: usize,
    episode: Option<Box<Episode<T::Step>>>,
    /// A copy of the data with current derived arrays, computed on request if the episode's arrays
    /// are older than its state.
    resumed: OnceLock<Box<Data>>,
    /// The place of this environment's step in a group, while several environments step together.
    place: Option<Place>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Episode<S> {
    rng: Generator,
    data: Data,
    step: Option<S>,
}

/// The newest version.
const NEWEST: u32 = 5;

impl<T: Task> MujocoEnv<T> {
    /// Makes the environment in version 5.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range, a model that cannot be read, and
    /// one that lacks a part that the task needs.
    pub fn new(config: T::Config) -> Result<Self> {
        Self::with_version(config, NEWEST)
    }

    /// Makes the environment in version 2, 3, 4 or 5.
    ///
    /// # Errors
    /// The errors of `new`; [`Error::InvalidArgument`] for a version below 2.
    pub fn with_version(config: T::Config, version: u32) -> Result<Self> {
        if version < 2 {
            let reason = format!(
                "version {version} does not exist: set 2 to {NEWEST} with `Registration::version`"
            );
            return Err(Error::argument("version", reason));
        }
        let version = version.min(NEWEST);
        if config != T::Config::defaults(version) {
            config.check_sizes()?;
        }
        let mut simulation = Simulation::new(config.as_ref(), version)?;
        if let Some(reads) = T::READS {
            simulation.read(reads);
        }
        let task = T::new(&config, version, &simulation)?;
        let mut data = Data::new(&simulation.model);
        simulation.start(&mut data);
        let observations = task.observe(&simulation, &data).count();
        let observation_space =
            BoxSpace::uniform(f64::NEG_INFINITY, f64::INFINITY, [observations], DType::F64)?.into();
        let action_space = simulation.action_space()?;
        Ok(Self {
            arguments: (version, config),
            task,
            simulation,
            observation_space,
            action_space,
            observations,
            episode: None,
            resumed: OnceLock::new(),
            place: None,
        })
    }

    #[cfg(test)]
    pub(super) fn episode_data(&self) -> Option<&Data> {
        self.episode.as_ref().map(|episode| &episode.data)
    }

    fn observe(&self, observation: &mut Array) -> Result<()> {
        let Some(episode) = &self.episode else {
            return Err(Error::ResetNeeded("step"));
        };
        let fits =
            observation.as_slice::<f64>().is_some() && observation.shape() == [self.observations];
        if !fits {
            *observation = Array::from(vec![0.0; self.observations]);
        }
        let seen = self.task.observe(&self.simulation, &episode.data);
        let numbers = observation.as_mut_slice::<f64>().unwrap_or_default();
        for (to, from) in numbers.iter_mut().zip(seen) {
            *to = from;
        }
        Ok(())
    }
}

impl<T: Task> Simulated for MujocoEnv<T> {
    fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    fn data(&self) -> Option<&Data> {
        let data = &self.episode.as_ref()?.data;
        if !data.is_behind() {
            return Some(data);
        }
        Some(self.resumed.get_or_init(|| {
            let mut data = data.clone();
            data.resume(&self.simulation.model);
            Box::new(data)
        }))
    }

    fn set_state(&mut self, qpos: &[f64], qvel: &[f64]) -> Result<()> {
        let Self {
            simulation,
            episode,
            ..
        } = self;
        let Some(episode) = episode else {
            return Err(Error::ResetNeeded("set_state"));
        };
        for (name, numbers, needed) in [
            ("qpos", qpos, simulation.model.nq()),
            ("qvel", qvel, simulation.model.nv()),
        ] {
            if numbers.len() != needed {
                let reason = format!("the model has {needed} numbers, not {}", numbers.len());
                return Err(Error::argument(name, reason));
            }
            if let Some(x) = numbers.iter().find(|x| x.is_nan() || x.abs() > MAXVAL) {
                let reason = format!("{x} is not within ±{MAXVAL:e}");
                return Err(Error::argument(name, reason));
            }
        }
        self.resumed.take();
        episode.data.qpos.copy_from_slice(qpos);
        episode.data.qvel.copy_from_slice(qvel);
        simulation.start(&mut episode.data);
        Ok(())
    }

    fn turn_camera(&mut self, azimuth: f64, elevation: f64, zoom: f64) {
        self.simulation.view.turn(azimuth, elevation, zoom);
    }
}

/// The state is `qpos` and `qvel`, as in Gymnasium's `set_state`.
impl<T: Task> Inspect for MujocoEnv<T> {
    fn state(&self) -> Option<Json> {
        let Data { qpos, qvel, .. } = &self.episode.as_ref()?.data;
        Some(json!({"qpos": qpos, "qvel": qvel}))
    }

    fn set_state(&mut self, state: Json) -> Result<()> {
        let numbers = |name: &str| -> Result<Vec<f64>> {
            serde_json::from_value(state[name].clone())
                .map_err(|error| Error::argument(name, format!("a list of numbers: {error}")))
        };
        Simulated::set_state(self, &numbers("qpos")?, &numbers("qvel")?)
    }

    fn arguments(&self) -> Json {
        serde_json::to_value(&self.arguments.1).unwrap_or_default()
    }
}

impl<T: Task> MujocoEnv<T> {
    /// Improves the error of a snapshot that this environment refuses. If the snapshot is of
    /// another version of MuJoCo, the message names that version.
    fn explain_refusal(&self, snapshot: &Snapshot, error: Error) -> Error {
        /// The part of a snapshot that this function reads.
        #[derive(Deserialize)]
        struct Taken {
            env: String,
            config: (u32, With),
        }
        #[derive(Deserialize)]
        struct With {
            mujoco: Revision,
        }
        let (env, own) = (self.describe(), self.arguments.1.as_ref().mujoco.0);
        match snapshot.get::<Taken>() {
            Ok(taken) if taken.env == env && taken.config.1.mujoco != own => {
                let other = taken.config.1.mujoco;
                Error::Snapshot(format!(
                    "it was taken from a {env} of MuJoCo {other}, and this one is of MuJoCo {own}: restore it into an \
                     environment made with mujoco=\"{other}\""
                ))
            }
            _ => error,
        }
    }
}

impl<T: Task> Env for MujocoEnv<T> {
    type Observation = Array;
    type Action = Array;

    fn observation_space(&self) -> Space {
        self.observation_space.clone()
    }

    fn action_space(&self) -> Space {
        self.action_space.clone()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Array) -> Result<()> {
        let rng = reset.generator(self.episode.as_ref().map(|episode| &episode.rng))?;
        self.resumed.take();
        let mut episode = match self.episode.take() {
            Some(mut episode) => {
                (episode.rng, episode.step) = (rng, None);
                episode
            }
            None => Box::new(Episode {
                rng,
                step: None,
                data: Data::new(&self.simulation.model),
            }),
        };
        episode.data.reset(&self.simulation.model);
        self.task
            .start(&self.simulation, &mut episode.data, &mut episode.rng);
        self.simulation.start(&mut episode.data);
        self.episode = Some(episode);
        self.observe(observation)
    }

    fn step_into(&mut self, action: &Array, observation: &mut Array) -> Result<Outcome> {
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("step"));
        };
        if action.shape() != [self.simulation.model.nu()] || !action.is_finite() {
            return Err(self.action_space.refuse_action(action));
        }
        self.resumed.take();
        let (step, reward, terminated) =
            self.task.step(&self.simulation, &mut episode.data, action);
        episode.step = Some(step);
        self.observe(observation)?;
        Ok(Outcome {
            reward,
            terminated,
            truncated: false,
        })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::with_config(&self.describe(), &self.arguments, &self.episode)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let model = &self.simulation.model;
        let valid = |episode: &Episode<T::Step>| episode.data.check(model).is_ok();
        let found = snapshot.for_config(&self.describe(), &self.arguments, valid);
        let mut episode = found.map_err(|error| self.explain_refusal(snapshot, error))?;
        if let Some(episode) = &mut episode {
            episode.data.resume(model);
        }
        self.episode = episode.map(Box::new);
        self.resumed.take();
        Ok(())
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        let Some(episode) = &self.episode else { return };
        let Episode { data, step, .. } = &**episode;
        let tendons_follow = self.task.tendons_follow();
        let there = self.simulation.has(Derived::TenVelocity);
        self.task
            .info(&self.simulation, data, step.as_ref(), &mut |name, x| {
                visit(name, Value::Float(x));
                if tendons_follow == Some(name)
                    && let Some(data) = if there { Some(data) } else { self.data() }
                {
                    let array = |numbers: &[f64]| Value::Array(numbers.to_vec().into());
                    visit("tendon_length", array(&data.ten_length));
                    visit("tendon_velocity", array(&data.ten_velocity));
                }
            });
    }

    fn metadata(&self) -> Metadata {
        let common = self.arguments.1.as_ref();
        Metadata::drawn_and_depth(self.simulation.fps(), (common.width, common.height))
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        let (Some(data), simulation) = (self.data(), &self.simulation) else {
            return;
        };
        let common = self.arguments.1.as_ref();
        let (view, size) = (&simulation.view, (common.width, common.height));
        view.draw(&simulation.model, data, size, canvas);
    }

    fn depth(&self, size: (u32, u32)) -> Option<Vec<f32>> {
        let data = self.data()?;
        let Simulation { model, view, .. } = &self.simulation;
        let common = self.arguments.1.as_ref();
        Some(view.depth_of(model, data, (common.width, common.height), size))
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.episode.as_mut().map(|episode| &mut episode.rng)
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

impl<T: Task> Lockstep for MujocoEnv<T> {
    type Group = Worlds;

    fn begin_reset(&mut self, _: &Reset, _: &mut Worlds) {
        self.place = None;
    }

    fn begin_step(&mut self, action: &Array, worlds: &mut Worlds) {
        let fits = action.shape() == [self.simulation.model.nu()] && action.is_finite();
        let episode = self.episode.as_ref().filter(|_| fits);
        self.place = episode.and_then(|episode| {
            let Simulation { model, stride, .. } = &self.simulation;
            worlds.begin(model, stride.as_ref()?, &episode.data, action)
        });
    }

    fn collect(&mut self, worlds: &mut Worlds) {
        if let (Some(place), Some(episode)) = (self.place.take(), &mut self.episode) {
            worlds.collect(place, &mut episode.data);
        }
    }
}

impl<T: Task> Configure for MujocoEnv<T> {
    type Config = T::Config;

    fn configure(config: T::Config, version: u32) -> Result<Self> {
        Self::with_version(config, version)
    }

    fn defaults(version: u32) -> T::Config {
        T::Config::defaults(version)
    }
}
