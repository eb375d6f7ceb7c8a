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

use crate::cost::ControlCost;
use crate::noise::{normal_noise, uniform_noise};
use crate::{HalfCheetah, clip};
use gym_core::{Array, Registration, Result};
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

impl FromArguments for Task {
    type Config = Config;

    fn new(config: &Config, version: u32, simulation: &Simulation) -> Result<Self> {
        simulation.needs("positions", simulation.model.nq(), 1)?;
        Ok(Self {
            config: config.clone(),
            cost: ControlCost::new(config.ctrl_cost_weight, version),
            version,
        })
    }
}

impl SimTask for Task {
    fn measures(&self) -> Measures {
        &[("x_velocity", 1), ("forward", 1), ("ctrl", 1)]
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(Vec::new())
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let (_, data, rng) = start.parts();
        let scale = self.config.reset_noise_scale;
        uniform_noise(&mut data.qpos, scale, rng);
        normal_noise(&mut data.qvel, scale, rng);
        Ok(())
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> Measured {
        let before = data.qpos[0];
        simulation.step(data, action);
        let x_velocity = (data.qpos[0] - before) / simulation.dt;
        let forward = self.config.forward_reward_weight * x_velocity;
        let ctrl = self.cost.of(action);
        Measured::new(forward - ctrl, false).with([x_velocity, forward, ctrl])
    }

    fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
        let skip = usize::from(self.config.exclude_current_positions_from_observation);
        out.extend(data.qpos.iter().skip(skip).chain(&data.qvel).copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        let skip = usize::from(self.config.exclude_current_positions_from_observation);
        names.positions(skip..).velocities(..);
    }

    fn info(&self, _: &Simulation, data: &Data, measured: Option<&Measured>, visit: Visit<'_>) {
        if self.version >= 3 && (self.version >= 5 || measured.is_some()) {
            visit("x_position", data.qpos[0]);
        }
        let Some([x_velocity, forward, ctrl]) = measured.map(Measured::numbers) else {
            return;
        };
        if self.version >= 3 {
            visit("x_velocity", x_velocity);
        }
        visit(
            if self.version >= 5 {
                "reward_forward"
            } else {
                "reward_run"
            },
            forward,
        );
        visit("reward_ctrl", -ctrl);
    }
}

/// The registration that all versions share.
const fn half_cheetah(id: &'static str) -> Registration {
    register::<HalfCheetah>(id)
        .description("Run on two legs, in a plane, as fast as possible.")
        .max_episode_steps(1000)
        .reward_threshold(4800.0)
}

gym_core::register!(
    half_cheetah("HalfCheetah-v2"),
    half_cheetah("HalfCheetah-v3"),
    half_cheetah("HalfCheetah-v4"),
    half_cheetah("HalfCheetah-v5").clip(clip(2, 60, 240)),
);
