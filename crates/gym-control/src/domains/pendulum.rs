//! Pendulum: swing up, with a torque too small to do it at once.
//!
//! | | |
//! |---|---|
//! | observation | `orientation`: cosine and sine of the angle; `velocity` |
//! | action | torque of the hinge in N m |
//! | reward | 1 within 8 degrees of the vertical, else 0 |
//! | start | the angle uniformly |
//! | end | never |
//! | limit | 20 s: 1000 steps of 0.02 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default.
//!
//! Source: dm_control 1.0.45, `suite/pendulum.py`.

use std::borrow::Cow;
use std::f64::consts::PI;

use gym_core::keys::json;
use gym_core::{Keys, Result};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::axis::{XZ, ZZ};
use super::config;
use crate::domain::clip;
use crate::rewards::Tolerance;
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

/// The pole is upright if the cosine of its angle is at least the cosine of 8 degrees.
const UPRIGHT: Tolerance = Tolerance::within(0.9902680687415704, 1.0);

config! { 20.0; }

/// The domain.
#[derive(Clone, Debug)]
pub struct Pendulum {
    pole: usize,
}

impl Domain for Pendulum {
    type Config = Config;

    const NAME: &'static str = "SwingUp";

    fn text(_: &Config) -> Result<Cow<'static, str>> {
        Ok(include_str!("../../models/pendulum.xml").into())
    }

    fn new(_: &Config, s: &Simulation) -> Result<Self> {
        let pole = s.body("pole")?;
        Ok(Self { pole })
    }
}

impl SimTask for Pendulum {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.data.qpos[0] = start.uniform(-PI, PI);
        Ok(())
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xmat])
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        out.vector("orientation", [ZZ, XZ].map(|axis| d.xmat[self.pole][axis]));
        out.vector("velocity", [d.qvel[0]]);
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("orientation");
        names.each(&["cosine", "sine"], "{} of angle of pole from the vertical");
        names.part("velocity").velocities(..1);
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        UPRIGHT.of(d.xmat[self.pole][ZZ])
    }
}

gym_core::register!(
    register::<Pendulum>(
        "dm_control/pendulum-swingup-v0",
        "Swing a pendulum up, and balance it."
    )
    .keys(|_| Keys::new(json!({"Left": [-1.0], "Right": [1.0]})).idle(json!([0.0])))
    .clip(clip(2)),
);
