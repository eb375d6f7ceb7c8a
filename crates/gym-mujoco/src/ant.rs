//! Ant: walk along x on four legs.
//!
//! | | |
//! |---|---|
//! | observation | height and orientation of the torso and angles of the eight joints, velocities (linear, angular, joints), and the contact forces on each body, clipped to 1; `Box(105, float64)` (version 4: without the forces, 27 numbers; versions 2 and 3: with forces that are always 0, 111 numbers) |
//! | action | torques of hip and ankle of the fourth leg, the first, the second and the third, as a share of 150 N m; `Box(-1, 1, (8,), float32)` |
//! | reward | velocity along x in m/s, plus 1 while it is healthy, less 0.5 times the sum of the squared actions, less 0.0005 times the sum of the squared contact forces (version 4: without these) |
//! | start | standing above the floor, positions disturbed uniformly by up to 0.1, velocities normally with deviation 0.1 |
//! | end | terminated when the height of the torso leaves 0.2 to 1 m |
//! | limit | 1000 steps of 0.05 s |
//!
//! Versions: 4 observes contact forces, and subtracts their cost, only with `use_contact_forces`;
//! only 5 has `forward_reward_weight` and `main_body`. 3 also lacks the camera's arguments; 2 takes
//! only `mujoco`.
//!
//! Differences from Gymnasium: all numbers equal Gymnasium's with the version of MuJoCo that
//! `mujoco` names, for Linux on x86-64. By default that is 4.0; versions 2 and 3, and Pusher-v4,
//! which Gymnasium 1.4.0 refuses to make, keep 3.12. The default camera follows the torso.
//!
//! Source: Gymnasium 1.4.0, `envs/mujoco/ant_v5.py` and `_v4.py`; 0.29.1 for versions 2 and 3.

use gym_core::{Array, Error, Registration, Result};
use serde::{Deserialize, Serialize};

use crate::bodies::{FORCES, name_bodies};
use crate::cost::ControlCost;
use crate::motion::visit_motion;
use crate::noise::{normal_noise, uniform_noise};
use crate::range::Range;
use crate::{Ant, clip};
use gym_sim::numpy::sum_of_squares;
use gym_sim::view::CameraConfig;
use gym_sim::{
    Common, FromArguments, Measured, Measures, Naming, Observation, SimTask, Simulation, Start,
    TaskArguments, Visit, register,
};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

/// A body, by number or by name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected the number of a body, counted from 0, or its name"
)]
pub enum Body {
    /// Its number; 0 is the world.
    Id(usize),
    /// Its name.
    Name(String),
}

impl gym_core::ArgumentType for Body {
    fn kind() -> String {
        "integer or string".to_owned()
    }
}

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The arguments that all tasks share.
        #[flatten(xml_file = 3..)]
        pub common: Common = Common::new("ant.xml", 5, CameraConfig::following(1, 3.6, 60.0, -24.0, 0.4)),
        /// Reward for a velocity of 1 m/s.
        #[versions = 5..]
        pub forward_reward_weight: f64 = 1.0,
        /// Cost of the squared actions.
        #[versions = 3..]
        pub ctrl_cost_weight: f64 = 0.5,
        /// Cost of the squared contact forces.
        #[versions = 3..]
        pub contact_cost_weight: f64 = 5e-4,
        /// Reward for a step after which the ant is healthy.
        #[versions = 3..]
        pub healthy_reward: f64 = 1.0,
        /// The body whose velocity counts.
        #[versions = 5..]
        pub main_body: Body = Body::Id(1),
        /// Whether the episode ends once the agent is unhealthy.
        #[versions = 3..]
        pub terminate_when_unhealthy: bool = true,
        /// The range of heights at which the ant is healthy.
        #[unit = "m"]
        #[versions = 3..]
        pub healthy_z_range: Range = Range::new(0.2, 1.0),
        /// The range to which contact forces are clipped.
        #[versions = 3..]
        pub contact_force_range: Range = Range::new(-1.0, 1.0),
        /// Size of the disturbance at the start.
        #[versions = 3..]
        pub reset_noise_scale: f64 = 0.1,
        /// Whether the positions along x and y are not observed.
        #[versions = 3..]
        pub exclude_current_positions_from_observation: bool = true,
        /// Whether contact forces are observed.
        #[versions = 5..]
        pub include_cfrc_ext_in_observation: bool = true,
        /// Version 4: whether contact forces are observed and their cost is subtracted.
        #[versions = 4]
        pub use_contact_forces: bool,
    }
}

impl TaskArguments for Config {}

/// The task.
#[derive(Clone, Debug)]
pub struct Task {
    config: Config,
    cost: ControlCost,
    version: u32,
    main_body: usize,
    /// The first body whose contact forces are observed; `None` if they are not observed.
    observed_forces: Option<usize>,
    /// Whether the reward subtracts the cost of contact forces.
    forces_cost: bool,
}

impl Task {
    fn place(&self, data: &Data) -> [f64; 2] {
        let [x, y, _] = data.xpos[self.main_body];
        [x, y]
    }

    fn is_healthy(&self, data: &Data) -> bool {
        let Range { low, high } = self.config.healthy_z_range;
        data.qpos.iter().chain(&data.qvel).all(|x| x.is_finite())
            && (low..=high).contains(&data.qpos[2])
    }
}

impl FromArguments for Task {
    type Config = Config;

    fn new(config: &Config, version: u32, simulation: &Simulation) -> Result<Self> {
        simulation.needs("positions", simulation.model.nq(), 3)?;
        let bodies = simulation.model.nbody();
        let main_body = match &config.main_body {
            // before version 5, the torso is found by name
            _ if version < 5 => simulation.body("torso")?,
            Body::Name(name) => simulation.body(name)?,
            Body::Id(id) if *id < bodies => *id,
            Body::Id(id) => {
                let reason = format!("{id}: the model has the bodies 0 to {}", bodies - 1);
                return Err(Error::argument("main_body", reason));
            }
        };
        let (observed_forces, forces_cost) = match version {
            5.. => (config.include_cfrc_ext_in_observation.then_some(1), true),
            4 => (
                config.use_contact_forces.then_some(0),
                config.use_contact_forces,
            ),
            _ => (Some(0), true),
        };
        let cost = ControlCost::new(config.ctrl_cost_weight, version);
        Ok(Self {
            config: config.clone(),
            cost,
            version,
            main_body,
            observed_forces,
            forces_cost,
        })
    }
}

impl SimTask for Task {
    fn measures(&self) -> Measures {
        &[
            ("position", 2),
            ("velocity", 2),
            ("forward", 1),
            ("ctrl", 1),
            ("contact", 1),
            ("survive", 1),
        ]
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xpos, Derived::CfrcExt])
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let (_, data, rng) = start.parts();
        let scale = self.config.reset_noise_scale;
        uniform_noise(&mut data.qpos, scale, rng);
        normal_noise(&mut data.qvel, scale, rng);
        Ok(())
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> Measured {
        let config = &self.config;
        let before = self.place(data);
        simulation.step(data, action);
        let position = self.place(data);
        let velocity: [f64; 2] = std::array::from_fn(|k| (position[k] - before[k]) / simulation.dt);

        let healthy = self.is_healthy(data);
        let paid = healthy || (self.version < 5 && config.terminate_when_unhealthy);
        let survive = f64::from(paid) * config.healthy_reward;
        let forward = velocity[0] * config.forward_reward_weight;
        let ctrl = self.cost.of(action);
        let contact = if self.forces_cost {
            let forces = data.cfrc_ext.as_flattened();
            let clipped = |i: usize| config.contact_force_range.clip(forces[i]);
            config.contact_cost_weight * sum_of_squares(forces.len(), clipped)
        } else {
            0.0
        };
        let reward = if self.version >= 3 {
            forward + survive - (ctrl + contact)
        } else {
            forward - ctrl - contact + survive
        };
        let terminated = !healthy && config.terminate_when_unhealthy;
        Measured::new(reward, terminated).with([
            position[0],
            position[1],
            velocity[0],
            velocity[1],
            forward,
            ctrl,
            contact,
            survive,
        ])
    }

    fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
        let skip = 2 * usize::from(self.config.exclude_current_positions_from_observation);
        let first = self.observed_forces.unwrap_or(data.cfrc_ext.len());
        let forces = data.cfrc_ext[first..].as_flattened().iter();
        let clipped = forces.map(|force| self.config.contact_force_range.clip(*force));
        let state = data.qpos.iter().skip(skip).chain(&data.qvel);
        out.extend(state.copied().chain(clipped));
    }

    fn names(&self, names: &mut Naming<'_>) {
        let skip = 2 * usize::from(self.config.exclude_current_positions_from_observation);
        names.positions(skip..).velocities(..);
        if let Some(first) = self.observed_forces {
            name_bodies(names, first, FORCES);
        }
    }

    fn info(&self, _: &Simulation, data: &Data, measured: Option<&Measured>, visit: Visit<'_>) {
        let motion = measured.map(|measured| {
            let [x, y, x_velocity, y_velocity] = measured.numbers();
            ([x, y], [x_velocity, y_velocity])
        });
        if self.version >= 5 {
            visit_motion(self.version, data, motion, visit);
        }
        let Some([.., forward, ctrl, contact, survive]) = measured.map(Measured::numbers::<8>)
        else {
            return;
        };
        visit("reward_forward", forward);
        // in version 4 with contact costs, Gymnasium stores the contact cost under the key
        // `reward_ctrl`
        let is_contact = self.version == 4 && self.forces_cost;
        let cost = if is_contact { contact } else { ctrl };
        visit("reward_ctrl", -cost);
        if self.version != 4 {
            visit("reward_contact", -contact);
        }
        visit("reward_survive", survive);
        if self.version < 5 {
            visit_motion(self.version, data, motion, visit);
        }
        if matches!(self.version, 3 | 4) {
            visit("forward_reward", forward);
        }
    }
}

/// The registration that all versions share.
const fn ant(id: &'static str) -> Registration {
    register::<Ant>(id)
        .description("Walk along x on four legs.")
        .max_episode_steps(1000)
        .reward_threshold(6000.0)
}

gym_core::register!(
    ant("Ant-v2"),
    ant("Ant-v3").exceptions(&[(
        "arguments-matter.contact_cost_weight",
        "contact forces are always 0 in this version, as in Gymnasium's"
    )]),
    ant("Ant-v4"),
    ant("Ant-v5").clip(clip(2, 40, 200)),
);
