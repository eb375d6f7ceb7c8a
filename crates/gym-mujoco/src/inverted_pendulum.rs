//! InvertedPendulum: keep a pole upright on a cart.
//!
//! | | |
//! |---|---|
//! | observation | position of the cart, angle of the pole, and their velocities; `Box(4, float64)` |
//! | action | force on the cart, as a share of 100 N; `Box(-3, 3, (1,), float32)` |
//! | reward | 1 while the pole stands (versions 2 and 4: 1 always) |
//! | start | upright, positions and velocities disturbed uniformly by up to 0.01 |
//! | end | terminated when the pole leans by more than 0.2 rad |
//! | limit | 1000 steps of 0.04 s |
//!
//! Versions: 4 takes only `mujoco` and the camera's arguments, 2 only `mujoco`; neither has entries in
//! `info`.
//!
//! Differences from Gymnasium: all numbers equal Gymnasium's with the version of MuJoCo that
//! `mujoco` names, for Linux on x86-64. By default that is 4.0; versions 2 and 3, and Pusher-v4,
//! which Gymnasium 1.4.0 refuses to make, keep 3.12.
//!
//! Source: Gymnasium 1.4.0, `envs/mujoco/inverted_pendulum_v5.py` and `_v4.py`; 0.29.1 for version
//! 2.

use crate::noise::uniform_noise;
use crate::{InvertedPendulum, clip};
use gym_core::{Array, Registration, Result};
use gym_sim::view::CameraConfig;
use gym_sim::{
    Common, FromArguments, Measured, Measures, Naming, Observation, SimTask, Simulation, Start,
    TaskArguments, Visit, register,
};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

const MAX_ANGLE: f64 = 0.2; // rad

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The arguments that all tasks share.
        #[flatten]
        pub common: Common = Common::new("inverted_pendulum.xml", 2, CameraConfig::at([0.0, 0.0, 0.15], 2.0, 90.0, -12.0)),
        /// Size of the disturbance at the start.
        #[versions = 5..]
        pub reset_noise_scale: f64 = 0.01,
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
        simulation.needs("positions", simulation.model.nq(), 2)?;
        Ok(Self {
            config: config.clone(),
            version,
        })
    }
}

impl SimTask for Task {
    fn measures(&self) -> Measures {
        &[("survive", 1)]
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
        simulation.step(data, action);
        let finite = data.qpos.iter().chain(&data.qvel).all(|x| x.is_finite());
        let terminated = !finite || data.qpos[1].abs() > MAX_ANGLE;
        let survive = f64::from(!terminated);
        let reward = if self.version >= 5 { survive } else { 1.0 };
        Measured::new(reward, terminated).with([survive])
    }

    fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
        out.extend(data.qpos.iter().chain(&data.qvel).copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.positions(..).velocities(..);
    }

    fn info(&self, _: &Simulation, _: &Data, measured: Option<&Measured>, visit: Visit<'_>) {
        if let Some([survive]) = measured.map(Measured::numbers)
            && self.version >= 5
        {
            visit("reward_survive", survive);
        }
    }
}

/// The registration that all versions share.
const fn inverted_pendulum(id: &'static str) -> Registration {
    register::<InvertedPendulum>(id)
        .description("Keep a pole upright on a cart.")
        .max_episode_steps(1000)
        .reward_threshold(950.0)
}

gym_core::register!(
    inverted_pendulum("InvertedPendulum-v2"),
    inverted_pendulum("InvertedPendulum-v4"),
    inverted_pendulum("InvertedPendulum-v5").clip(clip(1, 40, 240)),
);
