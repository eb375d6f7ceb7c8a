//! InvertedDoublePendulum: keep two poles, one on top of the other, upright on a cart.
//!
//! | | |
//! |---|---|
//! | observation | position of the cart, sines and cosines of the two angles, three velocities and the force of the rail's end on the cart, these clipped to 10; `Box(9, float64)` (versions 2 and 4: three such forces, 11 numbers) |
//! | action | force on the cart, as a share of 500 N; `Box(-1, 1, (1,), float32)` |
//! | reward | 10, minus penalties for a tip away from its highest position and for fast joints (version 5: the 10 only while the poles stand) |
//! | start | upright, positions disturbed uniformly by up to 0.1, velocities normally with deviation 0.1 |
//! | end | terminated when the tip is at 1 m or below; the poles reach 1.2 m |
//! | limit | 1000 steps of 0.05 s |
//!
//! Versions: 4 takes only `mujoco` and the camera's arguments, 2 only `mujoco`; neither has entries in
//! `info`.
//!
//! Differences from Gymnasium: all numbers equal Gymnasium's with the version of MuJoCo that
//! `mujoco` names, for Linux on x86-64. By default that is 4.0; versions 2 and 3, and Pusher-v4,
//! which Gymnasium 1.4.0 refuses to make, keep 3.12.
//!
//! Source: Gymnasium 1.4.0, `envs/mujoco/inverted_double_pendulum_v5.py` and `_v4.py`; 0.29.1 for
//! version 2.

use crate::noise::{normal_noise, uniform_noise};
use crate::{InvertedDoublePendulum, clip};
use gym_core::math;
use gym_core::{Array, Registration, Result};
use gym_sim::view::CameraConfig;
use gym_sim::{
    Common, FromArguments, Measured, Measures, Naming, Observation, SimTask, Simulation, Start,
    TaskArguments, Visit, register,
};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

const LIMIT: f64 = 10.0; // of observed velocities and forces

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The arguments that all tasks share.
        #[flatten]
        pub common: Common = Common::new("inverted_double_pendulum.xml", 5, CameraConfig::at([0.0, 0.0, 0.45], 2.9, 90.0, -8.0)),
        /// Reward for a step that does not end the task.
        #[versions = 5..]
        pub healthy_reward: f64 = 10.0,
        /// Size of the disturbance at the start.
        #[versions = 5..]
        pub reset_noise_scale: f64 = 0.1,
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
        simulation.needs("degrees of freedom", simulation.model.nv(), 3)?;
        simulation.needs("sites", simulation.model.nsite(), 1)?;
        Ok(Self {
            config: config.clone(),
            version,
        })
    }
}

impl SimTask for Task {
    fn measures(&self) -> Measures {
        &[("survive", 1), ("distance", 1), ("velocity", 1)]
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::SiteXpos, Derived::QfrcConstraint])
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let (_, data, rng) = start.parts();
        let scale = self.config.reset_noise_scale;
        uniform_noise(&mut data.qpos, scale, rng);
        normal_noise(&mut data.qvel, scale, rng);
        Ok(())
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> Measured {
        simulation.step(data, action);
        let [x, _, y] = data.site_xpos[0];
        let terminated = y <= 1.0;
        let (v1, v2) = (data.qvel[1], data.qvel[2]);
        let square = |x: f64| math::pow(x, 2.0);
        let distance = 0.01 * square(x) + square(y - 2.0);
        let velocity = 1e-3 * square(v1) + 5e-3 * square(v2);
        let alive = self.version < 5 || !terminated;
        let survive = self.config.healthy_reward * f64::from(alive);
        Measured::new(survive - distance - velocity, terminated).with([survive, distance, velocity])
    }

    fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
        let forces = if self.version >= 5 {
            1
        } else {
            data.qfrc_constraint.len()
        };
        let angles = &data.qpos[1..];
        let clipped = data.qvel.iter().chain(&data.qfrc_constraint[..forces]);
        let sines = angles.iter().map(|angle| math::sin_cos(*angle).0);
        let cosines = angles.iter().map(|angle| math::sin_cos(*angle).1);
        let clipped = clipped.map(|x| x.clamp(-LIMIT, LIMIT));
        out.extend(
            data.qpos[..1]
                .iter()
                .copied()
                .chain(sines)
                .chain(cosines)
                .chain(clipped),
        );
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.positions(..1);
        for function in ["sine of", "cosine of"] {
            for i in 1..names.model().nq() {
                names.of(function, &names.position(i));
            }
        }
        names.velocities(..);
        let forces = if self.version >= 5 { 1 } else { usize::MAX };
        names.forces("constraint", ..forces);
    }

    fn info(&self, _: &Simulation, _: &Data, measured: Option<&Measured>, visit: Visit<'_>) {
        if let Some([survive, distance, velocity]) = measured.map(Measured::numbers)
            && self.version >= 5
        {
            visit("reward_survive", survive);
            visit("distance_penalty", -distance);
            visit("velocity_penalty", -velocity);
        }
    }
}

/// The registration that all versions share.
const fn inverted_double_pendulum(id: &'static str) -> Registration {
    register::<InvertedDoublePendulum>(id)
        .description("Keep two poles, one on the other, upright on a cart.")
        .max_episode_steps(1000)
        .reward_threshold(9100.0)
}

gym_core::register!(
    inverted_double_pendulum("InvertedDoublePendulum-v2"),
    inverted_double_pendulum("InvertedDoublePendulum-v4"),
    inverted_double_pendulum("InvertedDoublePendulum-v5").clip(clip(1, 40, 240)),
);
