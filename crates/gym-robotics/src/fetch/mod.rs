//! Fetch: reach, push, slide or carry an object to a goal, with an arm of seven joints and a gripper.
//!
//! | | |
//! |---|---|
//! | observation | `observation`: place of the gripper, in m; of tasks with an object its place, its place relative to the gripper, in m; positions of the fingers, in m; the object's Euler angles in rad, velocity relative to the gripper and angular velocity, per step; velocities of gripper and fingers, in m per step (25 numbers; FetchReach: 10). `achieved_goal`: the place of the object, FetchReach: of the gripper; `desired_goal`: the goal's place, in m |
//! | action | motion of the gripper along x, y and z, as shares of 0.05 m, and of its fingers, which only FetchPickAndPlace uses; `Box(-1, 1, (4,), float32)` |
//! | reward | 0 within 0.05 m of the goal, else -1; ids with `Dense`: minus the distance to the goal in m |
//! | start | the gripper above the table, the object within 0.15 m of it along x and y (FetchSlide: 0.1 m), but not within 0.1 m; the goal within 0.15 m (FetchSlide: within 0.3 m of a place 0.4 m ahead), on the table, and in half of the episodes of FetchPickAndPlace up to 0.45 m above it |
//! | end | never |
//! | limit | 50 steps of 0.04 s |
//!
//! `info` has `is_success` after a step: 1 within 0.05 m of the goal, else 0.
//!
//! Models and meshes are those of the Python package, which the user has installed: see
//! [`assets`].
//!
//! Differences from Gymnasium-Robotics: all numbers are Gymnasium-Robotics' with the version of
//! MuJoCo that `mujoco` names, for Linux on x86-64, and with numpy on a CPU without AVX-512 in OpenBLAS;
//! with it, velocities differ in the last bit. A picture changes nothing, where the package computes
//! the state anew, so that the step after it starts from other places.
//!
//! Source: Gymnasium-Robotics 1.4.2, `envs/fetch/fetch_env.py`, `reach.py`, `push.py`, `slide.py`,
//! `pick_and_place.py`, and `envs/robot_env.py`.

mod policy;
mod velocity;

use std::path::PathBuf;
use std::sync::Arc;

use gym_core::keys::{Keys, json};
use gym_core::registry::{Build, Clip};
use gym_core::spaces::BoxSpace;
use gym_core::{Array, Error, Goals, Policy, Registration, Result};
use gym_sim::numpy::norm_avx2;
use gym_sim::view::CameraConfig;
use gym_sim::{
    Common, Measured, Naming, Observation, Rng, Settings, SimEnv, SimTask, Simulation, Start,
    Stepper, Visit,
};
use mujoco_engine::math::sub;
use mujoco_engine::model::{BiasType, EqualityType};
use mujoco_engine::physics::substep;
use mujoco_engine::{CompiledModel, Data, Model, forward, step};
use serde::{Deserialize, Serialize};

use crate::RewardType;
use crate::assets;
use crate::goals::Near;
use crate::rotation::mat_to_euler;
use velocity::Moving;

/// Timesteps of a step.
const FRAME_SKIP: usize = 20;

/// What the arm has to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Skill {
    /// Move the gripper to the goal.
    #[default]
    Reach,
    /// Push a box to the goal.
    Push,
    /// Hit a puck so that it slides to the goal.
    Slide,
    /// Carry a box to the goal.
    PickAndPlace,
}

impl gym_core::ArgumentType for Skill {
    fn kind() -> String {
        "\"reach\", \"push\", \"slide\" or \"pick_and_place\"".to_owned()
    }
}

/// The figures of a task: lengths in m.
struct Figures {
    model: &'static str,
    /// Where the arm's base stands along x.
    base: f64,
    /// How much higher the gripper starts than near the table.
    height: f64,
    /// The object's pose at first.
    object: Option<[f64; 7]>,
    /// How far from the gripper the object starts.
    object_range: f64,
    /// How far the goal is from the gripper, or from a place ahead of it.
    target_range: f64,
    ahead: f64,
}

impl Skill {
    fn name(self) -> &'static str {
        match self {
            Self::Reach => "MujocoFetchReachEnv",
            Self::Push => "MujocoFetchPushEnv",
            Self::Slide => "MujocoFetchSlideEnv",
            Self::PickAndPlace => "MujocoFetchPickAndPlaceEnv",
        }
    }

    fn figures(self) -> Figures {
        let box_on_table = [1.25, 0.53, 0.4, 1.0, 0.0, 0.0, 0.0];
        let push = Figures {
            model: "fetch/push.xml",
            base: 0.405,
            height: 0.0,
            object: Some(box_on_table),
            object_range: 0.15,
            target_range: 0.15,
            ahead: 0.0,
        };
        match self {
            Self::Push => push,
            Self::Reach => Figures {
                model: "fetch/reach.xml",
                base: 0.4049,
                height: 0.2,
                object: None,
                ..push
            },
            Self::Slide => Figures {
                model: "fetch/slide.xml",
                base: 0.05,
                height: -0.02,
                object: Some([1.7, 1.1, 0.41, 1.0, 0.0, 0.0, 0.0]),
                object_range: 0.1,
                target_range: 0.3,
                ahead: 0.4,
            },
            Self::PickAndPlace => Figures {
                model: "fetch/pick_and_place.xml",
                height: 0.2,
                ..push
            },
        }
    }

    /// Whether the fingers stay closed.
    fn blocks_gripper(self) -> bool {
        self != Self::PickAndPlace
    }
}

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The task; each id has its own.
        pub skill: Skill,
        /// The reward: `"sparse"`, which is 0 within 0.05 m of the goal and -1 elsewhere, or
        /// `"dense"`, minus the distance in m.
        pub reward_type: RewardType,
        /// The folder of models; `None` for `GYMNASIUM_ROBOTICS_ASSETS` or an installed
        /// gymnasium-robotics.
        pub assets: Option<PathBuf>,
        /// The arguments that all tasks share.
        #[flatten(
            xml_file = 0, keyframe = 0, frame_skip = 0, default_camera_config = 1.., width = 1.., height = 1.., camera_id = 0,
            camera_name = 0, max_geom = 0, visual_options = 0
        )]
        pub common: Common,
    }
}

/// The constructor of the environments.
#[derive(Clone, Copy, Debug)]
pub struct Fetch;

impl Build for Fetch {
    type Config = Config;
    type Env = SimEnv;

    fn defaults(_version: u32) -> Config {
        let mut config = Config::default();
        config.common.default_camera_config =
            CameraConfig::at([1.3, 0.75, 0.55], 2.5, 132.0, -14.0);
        config
    }

    fn build(config: Config, version: u32) -> Result<SimEnv> {
        let figures = config.skill.figures();
        let common = Common {
            frame_skip: FRAME_SKIP,
            ..config.common.clone()
        };
        let load = || {
            let folder = config.assets.as_deref();
            let model = assets::load(&assets::FETCH, figures.model, folder, common.mujoco.0)?;
            with_free_welds(&model).map(Arc::new)
        };
        let stepper = Stepper::Behind {
            contact_forces: false,
        };
        let simulation = Simulation::new(load, &common, stepper)?;
        let task = Task::new(&config, &figures, &simulation)?;
        // another computer has the models elsewhere
        let arguments = Config {
            assets: None,
            ..config.clone()
        };
        let mut settings = Settings::new(config.skill.name(), &arguments);
        settings.version = Some(version);
        settings.size = (common.width, common.height);
        settings.flat = false;
        settings.depth = false;
        settings.action_space = Some(BoxSpace::new(vec![-1.0_f32; 4], vec![1.0; 4])?.into());
        SimEnv::new(Arc::new(task), simulation, settings)
    }
}

/// The model with welds that hold bodies together without a distance.
fn with_free_welds(model: &Model) -> Result<Model> {
    let mut compiled = CompiledModel::clone(model);
    let kinds = compiled.eq_type.iter();
    for (kind, data) in kinds.zip(&mut compiled.eq_data) {
        if *kind == EqualityType::Weld {
            data[..7].copy_from_slice(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        }
    }
    Model::new(compiled).map_err(|error| Error::argument("assets", error.to_string()))
}

/// The object of a task.
#[derive(Debug)]
struct Thing {
    site: Moving,
    /// The first of its positions.
    first: usize,
    /// The height of a goal on the table, in m.
    height: f64,
}

/// The task. `userdata` has the goal.
#[derive(Debug)]
struct Task {
    skill: Skill,
    grip: Moving,
    /// The body that follows the mocap body.
    link: usize,
    /// The site that shows the goal.
    target: usize,
    /// Positions and velocities of the fingers.
    fingers: [[usize; 2]; 2],
    object: Option<Thing>,
    object_range: f64,
    target_range: f64,
    ahead: f64,
    /// Time, positions and velocities at the start of an episode.
    start: (f64, Vec<f64>, Vec<f64>),
    /// The place of the gripper at the start.
    gripper: [f64; 3],
    /// The length of a step in s.
    dt: f64,
    goals: Near,
}

impl Task {
    fn new(config: &Config, figures: &Figures, simulation: &Simulation) -> Result<Self> {
        let m = &*simulation.model;
        simulation.needs("mocap bodies", m.nmocap(), 1)?;
        let joint = |name: &str| simulation.joint(name);
        let finger = |name: &str| {
            let joint = joint(name)?;
            Ok::<_, Error>([m.jnt_qposadr[joint], m.jnt_dofadr[joint]])
        };
        let mut task = Self {
            skill: config.skill,
            grip: Moving::new(simulation, "robot0:grip")?,
            link: simulation.body("robot0:gripper_link")?,
            target: simulation.site("target0")?,
            fingers: [
                finger("robot0:r_gripper_finger_joint")?,
                finger("robot0:l_gripper_finger_joint")?,
            ],
            object: match figures.object {
                Some(_) => Some(Thing {
                    site: Moving::new(simulation, "object0")?,
                    first: m.jnt_qposadr[joint("object0:joint")?],
                    height: 0.0,
                }),
                None => None,
            },
            object_range: figures.object_range,
            target_range: figures.target_range,
            ahead: figures.ahead,
            start: Default::default(),
            gripper: [0.0; 3],
            dt: simulation.dt,
            goals: Near {
                length: 3,
                threshold: 0.05,
                reward_type: config.reward_type,
            },
        };
        let mut d = Data::new(m);
        for (name, x) in [("slide0", figures.base), ("slide1", 0.48), ("slide2", 0.0)] {
            d.qpos[m.jnt_qposadr[joint(&format!("robot0:{name}"))?]] = x;
        }
        if let (Some(thing), Some(pose)) = (&task.object, &figures.object) {
            d.qpos[thing.first..thing.first + 7].copy_from_slice(pose);
        }
        forward(m, &mut d);
        // move the gripper to its place
        let [x, y, z] = d.site_xpos[task.grip.site];
        d.mocap_pos[0] = [-0.498 + x, 0.005 + y, (-0.431 + figures.height) + z];
        d.mocap_quat[0] = [1.0, 0.0, 1.0, 0.0];
        for _ in 1..10 * FRAME_SKIP {
            substep(m, &mut d);
        }
        step(m, &mut d);
        task.gripper = d.site_xpos[task.grip.site];
        if let Some(thing) = &mut task.object {
            thing.height = d.site_xpos[thing.site.site][2];
        }
        task.start = (d.time, d.qpos, d.qvel);
        Ok(task)
    }

    /// The place of the object, or of the gripper.
    fn achieved<'a>(&self, d: &'a Data) -> &'a [f64; 3] {
        let moving = self.object.as_ref().map_or(&self.grip, |thing| &thing.site);
        &d.site_xpos[moving.site]
    }

    fn draw_goal(&self, rng: &mut Rng) -> [f64; 3] {
        let mut goal = self
            .gripper
            .map(|x| x + rng.uniform(-self.target_range, self.target_range));
        if let Some(thing) = &self.object {
            goal[0] += self.ahead;
            goal[2] = thing.height;
            if self.skill == Skill::PickAndPlace && rng.random() < 0.5 {
                goal[2] += rng.uniform(0.0, 0.45);
            }
        }
        goal
    }
}

impl SimTask for Task {
    fn remembers(&self) -> usize {
        3
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let (_, d, rng) = start.parts();
        let (time, qpos, qvel) = &self.start;
        d.time = *time;
        d.qpos.copy_from_slice(qpos);
        d.qvel.copy_from_slice(qvel);
        if let Some(thing) = &self.object {
            let [x, y, _] = self.gripper;
            let range = self.object_range;
            let place = loop {
                let place = [x, y].map(|x| x + rng.uniform(-range, range));
                if norm_avx2(&[place[0] - x, place[1] - y]) >= 0.1 {
                    break place;
                }
            };
            d.qpos[thing.first..thing.first + 2].copy_from_slice(&place);
        }
        d.userdata.copy_from_slice(&self.draw_goal(rng));
        Ok(())
    }

    fn step(&self, simulation: &Simulation, d: &mut Data, action: &Array) -> Measured {
        let m = &*simulation.model;
        let mut numbers = [0.0; 4];
        for (number, a) in numbers.iter_mut().zip(action.iter_f64()) {
            *number = a.clamp(-1.0, 1.0);
        }
        let [shift @ .., grip] = numbers;
        // numpy multiplies in the precision of the action
        let shift = match action.as_slice::<f32>() {
            Some(_) => shift.map(|a| f64::from(a as f32 * 0.05)),
            None => shift.map(|a| a * 0.05),
        };
        let (place, [w, x, y, z]) = (d.xpos[self.link], d.xquat[self.link]);
        d.mocap_pos[0] = std::array::from_fn(|k| place[k] + shift[k]);
        d.mocap_quat[0] = [w + 1.0, x + 0.0, y + 1.0, z + 0.0];
        let grip = if self.skill.blocks_gripper() {
            0.0
        } else {
            grip
        };
        let mut controls = [0.0; 2];
        for (i, control) in controls.iter_mut().enumerate().take(m.nu()) {
            let position = match usize::try_from(m.actuator_trnid[i][0]) {
                Ok(joint) if m.actuator_biastype[i] != BiasType::None => {
                    d.qpos[m.jnt_qposadr[joint]]
                }
                _ => 0.0,
            };
            *control = position + grip;
        }
        simulation.drive(d, controls.into_iter());
        if self.skill.blocks_gripper() {
            for [position, _] in self.fingers {
                d.qpos[position] = 0.0;
            }
            forward(m, d);
        }
        let reward = self.goals.compute_reward(self.achieved(d), &d.userdata);
        Measured::new(reward, false)
    }

    fn observe(&self, m: &Model, d: &Data, out: &mut Observation) {
        let dt = self.dt;
        let place = d.site_xpos[self.grip.site];
        let velocity = self.grip.velocity(m, d)[0].map(|x| x * dt);
        let positions = self.fingers.map(|[position, _]| d.qpos[position]);
        let speeds = self.fingers.map(|[_, dof]| d.qvel[dof] * dt);
        out.vector("achieved_goal", *self.achieved(d));
        out.vector("desired_goal", d.userdata.iter().copied());
        if let Some(thing) = &self.object {
            let site = thing.site.site;
            let at = d.site_xpos[site];
            let [moves, turns] = thing.site.velocity(m, d).map(|v| v.map(|x| x * dt));
            let numbers = place.into_iter().chain(at).chain(sub(at, place));
            let numbers = numbers
                .chain(positions)
                .chain(mat_to_euler(&d.site_xmat[site]));
            let numbers = numbers.chain(sub(moves, velocity)).chain(turns);
            out.extend(numbers.chain(velocity).chain(speeds));
        } else {
            let numbers = place.into_iter().chain(positions);
            out.extend(numbers.chain(velocity).chain(speeds));
        }
    }

    fn names(&self, names: &mut Naming<'_>) {
        let fingers = &["right", "left"];
        let moved = if self.object.is_some() {
            "object"
        } else {
            "gripper"
        };
        names
            .part("achieved_goal")
            .xyz(&format!("{{}} of the {moved} (m)"));
        names.part("desired_goal").xyz("{} of the goal (m)");
        names.part("observation").xyz("{} of the gripper (m)");
        if self.object.is_some() {
            names.xyz("{} of the object (m)");
            names.xyz("{} from gripper to object (m)");
        }
        names.each(fingers, "position of the {} finger (m)");
        if self.object.is_some() {
            names.xyz("Euler angle of the object about {} (rad)");
            names.xyz("movement of the object against the gripper along {} (m per step)");
            names.xyz("turn of the object about {} (rad per step)");
        }
        names.xyz("movement of the gripper along {} (m per step)");
        names.each(fingers, "movement of the {} finger (m per step)");
        for axis in ["x", "y", "z"] {
            names.action(format!("movement of the gripper along {axis} (0.05 m)"));
        }
        names.action("opening of the fingers (m)");
    }

    fn show(&self, d: &mut Data) {
        d.site_xpos[self.target] = [d.userdata[0], d.userdata[1], d.userdata[2]];
    }

    fn info(&self, _: &Simulation, d: &Data, measured: Option<&Measured>, visit: Visit<'_>) {
        if measured.is_some() {
            let is_success = self.goals.is_success(self.achieved(d), &d.userdata);
            visit("is_success", f64::from(is_success));
        }
    }

    fn goals(&self) -> Option<&dyn Goals> {
        Some(&self.goals)
    }
}

/// The registration that all ids share.
const fn fetch(
    id: &'static str,
    kwargs: &'static str,
    description: &'static str,
    policy: Option<Policy>,
) -> Registration {
    let registration = Registration::new::<Fetch>(id)
        .names(gym_sim::names)
        .description(description)
        .kwargs(kwargs)
        .max_episode_steps(50)
        .needs(assets::NEED, assets::available)
        .keys(|_| {
            let keys = json!({
                "Right": [0, 1, 0, 0], "Left": [0, -1, 0, 0], "Up": [-1, 0, 0, 0], "Down": [1, 0, 0, 0],
                "W": [0, 0, 1, 0], "S": [0, 0, -1, 0], "A": [0, 0, 0, -1], "D": [0, 0, 0, 1],
            });
            Keys::new(keys).idle(json!([0, 0, 0, 0]))
        })
        .exceptions(&[(
            "no-allocation",
            "buffers of contacts grow in the first steps",
        )])
        .clip(Clip {
            seeds: 0..2,
            every: 1,
            frames: 50,
            size: (240, 240),
        });
    match policy {
        Some(policy) => registration.policy(policy),
        None => registration,
    }
}

macro_rules! ids {
    ($($name:literal, $skill:literal, $description:literal, $policy:expr;)+) => {
        gym_core::register!($(
            fetch(
                concat!("Fetch", $name, "-v4"),
                concat!("{\"skill\":\"", $skill, "\",\"reward_type\":\"sparse\"}"),
                $description,
                $policy,
            ),
            fetch(
                concat!("Fetch", $name, "Dense-v4"),
                concat!("{\"skill\":\"", $skill, "\",\"reward_type\":\"dense\"}"),
                $description,
                $policy,
            ),
        )+);
    };
}
ids! {
    "Reach", "reach", "Move the gripper of an arm to a goal.", Some(policy::REACH);
    "Push", "push", "Push a box to a goal with an arm.", None;
    "Slide", "slide", "Hit a puck so that it slides to a goal.", None;
    "PickAndPlace", "pick_and_place", "Carry a box to a goal with an arm.", Some(policy::CARRY);
}
