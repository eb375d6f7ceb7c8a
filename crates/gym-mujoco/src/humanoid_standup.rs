//! HumanoidStandup: stand up, from lying on the back.
//!
//! | | |
//! |---|---|
//! | observation | as Humanoid's; `Box(348, float64)` (before version 5: 376 numbers) |
//! | action | torques of the 17 joints, as a share of 25 to 300 N m; `Box(-0.4, 0.4, (17,), float32)` |
//! | reward | height of the torso in m divided by 0.003, plus 1, less 0.1 times the sum of the squared actions, less 5e-7 times the sum of the squared contact forces, at most 10 |
//! | start | lying, positions and velocities disturbed uniformly by up to 0.01 |
//! | end | never |
//! | limit | 1000 steps of 0.015 s |
//!
//! Versions: 4 takes only the camera's arguments; 2 takes only `mujoco`.
//!
//! Differences from Gymnasium: all numbers equal Gymnasium's with the version of MuJoCo that
//! `mujoco` names, for Linux on x86-64. By default that is 4.0; versions 2 and 3, and Pusher-v4,
//! which Gymnasium 1.4.0 refuses to make, keep 3.12. The default camera follows the torso.
//!
//! Source: Gymnasium 1.4.0, `envs/mujoco/humanoidstandup_v5.py` and `_v4.py`; 0.29.1 for version 2.

use crate::humanoid::{Observed, READS};
use crate::noise::uniform_noise;
use crate::range::Range;
use crate::{HumanoidStandup, clip};
use gym_core::{Array, Registration, Result};
use gym_sim::numpy::sum_of_squares;
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
        #[flatten]
        pub common: Common = Common::new("humanoidstandup.xml", 5, CameraConfig::following(1, 3.6, 120.0, -20.0, 0.5)),
        /// Has no effect, as in Gymnasium.
        #[versions = 5..]
        pub uph_cost_weight: f64 = 1.0,
        /// Cost of the squared actions.
        #[versions = 5..]
        pub ctrl_cost_weight: f64 = 0.1,
        /// Cost of the squared contact forces.
        #[versions = 5..]
        pub impact_cost_weight: f64 = 5e-7,
        /// The range to which the cost of contacts is clipped.
        #[versions = 5..]
        pub impact_cost_range: Range = Range::new(f64::NEG_INFINITY, 10.0),
        /// Size of the disturbance at the start.
        #[versions = 5..]
        pub reset_noise_scale: f64 = 1e-2,
        /// The parts of the observation.
        #[flatten]
        pub observed: Observed,
    }
}

impl TaskArguments for Config {}

/// The task.
#[derive(Clone, Debug)]
pub struct Task {
    config: Config,
    version: u32,
}

impl FromArguments for Task {
    type Config = Config;

    fn new(config: &Config, version: u32, simulation: &Simulation) -> Result<Self> {
        simulation.needs("positions", simulation.model.nq(), 3)?;
        Ok(Self {
            config: config.clone(),
            version,
        })
    }
}

impl SimTask for Task {
    fn measures(&self) -> Measures {
        &[("up", 1), ("ctrl", 1), ("impact", 1)]
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
        simulation.step(data, action);
        let up = data.qpos[2] / simulation.model.opt.timestep;
        let ctrl = self.config.ctrl_cost_weight * sum_of_squares(data.ctrl.len(), |i| data.ctrl[i]);
        let forces = data.cfrc_ext.as_flattened();
        let impact = self.config.impact_cost_weight * sum_of_squares(forces.len(), |i| forces[i]);
        let impact = self.config.impact_cost_range.clip(impact);
        Measured::new(up - ctrl - impact + 1.0, false).with([up, ctrl, impact])
    }

    fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
        out.extend(self.config.observed.numbers(self.version, data));
    }

    fn names(&self, names: &mut Naming<'_>) {
        self.config.observed.names(self.version, names);
    }

    fn info(
        &self,
        simulation: &Simulation,
        data: &Data,
        measured: Option<&Measured>,
        visit: Visit<'_>,
    ) {
        if self.version >= 5 {
            visit("x_position", data.qpos[0]);
            visit("y_position", data.qpos[1]);
            let height = data.qpos[2] - simulation.initial_qpos()[2];
            visit("z_distance_from_origin", height);
        }
        if let Some([up, ctrl, impact]) = measured.map(Measured::numbers) {
            visit("reward_linup", up);
            visit("reward_quadctrl", -ctrl);
            visit("reward_impact", -impact);
        }
    }

    fn tendons_follow(&self) -> Option<&'static str> {
        (self.version >= 5).then_some("z_distance_from_origin")
    }
}

/// The registration that all versions share.
const fn humanoid_standup(id: &'static str) -> Registration {
    register::<HumanoidStandup>(id)
        .description("Stand up, from lying on the back.")
        .max_episode_steps(1000)
}

gym_core::register!(
    humanoid_standup("HumanoidStandup-v2"),
    humanoid_standup("HumanoidStandup-v4"),
    humanoid_standup("HumanoidStandup-v5")
        .exceptions(&[(
            "arguments-matter.uph_cost_weight",
            "it has no effect, as in Gymnasium"
        )])
        .clip(clip(3, 40, 200)),
);
