//! Pusher: push an object to a goal, with the fork of an arm of seven joints.
//!
//! | | |
//! |---|---|
//! | observation | angles and velocities of the seven joints, positions of fork, object and goal; `Box(23, float64)` |
//! | action | torques of the seven joints in N m; `Box(-2, 2, (7,), float32)` |
//! | reward | minus the distance from object to goal in m, minus 0.5 times the distance from object to fork in m, minus 0.1 times the sum of the squared actions (versions 2 and 4: distances before the step) |
//! | start | the object at a random place at least 0.17 m from the goal; velocities of the arm disturbed by up to 0.005 |
//! | end | never |
//! | limit | 100 steps of 0.05 s |
//!
//! Versions: 4 takes only `mujoco` and the camera's arguments, 2 only `mujoco`; both have a lighter object
//! with a ball inside, and `info` has the cost of actions without its weight.
//!
//! Differences from Gymnasium: all numbers equal Gymnasium's with the version of MuJoCo that
//! `mujoco` names, for Linux on x86-64. By default that is 4.0; versions 2 and 3, and Pusher-v4,
//! which Gymnasium 1.4.0 refuses to make, keep 3.12.
//!
//! Source: Gymnasium 1.4.0, `envs/mujoco/pusher_v5.py` and `_v4.py`; 0.29.1 for version 2.

use crate::cost::ControlCost;
use crate::noise::uniform_noise;
use crate::{Pusher, clip};
use gym_core::{Array, Registration, Result};
use gym_sim::numpy::norm;
use gym_sim::view::CameraConfig;
use gym_sim::{
    Common, FromArguments, Measured, Measures, Naming, Observation, SimTask, Simulation, Start,
    TaskArguments, Visit, register,
};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model, Revision};

const ARM: usize = 7; // joints
const LEAST_DISTANCE: f64 = 0.17; // m, from the object to the goal at the start
const VELOCITY_NOISE: f64 = 0.005;

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The arguments that all tasks share.
        #[flatten]
        pub common: Common = Common::new("pusher_v5.xml", 5, CameraConfig::at([0.4, -0.32, -0.15], 1.95, -112.0, -40.0)),
        /// Cost of a distance of 1 m between fork and object.
        #[versions = 5..]
        pub reward_near_weight: f64 = 0.5,
        /// Cost of a distance of 1 m between object and goal.
        #[versions = 5..]
        pub reward_dist_weight: f64 = 1.0,
        /// Cost of the squared actions.
        #[versions = 5..]
        pub reward_control_weight: f64 = 0.1,
    }
}

impl TaskArguments for Config {
    fn defaults(version: u32) -> Self {
        let mut config = Self::default();
        if version < 5 {
            config.common.xml_file = "pusher.xml".to_owned();
            config.common.mujoco = Revision::V3_12.into();
        }
        config
    }
}

/// The task.
#[derive(Clone, Debug)]
pub struct Task {
    config: Config,
    cost: ControlCost,
    version: u32,
    tips: usize,
    object: usize,
    goal: usize,
}

impl Task {
    /// Distances from the object to the fork, and to the goal.
    fn distances(&self, data: &Data) -> (f64, f64) {
        let object = data.xpos[self.object];
        let to = |body: usize| {
            let apart: [f64; 3] = std::array::from_fn(|k| object[k] - data.xpos[body][k]);
            norm(self.version, &apart)
        };
        (to(self.tips), to(self.goal))
    }
}

impl FromArguments for Task {
    type Config = Config;

    fn new(config: &Config, version: u32, simulation: &Simulation) -> Result<Self> {
        simulation.needs("positions", simulation.model.nq(), ARM + 4)?;
        simulation.needs("degrees of freedom", simulation.model.nv(), ARM + 4)?;
        let [tips, object, goal] = ["tips_arm", "object", "goal"].map(|name| simulation.body(name));
        let cost = ControlCost::new(config.reward_control_weight, version);
        Ok(Self {
            config: config.clone(),
            cost,
            version,
            tips: tips?,
            object: object?,
            goal: goal?,
        })
    }
}

impl SimTask for Task {
    fn measures(&self) -> Measures {
        &[("near", 1), ("distance", 1), ("ctrl", 1)]
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let (_, data, rng) = start.parts();
        let place = loop {
            let place = [rng.uniform(-0.3, 0.0), rng.uniform(-0.2, 0.2)];
            if norm(self.version, &place) > LEAST_DISTANCE {
                break place;
            }
        };
        let free = data.qpos.len() - 4;
        data.qpos[free..free + 2].copy_from_slice(&place);
        data.qpos[free + 2..].fill(0.0);
        uniform_noise(&mut data.qvel, VELOCITY_NOISE, rng);
        let free = data.qvel.len() - 4;
        data.qvel[free..].fill(0.0);
        Ok(())
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> Measured {
        let before = self.distances(data);
        simulation.step(data, action);
        let (near, distance) = if self.version >= 5 {
            self.distances(data)
        } else {
            before
        };
        let near = near * self.config.reward_near_weight;
        let distance = distance * self.config.reward_dist_weight;
        let ctrl = self.cost.of(action);
        let reward = -distance - ctrl - near;
        // before version 5, `info` has the cost without the weight
        let told = if self.version >= 5 {
            ctrl
        } else {
            ControlCost::new(1.0, self.version).of(action)
        };
        Measured::new(reward, false).with([near, distance, told])
    }

    fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
        let bodies = [self.tips, self.object, self.goal].map(|body| data.xpos[body]);
        out.extend(
            (data.qpos[..ARM].iter().chain(&data.qvel[..ARM]).copied())
                .chain(bodies.into_iter().flatten()),
        );
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xpos])
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.positions(..ARM).velocities(..ARM);
        for body in [self.tips, self.object, self.goal] {
            let body = names.body(body);
            names.xyz(&format!("{{}} of {body} (m)"));
        }
    }

    fn info(&self, _: &Simulation, _: &Data, measured: Option<&Measured>, visit: Visit<'_>) {
        let Some([near, distance, ctrl]) = measured.map(Measured::numbers) else {
            return;
        };
        visit("reward_dist", -distance);
        visit("reward_ctrl", -ctrl);
        if self.version >= 5 {
            visit("reward_near", -near);
        }
    }
}

/// The registration that all versions share.
const fn pusher(id: &'static str) -> Registration {
    register::<Pusher>(id)
        .description("Push an object to a goal with an arm.")
        .max_episode_steps(100)
        .reward_threshold(0.0)
}

gym_core::register!(
    pusher("Pusher-v2"),
    pusher("Pusher-v4"),
    pusher("Pusher-v5").clip(clip(2, 60, 240)),
);
