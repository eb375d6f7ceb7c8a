//! The Adroit hand: a Shadow hand on an arm, with a task in each module.
//!
//! Their models are written anew, without the meshes of the hand, which are only for show: pictures
//! show the shapes that touch. Sensors that no observation reads are left out too.

pub mod door;
pub mod hammer;
mod hand;
pub mod pen;
pub mod relocate;

use std::fmt::Debug;
use std::marker::PhantomData;
use std::sync::Arc;

use gym_core::registry::{Build, Clip};
use gym_core::spaces::BoxSpace;
use gym_core::{Array, Error, Kwargs, Registration, Result};
use gym_sim::numpy::norm_avx2;
use gym_sim::view::CameraConfig;
use gym_sim::{
    Common, Measured, Measures, Naming, Observation, Rng, Settings, SimEnv, SimTask, Simulation,
    Start, Stepper, register,
};
use mujoco_engine::math::MAXVAL;
use mujoco_engine::{CompiledModel, Data, Model};
use serde_json::Value as Json;

use crate::RewardType;
use hand::ArmJoint;

/// Timesteps of a step.
const FRAME_SKIP: usize = 5;

/// The reward of a step at the goal, and of others, if rewards are sparse.
const SPARSE: [f64; 2] = [10.0, -0.1];

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The reward: `"dense"`, or `"sparse"`, which is 10 at the goal and -0.1 elsewhere.
        pub reward_type: RewardType = RewardType::Dense,
        /// The arguments that all tasks share.
        #[flatten(
            xml_file = 0, keyframe = 0, frame_skip = 0, default_camera_config = 0, width = 1.., height = 1.., camera_id = 1..,
            camera_name = 1.., max_geom = 1.., visual_options = 1..
        )]
        pub common: Common,
    }
}

/// What the hand has to do.
pub(crate) trait Skill: Debug + Send + Sync + Sized + 'static {
    /// The name of the environment.
    const NAME: &'static str;
    /// The joints of the arm.
    const ARM: &'static [ArmJoint];
    /// The turn of the forearm about the vertical, in rad.
    const TURNED: &'static str = "3.14";
    /// The sections of the model that only this task has, in MJCF.
    const MODEL: &'static str;
    /// The distance of the camera in m, and its direction in degrees.
    const CAMERA: [f64; 2];
    /// Constants of the model that a reset draws, or takes from the option `initial_state_dict`,
    /// with their numbers of numbers.
    const CONSTANTS: &'static [(&'static str, usize)];

    /// Looks up the parts of the model.
    fn new(simulation: &Simulation) -> Result<Self>;

    /// The constants that the model has.
    fn constants(&self, m: &Model, constants: &mut Vec<f64>);

    /// Draws constants; those that it leaves stay.
    fn draw(&self, constants: &mut [f64], rng: &mut Rng);

    /// Says what is wrong with constants, such as a quaternion of another length than 1.
    fn fault(&self, constants: &[f64]) -> Option<&'static str> {
        let _ = constants;
        None
    }

    /// Writes constants to the model.
    fn apply(&self, constants: &[f64], m: &mut CompiledModel);

    /// The number of numbers that [`remember`](Self::remember) writes.
    const REMEMBERS: usize = 0;

    /// Writes what is measured at the start of an episode to `userdata`.
    fn remember(&self, d: &mut Data) {
        let _ = d;
    }

    /// Adds the observation.
    fn observe(&self, m: &Model, d: &Data, out: &mut Observation);

    /// Adds the names of the observation's numbers.
    fn names(&self, names: &mut Naming<'_>);

    /// The dense reward, and whether the goal is reached.
    fn judge(&self, d: &Data) -> (f64, bool);
}

/// The constructor of the environments of a task.
#[derive(Debug)]
pub(crate) struct Entry<S>(PhantomData<fn() -> S>);

impl<S: Skill> Build for Entry<S> {
    type Config = Config;
    type Env = SimEnv;

    fn build(config: Config, version: u32) -> Result<SimEnv> {
        let [distance, azimuth] = S::CAMERA;
        let common = Common {
            xml_file: hand::model(S::ARM, S::TURNED, S::MODEL),
            frame_skip: FRAME_SKIP,
            default_camera_config: CameraConfig::at([0.0, -0.15, 0.15], distance, azimuth, -30.0),
            ..config.common.clone()
        };
        let load = || gym_sim::compile(&common.xml_file, common.mujoco.0);
        let stepper = Stepper::Behind {
            contact_forces: true,
        };
        let simulation = Simulation::new(load, &common, stepper)?;
        let ranges = simulation.model.actuator_ctrlrange.iter();
        let task = HandTask {
            controls: ranges
                .map(|[low, high]| [(low + high) / 2.0, 0.5 * (high - low)])
                .collect(),
            dense: config.reward_type == RewardType::Dense,
            sizes: [simulation.model.nq(), simulation.model.nv()],
            skill: S::new(&simulation)?,
        };
        let mut settings = Settings::new(S::NAME, &config);
        settings.version = Some(version);
        settings.size = (common.width, common.height);
        let controls = simulation.model.nu();
        settings.action_space =
            Some(BoxSpace::new(vec![-1.0_f32; controls], vec![1.0; controls])?.into());
        SimEnv::new(Arc::new(task), simulation, settings)
    }
}

/// The task of a skill.
#[derive(Debug)]
struct HandTask<S> {
    skill: S,
    dense: bool,
    /// The middle and half the width of the range of each control.
    controls: Vec<[f64; 2]>,
    /// The numbers of positions and of velocities.
    sizes: [usize; 2],
}

/// The option `initial_state_dict`: positions, velocities and constants.
struct State {
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    constants: Vec<f64>,
}

impl<S: Skill> HandTask<S> {
    /// The names of the entries of a state, each with its number of numbers.
    fn entries(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let [nq, nv] = self.sizes;
        let constants = S::CONSTANTS.iter().copied();
        [("qpos", nq), ("qvel", nv)].into_iter().chain(constants)
    }

    /// The state that an option of a reset gives.
    fn state(&self, options: &Kwargs) -> Result<Option<State>> {
        let Some(given) = options
            .get("initial_state_dict")
            .filter(|given| !given.is_null())
        else {
            return Ok(None);
        };
        let wrong = |what: &str| {
            let entries = self
                .entries()
                .map(|(name, n)| format!("`{name}` ({n} numbers)"));
            let entries = entries.collect::<Vec<_>>().join(", ");
            Error::argument("initial_state_dict", format!("{what}: give {entries}"))
        };
        let dict = given.as_object().ok_or_else(|| wrong("it is no dict"))?;
        if let Some(name) = dict
            .keys()
            .find(|name| self.entries().all(|(known, _)| known != *name))
        {
            return Err(wrong(&format!(
                "unknown entry `{}`",
                gym_core::printable(name)
            )));
        }
        let read = |name: &str, length: usize| -> Result<Vec<f64>> {
            let numbers = dict.get(name).and_then(Json::as_array);
            let numbers = numbers.filter(|numbers| numbers.len() == length);
            let numbers = numbers.map(|numbers| numbers.iter().filter_map(Json::as_f64));
            let numbers: Vec<f64> = numbers
                .into_iter()
                .flatten()
                .filter(|x| x.abs() <= MAXVAL)
                .collect();
            if numbers.len() == length {
                return Ok(numbers);
            }
            Err(wrong(&format!(
                "`{name}` is not {length} numbers within ±{MAXVAL:e}"
            )))
        };
        let [nq, nv] = self.sizes;
        let (qpos, qvel) = (read("qpos", nq)?, read("qvel", nv)?);
        let mut constants = Vec::new();
        for (name, length) in S::CONSTANTS {
            constants.extend(read(name, *length)?);
        }
        if let Some(fault) = self.skill.fault(&constants) {
            return Err(wrong(fault));
        }
        Ok(Some(State {
            qpos,
            qvel,
            constants,
        }))
    }
}

impl<S: Skill> SimTask for HandTask<S> {
    fn check_options(&self, options: &Kwargs) -> Result<()> {
        self.state(options).map(|_| ())
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let mut constants = std::mem::take(start.constants);
        constants.clear();
        self.skill.constants(start.model(), &mut constants);
        self.skill.draw(&mut constants, start.rng);
        *start.constants = constants;
        start.change(|constants, model| self.apply(constants, model))?;
        start.settle();
        self.skill.remember(start.data);
        if let Some(state) = self.state(start.options)? {
            start.data.qpos.copy_from_slice(&state.qpos);
            start.data.qvel.copy_from_slice(&state.qvel);
            *start.constants = state.constants;
            start.change(|constants, model| self.apply(constants, model))?;
        }
        Ok(())
    }

    fn step(&self, simulation: &Simulation, d: &mut Data, action: &Array) -> Measured {
        let controls = action.iter_f64().zip(&self.controls);
        simulation.drive(
            d,
            controls.map(|(a, [middle, half])| middle + a.clamp(-1.0, 1.0) * half),
        );
        let (dense, success) = self.skill.judge(d);
        let sparse = SPARSE[usize::from(!success)];
        let reward = if self.dense { dense } else { sparse };
        Measured::new(reward, false).with([f64::from(success)])
    }

    fn observe(&self, m: &Model, d: &Data, out: &mut Observation) {
        self.skill.observe(m, d, out);
    }

    fn names(&self, names: &mut Naming<'_>) {
        self.skill.names(names);
        for actuator in 0..self.controls.len() {
            let of = names.actuator(actuator);
            names.action(format!("target of {of} as a share of its range"));
        }
    }

    fn measures(&self) -> Measures {
        &[("success", 1)]
    }

    fn success(&self, _: &Data, measured: Option<&Measured>) -> Option<bool> {
        measured.map(|measured| measured.numbers() == [1.0])
    }

    fn remembers(&self) -> usize {
        S::REMEMBERS
    }

    fn apply(&self, constants: &[f64], model: &mut CompiledModel) {
        self.skill.apply(constants, model);
    }

    fn has(&self, constants: &[f64]) -> bool {
        let length: usize = S::CONSTANTS.iter().map(|(_, length)| length).sum();
        constants.len() == length
            && constants.iter().all(|x| x.abs() <= MAXVAL)
            && self.skill.fault(constants).is_none()
    }
}

/// The difference of two places.
fn minus<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// The distance of two places.
fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm_avx2(&minus(a, b))
}

/// The registration that all tasks share.
const fn hand<S: Skill>(
    id: &'static str,
    kwargs: &'static str,
    description: &'static str,
) -> Registration {
    register::<Entry<S>>(id)
        .description(description)
        .kwargs(kwargs)
        .max_episode_steps(200)
        .clip(Clip {
            seeds: 0..2,
            every: 4,
            frames: 50,
            size: (240, 240),
        })
}

/// A list of zeros in JSON.
macro_rules! zeros {
    (30) => {
        "[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0]"
    };
    (33) => {
        "[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0]"
    };
    (36) => {
        "[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0]"
    };
}
pub(crate) use zeros;

/// Registers the two ids of a task.
macro_rules! ids {
    ($skill:ty, $name:literal, $description:literal, $state:expr) => {
        gym_core::register!(
            $crate::adroit::hand::<$skill>(
                concat!($name, "-v1"),
                "{\"reward_type\":\"dense\"}",
                $description
            )
            .reset_options(&[("initial_state_dict", $state)]),
            $crate::adroit::hand::<$skill>(
                concat!($name, "Sparse-v1"),
                "{\"reward_type\":\"sparse\"}",
                $description
            )
            .reset_options(&[("initial_state_dict", $state)]),
        );
    };
}
pub(crate) use ids;
