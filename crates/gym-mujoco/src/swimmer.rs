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

use crate::cost::ControlCost;
use crate::motion::visit_motion;
use crate::noise::uniform_noise;
use crate::{Swimmer, clip};
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

impl FromArguments for Task {
    type Config = Config;

    fn new(config: &Config, version: u32, simulation: &Simulation) -> Result<Self> {
        simulation.needs("positions", simulation.model.nq(), 2)?;
        Ok(Self {
            config: config.clone(),
            cost: ControlCost::new(config.ctrl_cost_weight, version),
            version,
        })
    }
}

impl SimTask for Task {
    fn measures(&self) -> Measures {
        &[("velocity", 2), ("forward", 1), ("ctrl", 1)]
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(Vec::new())
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let (_, data, rng) = start.parts();
        let scale = self.config.reset_noise_scale;
        uniform_noise(&mut data.qpos, scale, rng);
        uniform_noise(&mut data.qvel, scale, rng);
        Ok(())
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> Measured {
        let before = [data.qpos[0], data.qpos[1]];
        simulation.step(data, action);
        let velocity: [f64; 2] =
            std::array::from_fn(|k| (data.qpos[k] - before[k]) / simulation.dt);
        let forward = self.config.forward_reward_weight * velocity[0];
        let ctrl = self.cost.of(action);
        Measured::new(forward - ctrl, false).with([velocity[0], velocity[1], forward, ctrl])
    }

    fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
        let skip = 2 * usize::from(self.config.exclude_current_positions_from_observation);
        out.extend(data.qpos.iter().skip(skip).chain(&data.qvel).copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        let skip = 2 * usize::from(self.config.exclude_current_positions_from_observation);
        names.positions(skip..).velocities(..);
    }

    fn info(&self, _: &Simulation, data: &Data, measured: Option<&Measured>, visit: Visit<'_>) {
        let motion = measured.map(|measured| ([data.qpos[0], data.qpos[1]], measured.numbers()));
        if self.version >= 5 {
            visit_motion(self.version, data, motion, visit);
        }
        let Some([.., forward, ctrl]) = measured.map(Measured::numbers::<4>) else {
            return;
        };
        let name = if self.version >= 5 {
            "reward_forward"
        } else {
            "reward_fwd"
        };
        visit(name, forward);
        visit("reward_ctrl", -ctrl);
        if self.version < 5 {
            visit_motion(self.version, data, motion, visit);
        }
        if matches!(self.version, 3 | 4) {
            visit("forward_reward", forward);
        }
    }
}

/// The registration that all versions share.
const fn swimmer(id: &'static str) -> Registration {
    register::<Swimmer>(id)
        .description("Swim forward with three links.")
        .max_episode_steps(1000)
        .reward_threshold(360.0)
}

gym_core::register!(
    swimmer("Swimmer-v2"),
    swimmer("Swimmer-v3"),
    swimmer("Swimmer-v4"),
    swimmer("Swimmer-v5").clip(clip(3, 60, 240)),
);
