//! Humanoid: stand, walk or run.
//!
//! | | |
//! |---|---|
//! | observation | `joint_angles`, `head_height`, `extremities` (hands and feet in the torso's frame), `torso_vertical`, `com_velocity`, `velocity`; if `pure_state`, `position` and `velocity` |
//! | action | torques of the 21 joints, as a share of 20 to 120 N m |
//! | reward | standing, upright, with small controls, times a value of the speed |
//! | start | joints and orientation at random, without contacts |
//! | end | never |
//! | limit | 25 s: 1000 steps of 0.025 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default. The last bit of some numbers is numpy's on a CPU with AVX-512, for which
//! `OPENBLAS_CORETYPE=SkylakeX` asks; on other CPUs dm_control's own differs.
//!
//! Source: dm_control 1.0.45, `suite/humanoid.py`.

use std::borrow::Cow;

use gym_core::Result;
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::axis::ZZ;
use super::figure::{Figure, Kernels};
use super::{check, config, norm, times};
use crate::domain::{STANDING, clip};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

config! { 25.0;
    /// The speed that is rewarded by 1; 0 for standing still.
    #[unit = "m/s"]
    pub speed: f64 = 0.0,
    /// The least height of the head at which the humanoid counts as standing.
    #[unit = "m"]
    pub stand_height: f64 = 1.4,
    /// Whether positions and velocities alone are observed.
    pub pure_state: bool = false,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Humanoid {
    figure: Figure,
    pure_state: bool,
}

impl Domain for Humanoid {
    type Config = Config;

    const NAME: &'static str = "Humanoid";

    const TIMESTEPS: usize = 5;

    fn text(_: &Config) -> Result<Cow<'static, str>> {
        Ok(include_str!("../../models/humanoid.xml").into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        check("speed", config.speed, 0.0, 1000.0)?;
        check("stand_height", config.stand_height, 0.01, 10.0)?;
        let limbs = ["left_hand", "left_foot", "right_hand", "right_foot"];
        let figure = Figure::new(s, Kernels { norm, times }, "torso", limbs, ZZ)?;
        Ok(Self {
            figure: figure.rewarded(config.speed, config.stand_height),
            pure_state: config.pure_state,
        })
    }
}

impl SimTask for Humanoid {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.draw_apart(Start::joints)
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xpos, Derived::Xmat, Derived::Sensors(3)])
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        if self.pure_state {
            out.vector("position", d.qpos.iter().copied());
        } else {
            self.figure.observe(d, out);
        }
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        if self.pure_state {
            names.part("position").positions(..);
        } else {
            self.figure.names(names);
        }
        names.part("velocity").velocities(..);
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        self.figure.reward(d)
    }
}

gym_core::register!(
    register::<Humanoid>("dm_control/humanoid-stand-v0", "Stand still on two legs.")
        .exceptions(STANDING),
    register::<Humanoid>("dm_control/humanoid-walk-v0", "Walk on two legs.")
        .exceptions(STANDING)
        .kwargs(r#"{"speed": 1.0}"#),
    register::<Humanoid>("dm_control/humanoid-run-v0", "Run on two legs.")
        .exceptions(STANDING)
        .kwargs(r#"{"speed": 10.0}"#)
        .clip(clip(2)),
    register::<Humanoid>(
        "dm_control/humanoid-run_pure_state-v0",
        "Run on two legs, from positions and velocities alone."
    )
    .exceptions(STANDING)
    .kwargs(r#"{"speed": 10.0, "pure_state": true}"#),
);
