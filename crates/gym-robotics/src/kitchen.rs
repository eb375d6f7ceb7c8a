//! FrankaKitchen: open, turn and move things in a kitchen with a Franka arm.
//!
//! | | |
//! |---|---|
//! | observation | `observation`: positions and velocities of the robot's joints and of the things, in m, rad and seconds, with noise (59 numbers); `achieved_goal`: the positions of each thing that `tasks_to_complete` names; `desired_goal`: its positions at the goal |
//! | action | velocities of the joints, as shares of 2 rad/s, and of the fingers, as shares of 2 m/s; `Box(-1, 1, (9,), float64)` |
//! | reward | the number of tasks whose positions are within 0.3 of the goal, and that are still to be completed |
//! | start | the arm over the oven |
//! | end | terminated when each task was completed once, unless `terminate_on_tasks_completed` is false |
//! | limit | 280 steps of 0.08 s |
//!
//! `info` has lists of tasks: `tasks_to_complete`, `step_task_completions` and
//! `episode_task_completions`, in the order of their names.
//!
//! Models and meshes are those of the Python package, which the user has installed: see
//! [`assets`].
//!
//! Differences from Gymnasium-Robotics: all numbers are Gymnasium-Robotics' with the version of
//! MuJoCo that `mujoco` names, for Linux on x86-64. The reward of other goals, which in the package depends
//! on the tasks that the episode has completed, is not computed. The package's lists of tasks have
//! no order.
//!
//! Source: Gymnasium-Robotics 1.4.2, `envs/franka_kitchen/kitchen_env.py`, `franka_env.py`, and
//! `assets/kitchen_franka/franka_assets/franka_config.xml`.

use std::path::PathBuf;
use std::sync::Arc;

use gym_core::registry::{Build, Clip};
use gym_core::spaces::BoxSpace;
use gym_core::{Array, Error, Registration, Result, Value};
use gym_sim::numpy::norm_avx2;
use gym_sim::view::CameraConfig;
use gym_sim::{
    Common, Measured, Naming, Observation, Rng, Settings, SimEnv, SimTask, Simulation, Start,
    Stepper,
};
use mujoco_engine::{Data, Model};

use crate::assets;

/// Timesteps of a step.
const FRAME_SKIP: usize = 40;

/// The number of the robot's joints.
const JOINTS: usize = 9;

/// The numbers of positions, of velocities, and of an observation.
const POSITIONS: usize = 30;
const VELOCITIES: usize = 29;
const OBSERVED: usize = POSITIONS + VELOCITIES;

/// The distance from the goal at which a task is completed.
const NEAR: f64 = 0.3;

/// The largest velocity, in rad/s or m/s.
const FASTEST: f64 = 2.0;

/// The positions at the start.
const START: [f64; POSITIONS] = [
    1.48388023e-01,
    -1.76848573e00,
    1.84390296e00,
    -2.47685760e00,
    2.60252026e-01,
    7.12533105e-01,
    1.59515394e00,
    4.79267505e-02,
    3.71350919e-02,
    -2.66279850e-04,
    -5.18043486e-05,
    3.12877220e-05,
    -4.51199853e-05,
    -3.90842156e-06,
    -4.22629655e-05,
    6.28065475e-05,
    4.04984708e-05,
    4.62730939e-04,
    -2.26906415e-04,
    -4.65501369e-04,
    -6.44129196e-03,
    -1.77048263e-03,
    1.08009684e-03,
    -2.69397440e-01,
    3.50383255e-01,
    1.61944683e00,
    1.00618764e00,
    4.06395120e-03,
    -6.62095997e-03,
    -2.68278933e-04,
];

/// The limits of the robot's positions, in rad and m.
const LIMITS: [[f64; 2]; JOINTS] = [
    [-2.9, 2.9],
    [-1.8, 1.8],
    [-2.9, 2.9],
    [-3.1, 0.0],
    [-2.9, 2.9],
    [0.0, 3.8],
    [-2.9, 2.9],
    [0.0, 0.04],
    [0.0, 0.04],
];

/// The noise of positions and of velocities, by the number of the velocity.
const NOISE: [[f64; 2]; VELOCITIES] = {
    let mut noise = [[0.1; 2]; VELOCITIES];
    let mut i = JOINTS;
    while i < VELOCITIES {
        noise[i] = match i {
            11..=16 => [0.0005, 0.005],
            20..=22 | 26.. => [0.1, 0.1],
            _ => [0.005, 0.005],
        };
        i += 1;
    }
    noise
};

/// Something to do: its name, the names of its goals in an observation, the positions of the thing,
/// and those at the goal.
struct Chore {
    name: &'static str,
    goals: [&'static str; 2],
    first: usize,
    goal: &'static [f64],
}

macro_rules! chores {
    ($($name:literal: $first:literal, $goal:expr;)+) => {
        &[$(Chore {
            name: $name,
            goals: [concat!("achieved_goal/", $name), concat!("desired_goal/", $name)],
            first: $first,
            goal: &$goal,
        },)+]
    };
}
const CHORES: &[Chore] = chores! {
    "bottom burner": 11, [-0.88, -0.01];
    "hinge cabinet": 20, [0.0, 1.45];
    "kettle": 23, [-0.23, 0.75, 1.62, 0.99, 0.0, 0.0, -0.06];
    "light switch": 17, [-0.69, -0.05];
    "microwave": 22, [-0.75];
    "slide cabinet": 19, [0.37];
    "top burner": 15, [-0.92, -0.01];
};

impl Chore {
    fn achieved<'a>(&self, d: &'a Data) -> &'a [f64] {
        &d.qpos[self.first..self.first + self.goal.len()]
    }

    fn is_done(&self, d: &Data) -> bool {
        let mut way = [0.0; 7];
        let both = self.achieved(d).iter().zip(self.goal);
        for (way, (a, b)) in way.iter_mut().zip(both) {
            *way = a - b;
        }
        norm_avx2(&way[..self.goal.len()]) < NEAR
    }
}

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// What to do: some of `"bottom burner"`, `"top burner"`, `"light switch"`, `"slide cabinet"`,
        /// `"hinge cabinet"`, `"microwave"` and `"kettle"`.
        pub tasks_to_complete: Vec<String> = CHORES.iter().map(|chore| chore.name.to_owned()).collect(),
        /// Whether the episode ends when each task was completed.
        pub terminate_on_tasks_completed: bool = true,
        /// Whether a task is rewarded once, instead of in each step.
        pub remove_task_when_completed: bool = true,
        /// The noise of the things' positions and velocities, as a share of its largest size.
        pub object_noise_ratio: f64 = 0.0005,
        /// The noise of the robot's positions and velocities, likewise.
        pub robot_noise_ratio: f64 = 0.01,
        /// The folder of models; `None` for `GYMNASIUM_ROBOTICS_ASSETS` or an installed
        /// gymnasium-robotics.
        pub assets: Option<PathBuf>,
        /// The arguments that all tasks share.
        #[flatten(
            xml_file = 0, keyframe = 0, frame_skip = 0, default_camera_config = 1.., width = 1.., height = 1.., camera_id = 1..,
            camera_name = 1.., max_geom = 1.., visual_options = 1..
        )]
        pub common: Common,
    }
}

/// The constructor of the environment.
#[derive(Clone, Copy, Debug)]
pub struct FrankaKitchen;

impl Build for FrankaKitchen {
    type Config = Config;
    type Env = SimEnv;

    fn defaults(_version: u32) -> Config {
        let mut config = Config::default();
        config.common.default_camera_config = CameraConfig::at([-0.2, 0.5, 2.0], 2.2, 70.0, -35.0);
        config
    }

    fn build(mut config: Config, version: u32) -> Result<SimEnv> {
        let folder = config.assets.take();
        let common = Common {
            frame_skip: FRAME_SKIP,
            ..config.common.clone()
        };
        let model = "kitchen_franka/kitchen_assets/kitchen_env_model.xml";
        let load = || {
            let folder = folder.as_deref();
            assets::load(&assets::KITCHEN, model, folder, common.mujoco.0).map(Arc::new)
        };
        let stepper = Stepper::Behind {
            contact_forces: true,
        };
        let simulation = Simulation::new(load, &common, stepper)?;
        let task = Task::new(&config, &simulation)?;
        let mut settings = Settings::new("KitchenEnv", &config);
        settings.version = Some(version);
        settings.size = (common.width, common.height);
        settings.flat = false;
        settings.action_space =
            Some(BoxSpace::new(vec![-1.0_f64; JOINTS], vec![1.0; JOINTS])?.into());
        SimEnv::new(Arc::new(task), simulation, settings)
    }
}

/// The task. `userdata` has the observation with noise, and for each chore whether it is still to be
/// done, whether the last step did it, and whether the episode did it.
#[derive(Debug)]
struct Task {
    chores: Vec<&'static Chore>,
    ends: bool,
    removes: bool,
    /// The noise of robot and things, as shares of the largest.
    ratios: [f64; 2],
    dt: f64,
}

impl std::fmt::Debug for Chore {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

impl Task {
    fn new(config: &Config, simulation: &Simulation) -> Result<Self> {
        let m = &simulation.model;
        for (what, found, expected) in [
            ("positions", m.nq(), POSITIONS),
            ("velocities", m.nv(), VELOCITIES),
            ("controls", m.nu(), JOINTS),
        ] {
            if found != expected {
                let reason = format!("the kitchen has {found} {what}, not {expected}");
                return Err(Error::argument("assets", reason));
            }
        }
        for name in &config.tasks_to_complete {
            if CHORES.iter().all(|chore| chore.name != name) {
                let known: Vec<_> = CHORES.iter().map(|chore| chore.name).collect();
                let reason = format!(
                    "there is no task {:?}: the tasks are {}",
                    gym_core::printable(name).to_string(),
                    known.join(", ")
                );
                return Err(Error::argument("tasks_to_complete", reason));
            }
        }
        let asked = |chore: &&Chore| {
            config
                .tasks_to_complete
                .iter()
                .any(|name| name == chore.name)
        };
        if config.tasks_to_complete.is_empty() {
            let reason = "it is empty: give at least one task";
            return Err(Error::argument("tasks_to_complete", reason));
        }
        for (name, ratio) in [
            ("object_noise_ratio", config.object_noise_ratio),
            ("robot_noise_ratio", config.robot_noise_ratio),
        ] {
            if ratio.is_nan() || ratio.abs() > 1e6 {
                return Err(Error::argument(name, format!("{ratio} is not within ±1e6")));
            }
        }
        Ok(Self {
            chores: CHORES.iter().filter(asked).collect(),
            ends: config.terminate_on_tasks_completed,
            removes: config.remove_task_when_completed,
            ratios: [config.robot_noise_ratio, config.object_noise_ratio],
            dt: simulation.dt,
        })
    }

    /// Whether each chore is still to be done, was done by the last step, and was done in the
    /// episode.
    fn progress<'a>(&self, d: &'a Data) -> [&'a [f64]; 3] {
        let count = self.chores.len();
        let all = &d.userdata[OBSERVED..];
        [0, 1, 2].map(|k| &all[k * count..(k + 1) * count])
    }
}

impl SimTask for Task {
    fn remembers(&self) -> usize {
        OBSERVED + 3 * self.chores.len()
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let (_, d, _) = start.parts();
        d.qpos.copy_from_slice(&START);
        let count = self.chores.len();
        d.userdata.fill(0.0);
        d.userdata[OBSERVED..OBSERVED + count].fill(1.0);
        Ok(())
    }

    fn step(&self, simulation: &Simulation, d: &mut Data, action: &Array) -> Measured {
        let mut controls = [0.0; JOINTS];
        for (i, (control, a)) in controls.iter_mut().zip(action.iter_f64()).enumerate() {
            let velocity = 0.0 + a.clamp(-1.0, 1.0) * FASTEST;
            let [low, high] = LIMITS[i];
            *control = (d.userdata[i] + velocity * self.dt).clamp(low, high);
        }
        simulation.drive(d, controls.into_iter());
        let (count, mut reward) = (self.chores.len(), 0.0);
        for (i, chore) in self.chores.iter().enumerate() {
            let [open, step, episode] = [0, 1, 2].map(|k| OBSERVED + k * count + i);
            let done = d.userdata[open] > 0.0 && chore.is_done(d);
            d.userdata[step] = f64::from(done);
            if done {
                reward += 1.0;
                d.userdata[episode] = 1.0;
                if self.removes {
                    d.userdata[open] = 0.0;
                }
            }
        }
        let [_, _, episode] = self.progress(d);
        let terminated = self.ends && episode.iter().all(|done| *done > 0.0);
        Measured::new(reward, terminated)
    }

    /// Adds noise to positions and velocities: of the robot, and then of the things.
    fn sense(&self, d: &mut Data, rng: &mut Rng) {
        let Data {
            qpos,
            qvel,
            userdata,
            ..
        } = d;
        let [robot, things] = self.ratios;
        let mut seen = userdata.iter_mut();
        let mut add = |numbers: &[f64], ratio: f64, noise: &[[f64; 2]], kind: usize| {
            for ((x, noise), to) in numbers.iter().zip(noise).zip(seen.by_ref()) {
                *to = x + ratio * noise[kind] * rng.uniform(-1.0, 1.0);
            }
        };
        add(&qpos[..JOINTS], robot, &NOISE, 0);
        add(&qvel[..JOINTS], robot, &NOISE, 1);
        // a free joint has more positions than velocities
        add(&qpos[JOINTS..], things, &NOISE[JOINTS - 1..], 0);
        add(&qvel[JOINTS..], things, &NOISE[JOINTS..], 1);
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        for chore in &self.chores {
            let [achieved, desired] = chore.goals;
            out.vector(achieved, chore.achieved(d).iter().copied());
            out.vector(desired, chore.goal.iter().copied());
        }
        out.extend(d.userdata[..OBSERVED].iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        for chore in &self.chores {
            let [achieved, desired] = chore.goals;
            let numbers = chore.first..chore.first + chore.goal.len();
            names.part(achieved).positions(numbers.clone());
            names.part(desired);
            for i in numbers {
                names.add(format!("goal of the {}", names.position(i)));
            }
        }
        names.part("observation").positions(..).velocities(..);
        for joint in 0..JOINTS {
            names.action(names.velocity(joint).replace('(', "(2 "));
        }
    }

    fn lists(&self, d: &Data, _: Option<&Measured>, visit: &mut dyn FnMut(&str, Value)) {
        let names = [
            "tasks_to_complete",
            "step_task_completions",
            "episode_task_completions",
        ];
        for (name, is_in) in names.into_iter().zip(self.progress(d)) {
            let tasks = self.chores.iter().zip(is_in).filter(|(_, is)| **is > 0.0);
            let tasks = tasks.map(|(chore, _)| Value::Text(chore.name.to_owned()));
            visit(name, Value::Tuple(tasks.collect()));
        }
    }
}

/// What conformance cannot see of the kitchen.
const UNREACHED: &str = "it matters when a task is completed, which random actions do not reach";

gym_core::register!(
    Registration::new::<FrankaKitchen>("FrankaKitchen-v1")
        .names(gym_sim::names)
        .description("Open, turn and move things in a kitchen with an arm.")
        .max_episode_steps(280)
        .needs(assets::NEED, assets::available)
        .exceptions(&[
            (
                "no-allocation",
                "buffers of contacts grow in the first steps",
            ),
            ("arguments-matter.terminate_on_tasks_completed", UNREACHED,),
            ("arguments-matter.remove_task_when_completed", UNREACHED),
        ])
        .clip(Clip {
            seeds: 0..2,
            every: 4,
            frames: 60,
            size: (240, 240),
        })
);
