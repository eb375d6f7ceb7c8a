//! Cheetah: run on two legs, in a plane.
//!
//! | | |
//! |---|---|
//! | observation | `position`: height and angle of the torso, angles of the six joints; `velocity` of x and of these |
//! | action | torques of back thigh, shin, foot, front thigh, shin, foot, as a share of 120, 90, 60, 90, 60, 30 N m |
//! | reward | the speed of the centre of mass as a share of 10 m/s, from 0 to 1 |
//! | start | joints uniformly within their limits, and 200 timesteps later |
//! | end | never |
//! | limit | 10 s: 1000 steps of 0.01 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default.
//!
//! Source: dm_control 1.0.45, `suite/cheetah.py`.

use std::borrow::Cow;

use gym_core::Result;
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::{check, config};
use crate::domain::clip;
use crate::rewards::{Sigmoid, Tolerance};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

config! { 10.0;
    /// The speed that is rewarded by 1.
    #[unit = "m/s"]
    pub speed: f64 = 10.0,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Cheetah {
    fast: Tolerance,
}

impl Domain for Cheetah {
    type Config = Config;

    const NAME: &'static str = "Cheetah";

    fn text(_: &Config) -> Result<Cow<'static, str>> {
        Ok(include_str!("../../models/cheetah.xml").into())
    }

    fn new(config: &Config, _: &Simulation) -> Result<Self> {
        check("speed", config.speed, 0.01, 1000.0)?;
        let fast = Tolerance::above(config.speed).margin(config.speed, Sigmoid::Linear(0.0));
        Ok(Self { fast })
    }
}

impl SimTask for Cheetah {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        for joint in 0..start.model().njnt() {
            if start.model().jnt_limited[joint] {
                let [low, high] = start.model().jnt_range[joint];
                start.data.qpos[joint] = start.uniform(low, high);
            }
        }
        start.step(200);
        start.data.time = 0.0;
        Ok(())
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Sensors(3)])
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        out.vector("position", d.qpos[1..].iter().copied());
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("position").positions(1..);
        names.part("velocity").velocities(..);
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        self.fast.of(d.sensordata[0])
    }
}

gym_core::register!(
    register::<Cheetah>("dm_control/cheetah-run-v0", "Run on two legs, in a plane.").clip(clip(4))
);
