//! HalfCheetah: run as fast as possible on two legs, in a vertical plane.
//!
//! | | |
//! |---|---|
//! | observation | height and angle of the torso and angles of the six joints, then velocities of x, z, torso and joints; `Box(17, float64)` |
//! | action | torques of back thigh, shin, foot, front thigh, shin, foot, as a share of 120, 90, 60, 120, 60, 30 N m; `Box(-1, 1, (6,), float32)` |
//! | reward | velocity forward in m/s, less 0.1 times the sum of the squared actions |
//! | start | standing, positions disturbed uniformly by up to 0.1, velocities normally with deviation 0.1 |
//! | end | never |
//! | limit | 1000 steps of 0.05 s |
//!
//! Versions: 4 lacks `xml_file` and `frame_skip`; 3 also lacks the camera's arguments; 2 takes only
//! `mujoco`.
//!
//! Differences from Gymnasium: all numbers equal Gymnasium's with the version of MuJoCo that
//! `mujoco` names, for Linux on x86-64. By default that is 4.0; versions 2 and 3, and Pusher-v4,
//! which Gymnasium 1.4.0 refuses to make, keep 3.12. The default camera follows the torso.
//!
//! Source: Gymnasium 1.4.0, `envs/mujoco/half_cheetah_v5.py` and `_v4.py`; 0.29.1 for versions 2
//! and 3.

use gym_core::{Array, Generator, Registration, Result};
use serde::{Deserialize, Serialize};

use super::arguments::{Common, TaskArguments};
use super::cost::ControlCost;
use super::env::{self, Visit};
use super::simulation::{Simulation, normal_noise, uniform_noise};
use super::{HalfCheetah, clip};
use crate::Data;
use crate::lanes::Derived;
use crate::view::CameraConfig;

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The arguments that all tasks share.
        #[flatten(xml_file = 3 | 5..)]
        pub common: Common = Common::new("half_cheetah.xml", 5, CameraConfig::following(1, 3.2, 90.0, -12.0, 0.5)),
        /// Reward for a velocity of 1 m/s.
        #[versions = 3..]
        pub forward_reward_weight: f64 = 1.0,
        /// Cost of the squared actions.
        #[versions = 3..]
        pub ctrl_cost_weight: f64 = 0.1,
        /// Size of the disturbance at the start.
        #[versions = 3..]
        pub reset_noise_scale: f64 = 0.1,
        /// Whether the position along x is not observed.
        #[versions = 3..]
        pub exclude_current_positions_from_observation: bool = true,
    }
}

impl TaskArguments for Config {}

/// The task.
#[derive(Clone, Debug)]
pub struct Task {
    config: Config,
    cost: ControlCost,
    version: u32,
}

/// Quantities measured in a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    x_velocity: f64,
    forward: f64,
    ctrl: f64,
}

impl env::Task for Task {
    const READS: Option<&'static [Derived]> = Some(&[]);

    type Config = Config;
    type Step = Step;

    fn new(config: &Config, version: u32, simulation: &Simulation) -> Result<Self> {
        simulation.needs("positions", simulation.model.nq(), 1)?;
        Ok(Self {
            config: config.clone(),
            cost: ControlCost::new(config.ctrl_cost_weight, version),
            version,
        })
    }

    fn start(&self, simulation: &Simulation, data: &mut Data, rng: &mut Generator) {
        let scale = self.config.reset_noise_scale;
        uniform_noise(&mut data.qpos, &simulation.model.qpos0, scale, rng);
        normal_noise(&mut data.qvel, scale, rng);
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> (Step, f64, bool) {
        let before = data.qpos[0];
        simulation.step(data, action);
        let x_velocity = (data.qpos[0] - before) / simulation.dt;
        let forward = self.config.forward_reward_weight * x_velocity;
        let ctrl = self.cost.of(action);
        (
            Step {
                x_velocity,
                forward,
                ctrl,
            },
            forward - ctrl,
            false,
        )
    }

    fn observe(&self, _simulation: &Simulation, data: &Data) -> impl Iterator<Item = f64> {
        let skip = usize::from(self.config.exclude_current_positions_from_observation);
        data.qpos.iter().skip(skip).chain(&data.qvel).copied()
    }

    fn info(&self, _: &Simulation, data: &Data, step: Option<&Step>, visit: Visit<'_>) {
        if self.version >= 3 && (self.version >= 5 || step.is_some()) {
            visit("x_position", data.qpos[0]);
        }
        let Some(step) = step else { return };
        if self.version >= 3 {
            visit("x_velocity", step.x_velocity);
        }
        visit(
            if self.version >= 5 {
                "reward_forward"
            } else {
                "reward_run"
            },
            step.forward,
        );
        visit("reward_ctrl", -step.ctrl);
    }
}

/// The registration that all versions share.
const fn half_cheetah(id: &'static str) -> Registration {
    Registration::new::<HalfCheetah>(id)
        .lockstep::<HalfCheetah>()
        .description("Run on two legs, in a plane, as fast as possible.")
        .max_episode_steps(1000)
        .reward_threshold(4800.0)
}

#[cfg(not(test))]
gym_core::register!(
    half_cheetah("HalfCheetah-v2"),
    half_cheetah("HalfCheetah-v3"),
    half_cheetah("HalfCheetah-v4"),
    half_cheetah("HalfCheetah-v5").clip(clip(2, 60, 240)),
);
