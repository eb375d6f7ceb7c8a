//! HandManipulate: turn and move a block, an egg or a pen in a Shadow hand to a pose.
//!
//! | | |
//! |---|---|
//! | observation | `observation`: angles of the joints in rad, their velocities in rad/s, velocity in m/s and angular velocity in rad/s of the object, and its pose (61 numbers), with `TouchSensors` also 92 forces in N, `Boolean`: whether they are positive (153 numbers); `achieved_goal`: the pose of the object, a place in m and a quaternion; `desired_goal`: the goal's pose (7 numbers each) |
//! | action | angles of the joints, as shares of their ranges; `Box(-1, 1, (20,), float32)` |
//! | reward | 0 within 0.01 m (pens: 0.05 m) and 0.1 rad of the goal, else -1; ids with `Dense`: minus ten times the distance in m, minus the angle in rad. `Rotate` leaves out the distance; pens may turn about their axis |
//! | start | the object falls into the hand, turned at random (pens: not), and lies above 0.04 m after 0.4 s; the goal is turned at random, `RotateZ`: about the vertical; `RotateParallel`: with sides along the axes, and about the vertical; without `Rotate` it is up to 0.06 m away |
//! | end | never |
//! | limit | 100 steps of 0.04 s |
//!
//! `info` has `is_success` after a step: 1 at the goal, else 0.
//!
//! Differences from Gymnasium-Robotics: all numbers are Gymnasium-Robotics' with the version of
//! MuJoCo that `mujoco` names, for Linux on x86-64, and with numpy on a CPU without AVX-512 in OpenBLAS;
//! with it, goals differ in the last bit. An episode that is seeded does not depend on the one
//! before, from which the package keeps the solver's starting point. Pictures show all touch sensors
//! alike. The arguments `relative_control`, `initial_qpos` and `n_substeps`, and targets whose
//! rotation is ignored or fixed, for which the package fails, are left out.
//!
//! Source: Gymnasium-Robotics 1.4.2, `envs/shadow_dexterous_hand/manipulate.py`,
//! `manipulate_touch_sensors.py`, `hand_env.py`, and `utils/rotations.py`.

use std::path::PathBuf;

use gym_core::registry::Build;
use gym_core::{Array, Error, Goals, Registration, Result};
use gym_sim::{
    Common, Measured, Naming, Observation, Rng, SimEnv, SimTask, Simulation, Start, Visit,
};
use mujoco_engine::math::{add, mul_quat, quat_to_mat, rotate};
use mujoco_engine::{Data, Model};
use serde::{Deserialize, Serialize};

use super::pose::{Pose, draw_any, draw_upright, parallel, quat_mul, unit};
use super::{ALLOCATES, Hand, camera, make, registered};
use crate::RewardType;

/// How far from the object the goal is, in m along x, y and z.
const TARGET_RANGE: [[f64; 2]; 3] = [[-0.04, 0.04], [-0.06, 0.02], [0.0, 0.06]];

/// The height above which the object lies in the hand, in m.
const ON_PALM: f64 = 0.04;

/// The largest number of starts that a reset tries.
const ATTEMPTS: usize = 1000;

/// Makes an argument of an enum of words.
macro_rules! words {
    ($($(#[$doc:meta])* $name:ident, $kind:literal: $($(#[$of:meta])* $word:ident),+;)+) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
            #[serde(rename_all = "lowercase")]
            pub enum $name {
                $($(#[$of])* $word,)+
            }

            impl gym_core::ArgumentType for $name {
                fn kind() -> String {
                    $kind.to_owned()
                }
            }
        )+
    };
}

words! {
    /// What lies in the hand.
    Object, "\"block\", \"egg\" or \"pen\"":
        /// A cube.
        #[default]
        Block,
        /// An ellipsoid.
        Egg,
        /// A long capsule.
        Pen;
    /// The place of the goal.
    TargetPosition, "\"ignore\", \"fixed\" or \"random\"":
        /// It does not matter.
        Ignore,
        /// Where the object starts.
        Fixed,
        /// Near the object.
        #[default]
        Random;
    /// The rotation of the goal.
    TargetRotation, "\"z\", \"parallel\" or \"xyz\"":
        /// About the vertical.
        Z,
        /// With sides along the axes, and about the vertical.
        Parallel,
        /// Any.
        #[default]
        Xyz;
    /// The observation of touch sensors.
    Touch, "\"boolean\", \"sensordata\", \"log\" or \"off\"":
        /// 1 for a positive force, else 0.
        Boolean,
        /// Forces in N.
        #[default]
        Sensordata,
        /// The logarithm of the force in N plus 1.
        Log,
        /// None, on the model with sensors.
        Off;
}

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// What lies in the hand; each id has its own.
        pub object: Object,
        /// The place of the goal: `"random"` near the object, `"fixed"` where it starts, or
        /// `"ignore"`, if it does not matter.
        pub target_position: TargetPosition,
        /// The rotation of the goal: about the vertical, `"z"`; with sides along the axes,
        /// `"parallel"`; or `"xyz"`, any.
        pub target_rotation: TargetRotation,
        /// What touch sensors observe: whether a force is positive, `"boolean"`; the force in N,
        /// `"sensordata"`; its logarithm after adding 1, `"log"`; or nothing, `"off"`. `None` for a
        /// hand without such sensors.
        pub touch_get_obs: Option<Touch>,
        /// The reward: `"sparse"`, which is 0 at the goal and -1 elsewhere, or `"dense"`.
        pub reward_type: RewardType,
        /// Whether the object starts at a random place, unless `target_position` is `"fixed"`.
        pub randomize_initial_position: bool = true,
        /// Whether the object starts with a random rotation; `None` for yes, and no for a pen.
        pub randomize_initial_rotation: Option<bool>,
        /// The distance within which a goal is reached; `None` for 0.01 m, and 0.05 m for a pen.
        #[unit = "m"]
        pub distance_threshold: Option<f64>,
        /// The angle within which a goal is reached.
        #[unit = "rad"]
        pub rotation_threshold: f64 = 0.1,
        /// Whether a turn about the vertical does not matter; `None` for no, and yes for a pen.
        pub ignore_z_target_rotation: Option<bool>,
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

impl Config {
    /// The name of the environment, and its model.
    fn files(&self) -> (&'static str, &'static str) {
        match (self.object, self.touch_get_obs.is_some()) {
            (Object::Block, false) => ("MujocoHandBlockEnv", "hand/manipulate_block.xml"),
            (Object::Egg, false) => ("MujocoHandEggEnv", "hand/manipulate_egg.xml"),
            (Object::Pen, false) => ("MujocoHandPenEnv", "hand/manipulate_pen.xml"),
            (Object::Block, true) => (
                "MujocoHandBlockTouchSensorsEnv",
                "hand/manipulate_block_touch_sensors.xml",
            ),
            (Object::Egg, true) => (
                "MujocoHandEggTouchSensorsEnv",
                "hand/manipulate_egg_touch_sensors.xml",
            ),
            (Object::Pen, true) => (
                "MujocoHandPenTouchSensorsEnv",
                "hand/manipulate_pen_touch_sensors.xml",
            ),
        }
    }
}

/// The constructor of the environments.
#[derive(Clone, Copy, Debug)]
pub struct HandManipulate;

impl Build for HandManipulate {
    type Config = Config;
    type Env = SimEnv;

    fn defaults(_version: u32) -> Config {
        let mut config = Config::default();
        config.common.default_camera_config = camera();
        config
    }

    fn build(mut config: Config, version: u32) -> Result<SimEnv> {
        let folder = config.assets.take();
        let (name, model) = config.files();
        make(
            (name, version),
            (model, folder),
            &config,
            &config.common,
            |simulation| Task::new(&config, simulation),
        )
    }
}

/// A free body.
#[derive(Debug)]
struct Body {
    /// The first of its positions and of its velocities.
    position: usize,
    dof: usize,
}

impl Body {
    fn new(simulation: &Simulation, joint: &str) -> Result<Self> {
        let (m, joint) = (&simulation.model, simulation.joint(joint)?);
        Ok(Self {
            position: m.jnt_qposadr[joint],
            dof: m.jnt_dofadr[joint],
        })
    }

    fn pose<'a>(&self, d: &'a Data) -> &'a [f64] {
        &d.qpos[self.position..self.position + 7]
    }
}

/// A part of the body that shows the goal: a geom or a site, its place and its rotation.
#[derive(Debug)]
struct Part {
    id: usize,
    pos: [f64; 3],
    quat: [f64; 4],
}

/// The task. `userdata` has the goal.
#[derive(Debug)]
struct Task {
    hand: Hand,
    object: Body,
    /// The site in the middle of the object.
    center: usize,
    /// The geoms and the sites of the body that shows the goal.
    shown: [Vec<Part>; 2],
    target_position: TargetPosition,
    target_rotation: TargetRotation,
    /// Whether the object's place and its rotation are random at the start.
    random: [bool; 2],
    /// The rotations with sides along the axes.
    parallel: Vec<[f64; 4]>,
    /// The touch sensors that are observed.
    sensors: Vec<usize>,
    touch: Touch,
    goals: Pose,
}

impl Task {
    fn new(config: &Config, simulation: &Simulation) -> Result<Self> {
        let m = &*simulation.model;
        let is_pen = config.object == Object::Pen;
        let target = simulation.body("target")?;
        let parts = |of: &[usize], pos: &[[f64; 3]], quat: &[[f64; 4]]| -> Vec<Part> {
            let own = of.iter().enumerate().filter(|(_, body)| **body == target);
            own.map(|(id, _)| Part {
                id,
                pos: pos[id],
                quat: quat[id],
            })
            .collect()
        };
        let touch = config.touch_get_obs.unwrap_or(Touch::Off);
        let names = m.names.sensor.iter().enumerate();
        let sensors = names.filter(|(_, name)| {
            touch != Touch::Off && name.as_ref().is_some_and(|n| n.contains("robot0:TS_"))
        });
        let distance = config
            .distance_threshold
            .unwrap_or(if is_pen { 0.05 } else { 0.01 });
        Ok(Self {
            hand: Hand::new(m),
            object: Body::new(simulation, "object:joint")?,
            center: simulation.site("object:center")?,
            shown: [
                parts(&m.geom_bodyid, &m.geom_pos, &m.geom_quat),
                parts(&m.site_bodyid, &m.site_pos, &m.site_quat),
            ],
            target_position: config.target_position,
            target_rotation: config.target_rotation,
            random: [
                config.randomize_initial_position
                    && config.target_position != TargetPosition::Fixed,
                config.randomize_initial_rotation.unwrap_or(!is_pen),
            ],
            parallel: parallel(),
            sensors: sensors.map(|(id, _)| id).collect(),
            touch,
            goals: Pose {
                by_place: config.target_position != TargetPosition::Ignore,
                ignore_z: config.ignore_z_target_rotation.unwrap_or(is_pen),
                thresholds: [distance, config.rotation_threshold],
                reward_type: config.reward_type,
            },
        })
    }

    /// Draws a rotation of the kind that goals have.
    fn draw_rotation(&self, rng: &mut Rng) -> [f64; 4] {
        match self.target_rotation {
            TargetRotation::Z => draw_upright(rng),
            TargetRotation::Parallel => {
                let upright = draw_upright(rng);
                let index = rng.integer(self.parallel.len() as u32) as usize;
                quat_mul(upright, self.parallel[index])
            }
            TargetRotation::Xyz => draw_any(rng),
        }
    }

    /// Draws the pose in which the object starts, from its pose in the model.
    fn draw_start(&self, pose: &[f64], rng: &mut Rng) -> [f64; 7] {
        let mut quat = [pose[3], pose[4], pose[5], pose[6]];
        let mut place = [pose[0], pose[1], pose[2]];
        if self.random[1] {
            quat = quat_mul(quat, self.draw_rotation(rng));
        }
        if self.random[0] {
            place = place.map(|x| x + 0.005 * rng.standard_normal());
        }
        let ([x, y, z], [a, b, c, d]) = (place, unit(quat));
        [x, y, z, a, b, c, d]
    }

    fn draw_goal(&self, pose: &[f64], rng: &mut Rng) -> [f64; 7] {
        let mut place = [pose[0], pose[1], pose[2]];
        if self.target_position == TargetPosition::Random {
            for (x, [low, high]) in place.iter_mut().zip(TARGET_RANGE) {
                *x += rng.uniform(low, high);
            }
        }
        let ([x, y, z], [a, b, c, d]) = (place, unit(self.draw_rotation(rng)));
        [x, y, z, a, b, c, d]
    }
}

impl SimTask for Task {
    fn remembers(&self) -> usize {
        7
    }

    fn goes_on(&self) -> bool {
        true
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        for _ in 0..ATTEMPTS {
            let (m, d, _) = start.parts();
            d.time = 0.0;
            d.qpos.copy_from_slice(&m.qpos0);
            d.qvel.fill(0.0);
            start.settle();
            let (_, d, rng) = start.parts();
            let pose = self.draw_start(self.object.pose(d), rng);
            let first = self.object.position;
            d.qpos[first..first + 7].copy_from_slice(&pose);
            let still = self.hand.controls(std::iter::repeat(0.0));
            d.ctrl.iter_mut().zip(still).for_each(|(to, x)| *to = x);
            for _ in 0..10 {
                start.step(super::FRAME_SKIP);
            }
            start.settle();
            let (_, d, rng) = start.parts();
            if d.site_xpos[self.center][2] > ON_PALM {
                let goal = self.draw_goal(self.object.pose(d), rng);
                d.userdata.copy_from_slice(&goal);
                return Ok(());
            }
        }
        let reason = format!(
            "the object fell out of the hand in {ATTEMPTS} starts: change the model so that it can lie there"
        );
        Err(Error::argument("model", reason))
    }

    fn step(&self, simulation: &Simulation, d: &mut Data, action: &Array) -> Measured {
        self.hand.step(simulation, d, action);
        let reward = self.goals.compute_reward(self.object.pose(d), &d.userdata);
        Measured::new(reward, false)
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        let pose = self.object.pose(d).iter().copied();
        let dof = self.object.dof;
        let speeds = d.qvel[dof..dof + 6].iter().copied();
        let touch = self.sensors.iter().map(|id| {
            let force = d.sensordata[*id];
            match self.touch {
                Touch::Boolean => f64::from(force > 0.0),
                Touch::Log => gym_core::math::ln(force + 1.0),
                Touch::Sensordata | Touch::Off => force,
            }
        });
        out.vector("achieved_goal", pose.clone());
        out.vector("desired_goal", d.userdata.iter().copied());
        out.extend(self.hand.state(d).chain(speeds).chain(pose).chain(touch));
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("achieved_goal").pose("the object");
        names.part("desired_goal").pose("the goal");
        self.hand.names(names.part("observation"));
        let dof = self.object.dof;
        names.velocities(dof..dof + 6).pose("the object");
        for sensor in &self.sensors {
            let name = names.sensor(*sensor);
            match self.touch {
                Touch::Boolean => names.of("whether there is a", &name),
                Touch::Log => names.of("logarithm of 1 N plus", &name),
                Touch::Sensordata | Touch::Off => names.add(name),
            };
        }
    }

    /// Shows the goal beside the object, if the goal has no place.
    fn show(&self, d: &mut Data) {
        let [mut x, y, z, q @ ..] = [0, 1, 2, 3, 4, 5, 6].map(|k| d.userdata[k]);
        if self.target_position == TargetPosition::Ignore {
            x += 0.15;
        }
        let mat = quat_to_mat(q);
        let place = |part: &Part| add([x, y, z], rotate(&mat, part.pos));
        let turned = |part: &Part| quat_to_mat(mul_quat(q, part.quat));
        let [geoms, sites] = &self.shown;
        for part in geoms {
            d.geom_xpos[part.id] = place(part);
            d.geom_xmat[part.id] = turned(part);
        }
        for part in sites {
            d.site_xpos[part.id] = place(part);
            d.site_xmat[part.id] = turned(part);
        }
    }

    fn info(&self, _: &Simulation, d: &Data, measured: Option<&Measured>, visit: Visit<'_>) {
        if measured.is_some() {
            let is_success = self.goals.is_success(self.object.pose(d), &d.userdata);
            visit("is_success", f64::from(is_success));
        }
    }

    fn goals(&self) -> Option<&dyn Goals> {
        Some(&self.goals)
    }
}

/// The registration that all ids share.
const fn manipulate(id: &'static str, kwargs: &'static str) -> Registration {
    let registration = Registration::new::<HandManipulate>(id)
        .description("Turn and move an object in a hand to a pose.")
        .kwargs(kwargs)
        .exceptions(&[
            ALLOCATES,
            (
                "arguments-matter.rotation_threshold",
                "it matters near the goal, which random actions do not reach",
            ),
            (
                "goals-agree",
                "in columns, the third goal of a pen is compared otherwise, as in the package",
            ),
        ]);
    registered(registration, 100)
}

/// Registers the ids of each object: its name, and for each goal the id's word, the place and the
/// rotation.
macro_rules! ids {
    ($($object:literal, $name:literal: { $($word:literal, $place:literal, $rotation:literal;)+ })+) => {
        $($(ids!(@touch $object, $name, $word, $place, $rotation);)+)+
        gym_core::register!($(
            ids!(@one $object, concat!($name, "Full"), "", "random", "xyz", ""),
            ids!(@dense $object, concat!($name, "Full"), "", "random", "xyz", ""),
        )+);
    };
    (@touch $object:literal, $name:literal, $word:literal, $place:literal, $rotation:literal) => {
        gym_core::register!(
            ids!(@one $object, concat!($name, $word), "", $place, $rotation, ""),
            ids!(@dense $object, concat!($name, $word), "", $place, $rotation, ""),
            ids!(@one $object, concat!($name, $word), "_BooleanTouchSensors", $place, $rotation, ",\"touch_get_obs\":\"boolean\""),
            ids!(@dense $object, concat!($name, $word), "_BooleanTouchSensors", $place, $rotation, ",\"touch_get_obs\":\"boolean\""),
            ids!(@one $object, concat!($name, $word), "_ContinuousTouchSensors", $place, $rotation, ",\"touch_get_obs\":\"sensordata\""),
            ids!(@dense $object, concat!($name, $word), "_ContinuousTouchSensors", $place, $rotation, ",\"touch_get_obs\":\"sensordata\""),
        );
    };
    (@one $object:literal, $name:expr, $suffix:literal, $place:literal, $rotation:literal, $touch:literal) => {
        manipulate(
            concat!("HandManipulate", $name, $suffix, "-v1"),
            concat!("{\"object\":\"", $object, "\",\"target_position\":\"", $place, "\",\"target_rotation\":\"", $rotation,
                "\",\"reward_type\":\"sparse\"", $touch, "}"),
        )
    };
    (@dense $object:literal, $name:expr, $suffix:literal, $place:literal, $rotation:literal, $touch:literal) => {
        manipulate(
            concat!("HandManipulate", $name, $suffix, "Dense-v1"),
            concat!("{\"object\":\"", $object, "\",\"target_position\":\"", $place, "\",\"target_rotation\":\"", $rotation,
                "\",\"reward_type\":\"dense\"", $touch, "}"),
        )
    };
}
ids! {
    "block", "Block": {
        "RotateZ", "ignore", "z";
        "RotateParallel", "ignore", "parallel";
        "RotateXYZ", "ignore", "xyz";
        "", "random", "xyz";
    }
    "egg", "Egg": {
        "Rotate", "ignore", "xyz";
        "", "random", "xyz";
    }
    "pen", "Pen": {
        "Rotate", "ignore", "xyz";
        "", "random", "xyz";
    }
}
