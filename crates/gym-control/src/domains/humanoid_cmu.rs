//! Humanoid of CMU: stand, walk or run, with the skeleton of CMU's motion capture.
//!
//! | | |
//! |---|---|
//! | observation | `joint_angles`, `head_height`, `extremities` (hands and feet in the thorax's frame), `torso_vertical`, `com_velocity`, `velocity` |
//! | action | torques of the 56 joints, as a share of 20 to 120 N m |
//! | reward | standing, upright, with small controls, times a value of the speed |
//! | start | joints and orientation at random, without contacts |
//! | end | never |
//! | limit | 20 s: 1000 steps of 0.02 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default. The last bit of some numbers is numpy's with OpenBLAS's kernel for AVX2, for
//! which `OPENBLAS_CORETYPE=Zen` asks; on other CPUs dm_control's own differs. The sites
//! and sensors of touch, which no observation has, are left out.
//!
//! Source: dm_control 1.0.45, `suite/humanoid_CMU.py`.

use std::borrow::Cow;

use gym_core::Result;
use mujoco_engine::{Data, Model};

use super::avx2::{norm, times};
use super::axis::ZY;
use super::figure::{Figure, Kernels};
use super::{check, config};
use crate::domain::SHAPELY_STANDING;
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

config! { 20.0;
    /// The speed that is rewarded by 1; 0 for standing still.
    #[unit = "m/s"]
    pub speed: f64 = 0.0,
    /// The least height of the head at which the humanoid counts as standing.
    #[unit = "m"]
    pub stand_height: f64 = 1.4,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct HumanoidCmu {
    figure: Figure,
}

impl Domain for HumanoidCmu {
    type Config = Config;

    const NAME: &'static str = "HumanoidCmu";

    const TIMESTEPS: usize = 10;

    fn text(_: &Config) -> Result<Cow<'static, str>> {
        Ok(include_str!("../../models/humanoid_cmu.xml").into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        check("speed", config.speed, 0.0, 1000.0)?;
        check("stand_height", config.stand_height, 0.01, 10.0)?;
        let figure = Figure::new(
            s,
            Kernels { norm, times },
            "thorax",
            ["lhand", "lfoot", "rhand", "rfoot"],
            ZY,
        )?;
        Ok(Self {
            figure: figure.rewarded(config.speed, config.stand_height),
        })
    }
}

impl SimTask for HumanoidCmu {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.draw_apart(Start::joints)
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        self.figure.observe(d, out);
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        self.figure.names(names);
        names.part("velocity").velocities(..);
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        self.figure.reward(d)
    }
}

gym_core::register!(
    register::<HumanoidCmu>(
        "dm_control/humanoid_CMU-stand-v0",
        "Stand still on two legs, with a skeleton of 56 joints."
    )
    .exceptions(SHAPELY_STANDING),
    register::<HumanoidCmu>(
        "dm_control/humanoid_CMU-walk-v0",
        "Walk on two legs, with a skeleton of 56 joints."
    )
    .exceptions(SHAPELY_STANDING)
    .kwargs(r#"{"speed": 1.0}"#),
    register::<HumanoidCmu>(
        "dm_control/humanoid_CMU-run-v0",
        "Run on two legs, with a skeleton of 56 joints."
    )
    .exceptions(SHAPELY_STANDING)
    .kwargs(r#"{"speed": 10.0}"#),
);
