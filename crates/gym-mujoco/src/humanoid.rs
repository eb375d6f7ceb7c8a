//! Humanoid: walk along x, upright.
//!
//! | | |
//! |---|---|
//! | observation | height and orientation of the torso and 17 angles, velocities (linear, angular, joints), then for each body inertia about the centre of mass (10 numbers) and velocity (6), torques of the actuators (17), and for each body contact forces (6); `Box(348, float64)` (before version 5: with the world's body and the torso's torques, which are 0, 376 numbers) |
//! | action | torques of the 17 joints, as a share of 25 to 300 N m; `Box(-0.4, 0.4, (17,), float32)` |
//! | reward | 1.25 times the velocity along x in m/s of the centre of mass, plus 5 while it stands, less 0.1 times the sum of the squared actions, less 5e-7 times the sum of the squared contact forces, at most 10 (version 4: without these) |
//! | start | standing, positions and velocities disturbed uniformly by up to 0.01 |
//! | end | terminated when the height of the torso leaves 1 to 2 m |
//! | limit | 1000 steps of 0.015 s |
//!
//! Versions: 4 has no cost of contacts, and lacks `xml_file` and `frame_skip`; 3 also lacks the
//! camera's arguments; 2 takes only `mujoco`.
//!
//! Differences from Gymnasium: all numbers equal Gymnasium's with the version of MuJoCo that
//! `mujoco` names, for Linux on x86-64. By default that is 4.0; versions 2 and 3, and Pusher-v4,
//! which Gymnasium 1.4.0 refuses to make, keep 3.12. The default camera follows the torso.
//!
//! Source: Gymnasium 1.4.0, `envs/mujoco/humanoid_v5.py` and `_v4.py`; 0.29.1 for versions 2 and 3.

use crate::bodies::{FORCES, INERTIA, VELOCITY, name_bodies};
use crate::motion::visit_motion;
use crate::noise::uniform_noise;
use crate::range::Range;
use crate::{Humanoid, clip};
use gym_core::{Array, Registration, Result};
use gym_sim::numpy::{sum, sum_of_squares};
use gym_sim::view::CameraConfig;
use gym_sim::{
    Common, FromArguments, Measured, Measures, Naming, Observation, SimTask, Simulation, Start,
    TaskArguments, Visit, register,
};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The arguments that all tasks share.
        #[flatten(xml_file = 3 | 5..)]
        pub common: Common = Common::new("humanoid.xml", 5, CameraConfig::following(1, 3.6, 120.0, -14.0, 0.9)),
        /// Reward for a velocity of 1 m/s.
        #[versions = 3..]
        pub forward_reward_weight: f64 = 1.25,
        /// Cost of the squared actions.
        #[versions = 3..]
        pub ctrl_cost_weight: f64 = 0.1,
        /// Cost of the squared contact forces.
        #[versions = 3 | 5..]
        pub contact_cost_weight: f64 = 5e-7,
        /// The range to which the cost of contacts is clipped.
        #[versions = 3 | 5..]
        pub contact_cost_range: Range = Range::new(f64::NEG_INFINITY, 10.0),
        /// Reward for a step after which the humanoid is healthy.
        #[versions = 3..]
        pub healthy_reward: f64 = 5.0,
        /// Whether a fall ends the episode.
        #[versions = 3..]
        pub terminate_when_unhealthy: bool = true,
        /// The range of heights at which the humanoid is healthy.
        #[unit = "m"]
        #[versions = 3..]
        pub healthy_z_range: Range = Range::new(1.0, 2.0),
        /// Size of the disturbance at the start.
        #[versions = 3..]
        pub reset_noise_scale: f64 = 1e-2,
        /// The parts of the observation.
        #[flatten(exclude_current_positions_from_observation = 3..)]
        pub observed: Observed,
    }
}

gym_core::arguments! {
    /// The parts of a humanoid's observation.
    #[derive(Copy, Eq)]
    pub struct Observed {
        /// Whether the observation leaves out the positions along x and y.
        #[versions = 5..]
        pub exclude_current_positions_from_observation: bool = true,
        /// Whether inertias are observed.
        #[versions = 5..]
        pub include_cinert_in_observation: bool = true,
        /// Whether velocities of the bodies are observed.
        #[versions = 5..]
        pub include_cvel_in_observation: bool = true,
        /// Whether torques of the actuators are observed.
        #[versions = 5..]
        pub include_qfrc_actuator_in_observation: bool = true,
        /// Whether contact forces are observed.
        #[versions = 5..]
        pub include_cfrc_ext_in_observation: bool = true,
    }
}

impl Observed {
    /// The elements of the observation. Before version 5, the elements include the world's body and
    /// the root joint's torques, which are zero.
    pub(crate) fn numbers(self, version: u32, data: &Data) -> impl Iterator<Item = f64> {
        let (world, root) = if version >= 5 { (1, 6) } else { (0, 0) };
        let skip = 2 * usize::from(self.exclude_current_positions_from_observation);
        let part = |included: bool, numbers: &'_ [f64], first: usize| {
            let first = if included {
                first.min(numbers.len())
            } else {
                numbers.len()
            };
            first..numbers.len()
        };
        let inertias = data.cinert.as_flattened();
        let velocities = data.cvel.as_flattened();
        let forces = data.cfrc_ext.as_flattened();
        let torques = &data.qfrc_actuator;
        (data.qpos.iter().skip(skip))
            .chain(&data.qvel)
            .chain(&inertias[part(self.include_cinert_in_observation, inertias, 10 * world)])
            .chain(&velocities[part(self.include_cvel_in_observation, velocities, 6 * world)])
            .chain(&torques[part(self.include_qfrc_actuator_in_observation, torques, root)])
            .chain(&forces[part(self.include_cfrc_ext_in_observation, forces, 6 * world)])
            .copied()
    }

    /// Adds the names of [`numbers`](Self::numbers).
    pub(crate) fn names(self, version: u32, names: &mut Naming<'_>) {
        let (world, root) = if version >= 5 { (1, 6) } else { (0, 0) };
        let skip = 2 * usize::from(self.exclude_current_positions_from_observation);
        names.positions(skip..).velocities(..);
        if self.include_cinert_in_observation {
            name_bodies(names, world, INERTIA);
        }
        if self.include_cvel_in_observation {
            name_bodies(names, world, VELOCITY);
        }
        if self.include_qfrc_actuator_in_observation {
            names.forces("actuator", root..);
        }
        if self.include_cfrc_ext_in_observation {
            name_bodies(names, world, FORCES);
        }
    }
}

impl TaskArguments for Config {}

/// The task.
#[derive(Clone, Debug)]
pub struct Task {
    config: Config,
    version: u32,
    total_mass: f64,
}

impl Task {
    /// The centre of mass in x and y at the last forward call.
    fn mass_center(&self, simulation: &Simulation, data: &Data) -> [f64; 2] {
        let masses = &simulation.model.body_mass;
        let moment = |k: usize| {
            let moments = masses.iter().zip(&data.xipos);
            moments.map(|(mass, pos)| mass * pos[k]).sum::<f64>()
        };
        [moment(0) / self.total_mass, moment(1) / self.total_mass]
    }
}

/// The arrays, beside the state, that Humanoid and HumanoidStandup read for observations, rewards
/// and infos.
pub(crate) const READS: [Derived; 7] = [
    Derived::Xipos,
    Derived::Cinert,
    Derived::Cvel,
    Derived::QfrcActuator,
    Derived::CfrcExt,
    Derived::TenLength,
    Derived::TenVelocity,
];

impl FromArguments for Task {
    type Config = Config;

    fn new(config: &Config, version: u32, simulation: &Simulation) -> Result<Self> {
        simulation.needs("positions", simulation.model.nq(), 3)?;
        Ok(Self {
            config: config.clone(),
            version,
            total_mass: sum(&simulation.model.body_mass),
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
        Some(READS.to_vec())
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let (_, data, rng) = start.parts();
        let scale = self.config.reset_noise_scale;
        uniform_noise(&mut data.qpos, scale, rng);
        uniform_noise(&mut data.qvel, scale, rng);
        Ok(())
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> Measured {
        let config = &self.config;
        let before = self.mass_center(simulation, data);
        simulation.step(data, action);
        let position = self.mass_center(simulation, data);
        let moved = [position[0] - before[0], position[1] - before[1]];
        let velocity = moved.map(|distance| distance / simulation.dt);

        let healthy = config.healthy_z_range.contains_strictly(data.qpos[2]);
        let paid = healthy || (self.version < 5 && config.terminate_when_unhealthy);
        let survive = f64::from(paid) * config.healthy_reward;
        let forward = if self.version >= 3 {
            config.forward_reward_weight * velocity[0]
        } else {
            config.forward_reward_weight * moved[0] / simulation.dt
        };
        let ctrl = config.ctrl_cost_weight * sum_of_squares(data.ctrl.len(), |i| data.ctrl[i]);
        let contact = if self.version == 4 {
            0.0
        } else {
            let forces = data.cfrc_ext.as_flattened();
            let cost = config.contact_cost_weight * sum_of_squares(forces.len(), |i| forces[i]);
            config.contact_cost_range.clip(cost)
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
        out.extend(self.config.observed.numbers(self.version, data));
    }

    fn names(&self, names: &mut Naming<'_>) {
        self.config.observed.names(self.version, names);
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
        if self.version >= 5 {
            visit("reward_survive", survive);
            visit("reward_forward", forward);
            visit("reward_ctrl", -ctrl);
            visit("reward_contact", -contact);
            return;
        }
        visit("reward_linvel", forward);
        visit("reward_quadctrl", -ctrl);
        visit("reward_alive", survive);
        if self.version <= 3 {
            visit("reward_impact", -contact);
        }
        visit_motion(self.version, data, motion, visit);
        if self.version >= 3 {
            visit("forward_reward", forward);
        }
    }

    fn tendons_follow(&self) -> Option<&'static str> {
        (self.version >= 5).then_some("y_position")
    }
}

/// The registration that all versions share.
const fn humanoid(id: &'static str) -> Registration {
    register::<Humanoid>(id)
        .description("Walk along x, upright.")
        .max_episode_steps(1000)
}

gym_core::register!(
    humanoid("Humanoid-v2"),
    humanoid("Humanoid-v3").exceptions(&[(
        "arguments-matter.contact_cost_weight",
        "contact forces are always 0 in this version, as in Gymnasium's"
    )]),
    humanoid("Humanoid-v4"),
    humanoid("Humanoid-v5").clip(clip(2, 30, 240)),
);
