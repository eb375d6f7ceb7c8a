//! Swimmer: swim forward with three links, in a viscous medium.
//!
//! | | |
//! |---|---|
//! | observation | angle of the first link and of the two joints, then velocities of x, y and these angles; `Box(8, float64)` |
//! | action | torques of the two joints, as a share of 150 N m; `Box(-1, 1, (2,), float32)` |
//! | reward | velocity along x in m/s, less 0.0001 times the sum of the squared actions |
//! | start | stretched, positions and velocities disturbed uniformly by up to 0.1 |
//! | end | never |
//! | limit | 1000 steps of 0.04 s |
//!
//! Versions: 4 lacks `xml_file` and `frame_skip`; 3 also lacks the camera's arguments; 2 takes only
//! `mujoco`.
//!
//! Differences from Gymnasium: all numbers equal Gymnasium's with the version of MuJoCo that
//! `mujoco` names, for Linux on x86-64. By default that is 4.0; versions 2 and 3, and Pusher-v4,
//! which Gymnasium 1.4.0 refuses to make, keep 3.12. The default camera follows the torso.
//!
//! Source: Gymnasium 1.4.0, `envs/mujoco/swimmer_v5.py` and `_v4.py`; 0.29.1 for versions 2 and 3.

use gym_core::{Array, Generator, Registration, Result};
use serde::{Deserialize, Serialize};

use super::arguments::{Common, TaskArguments};
use super::cost::ControlCost;
use super::env::{self, Visit};
use super::motion::visit_motion;
use super::simulation::{Simulation, uniform_noise, uniform_velocities};
use super::{Swimmer, clip};
use crate::Data;
use crate::lanes::Derived;
use crate::view::CameraConfig;

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The arguments that all tasks share.
        #[flatten(xml_file = 3 | 5..)]
        pub common: Common = Common::new("swimmer.xml", 4, CameraConfig::following(1, 5.5, 90.0, -90.0, 0.0)),
        /// Reward for a velocity of 1 m/s.
        #[versions = 3..]
        pub forward_reward_weight: f64 = 1.0,
        /// Cost of the squared actions.
        #[versions = 3..]
        pub ctrl_cost_weight: f64 = 1e-4,
        /// Size of the disturbance at the start.
        #[versions = 3..]
        pub reset_noise_scale: f64 = 0.1,
        /// Whether the positions along x and y are not observed.
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
    velocity: [f64; 2],
    forward: f64,
    ctrl: f64,
}

impl env::Task for Task {
    const READS: Option<&'static [Derived]> = Some(&[]);

    type Config = Config;
    type Step = Step;

    fn new(config: &Config, version: u32, simulation: &Simulation) -> Result<Self> {
        simulation.needs("positions", simulation.model.nq(), 2)?;
        Ok(Self {
            config: config.clone(),
            cost: ControlCost::new(config.ctrl_cost_weight, version),
            version,
        })
    }

    fn start(&self, simulation: &Simulation, data: &mut Data, rng: &mut Generator) {
        let scale = self.config.reset_noise_scale;
        uniform_noise(&mut data.qpos, &simulation.model.qpos0, scale, rng);
        uniform_velocities(&mut data.qvel, scale, rng);
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> (Step, f64, bool) {
        let before = [data.qpos[0], data.qpos[1]];
        simulation.step(data, action);
        let velocity = std::array::from_fn(|k| (data.qpos[k] - before[k]) / simulation.dt);
        let forward = self.config.forward_reward_weight * velocity[0];
        let ctrl = self.cost.of(action);
        (
            Step {
                velocity,
                forward,
                ctrl,
            },
            forward - ctrl,
            false,
        )
    }

    fn observe(&self, _simulation: &Simulation, data: &Data) -> impl Iterator<Item = f64> {
        let skip = 2 * usize::from(self.config.exclude_current_positions_from_observation);
        data.qpos.iter().skip(skip).chain(&data.qvel).copied()
    }

    fn info(&self, _: &Simulation, data: &Data, step: Option<&Step>, visit: Visit<'_>) {
        let motion = step.map(|step| ([data.qpos[0], data.qpos[1]], step.velocity));
        if self.version >= 5 {
            visit_motion(self.version, data, motion, visit);
        }
        let Some(step) = step else { return };
        let forward = if self.version >= 5 {
            "reward_forward"
        } else {
            "reward_fwd"
        };
        visit(forward, step.forward);
        visit("reward_ctrl", -step.ctrl);
        if self.version < 5 {
            visit_motion(self.version, data, motion, visit);
        }
        if matches!(self.version, 3 | 4) {
            visit("forward_reward", step.forward);
        }
    }
}

/// The registration that all versions share.
const fn swimmer(id: &'static str) -> Registration {
    Registration::new::<Swimmer>(id)
        .lockstep::<Swimmer>()
        .description("Swim forward with three links.")
        .max_episode_steps(1000)
        .reward_threshold(360.0)
}

#[cfg(not(test))]
gym_core::register!(
    swimmer("Swimmer-v2"),
    swimmer("Swimmer-v3"),
    swimmer("Swimmer-v4"),
    swimmer("Swimmer-v5").clip(clip(3, 60, 240)),
);
