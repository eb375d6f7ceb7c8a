//! Hopper: stand or hop on one leg, in a plane.
//!
//! | | |
//! |---|---|
//! | observation | `position`: height and angle of the torso, angles of the four joints; `velocity` of x and of these; `touch`: logarithms of the forces on toe and heel |
//! | action | torques of waist, hip, knee, ankle, as a share of 30, 40, 30, 10 N m |
//! | reward | 1 with the torso from 0.6 to 2 m above the foot, else 0, times a value of small controls, or of the speed if `speed` is not 0 |
//! | start | joints and the torso's angle uniformly |
//! | end | never |
//! | limit | 20 s: 1000 steps of 0.02 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default.
//!
//! Source: dm_control 1.0.45, `suite/hopper.py`.

use std::borrow::Cow;

use gym_core::{Result, math};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::{check, config};
use crate::domain::{STANDING, clip};
use crate::rewards::{Sigmoid, Tolerance, small_control};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

config! { 20.0;
    /// The speed that is rewarded by 1; 0 for standing.
    #[unit = "m/s"]
    pub speed: f64 = 0.0,
    /// The least height of the torso above the foot at which the hopper counts as standing.
    #[unit = "m"]
    pub stand_height: f64 = 0.6,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Hopper {
    torso: usize,
    foot: usize,
    standing: Tolerance,
    /// The rewarded speed; `None` to stand.
    hopping: Option<Tolerance>,
}

impl Domain for Hopper {
    type Config = Config;

    const NAME: &'static str = "Hopper";

    const TIMESTEPS: usize = 4;

    fn text(_: &Config) -> Result<Cow<'static, str>> {
        Ok(include_str!("../../models/hopper.xml").into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        check("speed", config.speed, 0.0, 1000.0)?;
        check("stand_height", config.stand_height, 0.0, 2.0)?;
        let speed = config.speed;
        let hopping = Tolerance::above(speed).margin(speed / 2.0, Sigmoid::Linear(0.5));
        Ok(Self {
            torso: s.body("torso")?,
            foot: s.body("foot")?,
            standing: Tolerance::within(config.stand_height, 2.0),
            hopping: (speed != 0.0).then_some(hopping),
        })
    }
}

impl SimTask for Hopper {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.joints();
        Ok(())
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xipos, Derived::Sensors(5)])
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        out.vector("position", d.qpos[1..].iter().copied());
        out.vector("velocity", d.qvel.iter().copied());
        out.vector("touch", [3, 4].map(|i| math::numpy_ln_1p(d.sensordata[i])));
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("position").positions(1..);
        names.part("velocity").velocities(..);
        names.part("touch");
        for sensor in [3, 4] {
            names.of("logarithm of 1 N plus", &names.sensor(sensor));
        }
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        let height = d.xipos[self.torso][2] - d.xipos[self.foot][2];
        let well = match &self.hopping {
            Some(hopping) => hopping.of(d.sensordata[0]),
            None => (small_control(&d.ctrl) + 4.0) / 5.0,
        };
        self.standing.of(height) * well
    }
}

gym_core::register!(
    register::<Hopper>(
        "dm_control/hopper-stand-v0",
        "Stand on one leg, in a plane."
    )
    .exceptions(STANDING),
    register::<Hopper>(
        "dm_control/hopper-hop-v0",
        "Hop forward on one leg, in a plane."
    )
    .exceptions(STANDING)
    .kwargs(r#"{"speed": 2.0}"#)
    .clip(clip(2)),
);
