//! Reacher: bring the tip of an arm of two links to a target.
//!
//! | | |
//! |---|---|
//! | observation | cosines and sines of the two angles, position of the target, velocities of the two joints, and the vector from the target to the fingertip in x and y; `Box(10, float64)` (versions 2 and 4: in x, y and z, 11 numbers) |
//! | action | torques of the two joints, as a share of 200 N m; `Box(-1, 1, (2,), float32)` |
//! | reward | minus the distance to the target in m, minus the sum of the squared actions (versions 2 and 4: with the distance before the step) |
//! | start | the target uniformly in a circle of radius 0.2 m; angles disturbed by up to 0.1, velocities by up to 0.005 |
//! | end | never |
//! | limit | 50 steps of 0.02 s |
//!
//! Versions: 4 takes only the camera's arguments; 2 takes only `mujoco`.
//!
//! Differences from Gymnasium: all numbers equal Gymnasium's with the version of MuJoCo that
//! `mujoco` names, for Linux on x86-64. By default that is 4.0; versions 2 and 3, and Pusher-v4,
//! which Gymnasium 1.4.0 refuses to make, keep 3.12.
//!
//! Source: Gymnasium 1.4.0, `envs/mujoco/reacher_v5.py` and `_v4.py`; 0.29.1 for version 2.

use crate::cost::ControlCost;
use crate::noise::uniform_noise;
use crate::{Reacher, clip};
use gym_core::math;
use gym_core::{Array, Registration, Result};
use gym_sim::numpy::norm;
use gym_sim::view::CameraConfig;
use gym_sim::{
    Common, FromArguments, Measured, Measures, Naming, Observation, SimTask, Simulation, Start,
    TaskArguments, Visit, register,
};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

const REACH: f64 = 0.2; // m, how far away the target can be
const ANGLE_NOISE: f64 = 0.1;
const VELOCITY_NOISE: f64 = 0.005;

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The arguments that all tasks share.
        #[flatten]
        pub common: Common = Common::new("reacher.xml", 2, CameraConfig::at([0.0, 0.0, 0.0], 0.92, 90.0, -90.0)),
        /// Cost of a distance of 1 m.
        #[versions = 5..]
        pub reward_dist_weight: f64 = 1.0,
        /// Cost of the squared actions.
        #[versions = 5..]
        pub reward_control_weight: f64 = 1.0,
    }
}

impl TaskArguments for Config {}

/// The task.
#[derive(Clone, Debug)]
pub struct Task {
    config: Config,
    cost: ControlCost,
    version: u32,
    fingertip: usize,
    target: usize,
}

impl Task {
    /// The vector from the target to the fingertip.
    fn offset(&self, data: &Data) -> [f64; 3] {
        let (tip, target) = (data.xpos[self.fingertip], data.xpos[self.target]);
        std::array::from_fn(|k| tip[k] - target[k])
    }
}

impl FromArguments for Task {
    type Config = Config;

    fn new(config: &Config, version: u32, simulation: &Simulation) -> Result<Self> {
        simulation.needs("positions", simulation.model.nq(), 4)?;
        simulation.needs("degrees of freedom", simulation.model.nv(), 2)?;
        let (fingertip, target) = (simulation.body("fingertip")?, simulation.body("target")?);
        let cost = ControlCost::new(config.reward_control_weight, version);
        Ok(Self {
            config: config.clone(),
            cost,
            version,
            fingertip,
            target,
        })
    }
}

impl SimTask for Task {
    fn measures(&self) -> Measures {
        &[("distance", 1), ("ctrl", 1)]
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let (_, data, rng) = start.parts();
        uniform_noise(&mut data.qpos, ANGLE_NOISE, rng);
        let goal = loop {
            let goal = [(); 2].map(|()| rng.uniform(-REACH, REACH));
            if norm(self.version, &goal) < REACH {
                break goal;
            }
        };
        let free = data.qpos.len() - 2;
        data.qpos[free..].copy_from_slice(&goal);
        uniform_noise(&mut data.qvel, VELOCITY_NOISE, rng);
        let free = data.qvel.len() - 2;
        data.qvel[free..].fill(0.0);
        Ok(())
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> Measured {
        let before = norm(self.version, &self.offset(data));
        simulation.step(data, action);
        let measured = if self.version >= 5 {
            norm(self.version, &self.offset(data))
        } else {
            before
        };
        let distance = measured * self.config.reward_dist_weight;
        let ctrl = self.cost.of(action);
        Measured::new(-distance - ctrl, false).with([distance, ctrl])
    }

    fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
        let angles = data.qpos[..2].iter().map(|angle| math::sin_cos(*angle));
        let dimensions = if self.version >= 5 { 2 } else { 3 };
        out.extend(
            (angles.clone().map(|(_, cos)| cos))
                .chain(angles.map(|(sin, _)| sin))
                .chain(data.qpos[2..].iter().copied())
                .chain(data.qvel[..2].iter().copied())
                .chain(self.offset(data).into_iter().take(dimensions)),
        );
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xpos])
    }

    fn names(&self, names: &mut Naming<'_>) {
        for function in ["cosine of", "sine of"] {
            for i in 0..2 {
                names.of(function, &names.position(i));
            }
        }
        names.positions(2..).velocities(..2);
        let axes: &[_] = if self.version >= 5 {
            &["x", "y"]
        } else {
            &["x", "y", "z"]
        };
        names.each(axes, "{} from target to fingertip (m)");
    }

    fn info(&self, _: &Simulation, _: &Data, measured: Option<&Measured>, visit: Visit<'_>) {
        if let Some([distance, ctrl]) = measured.map(Measured::numbers) {
            visit("reward_dist", -distance);
            visit("reward_ctrl", -ctrl);
        }
    }
}

/// The registration that all versions share.
const fn reacher(id: &'static str) -> Registration {
    register::<Reacher>(id)
        .description("Bring the tip of an arm to a target.")
        .max_episode_steps(50)
        .reward_threshold(-3.75)
}

gym_core::register!(
    reacher("Reacher-v2"),
    reacher("Reacher-v4"),
    reacher("Reacher-v5").clip(clip(2, 60, 240)),
);
