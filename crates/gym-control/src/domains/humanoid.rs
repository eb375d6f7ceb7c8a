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

use super::axis::{ZX, ZZ};
use super::{check, config, minus, norm, times};
use crate::domain::{STANDING, clip};
use crate::rewards::{Sigmoid, Tolerance, mean, small_control};
use crate::{Domain, register};
use gym_sim::{Observation, SimTask, Simulation, Start};

const UPRIGHT: Tolerance = Tolerance::above(0.9).margin(1.9, Sigmoid::Linear(0.0));
const STILL: Tolerance = Tolerance::within(0.0, 0.0).margin(2.0, Sigmoid::Gaussian);

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
    torso: usize,
    head: usize,
    limbs: [usize; 4],
    standing: Tolerance,
    /// The rewarded speed; `None` to stand.
    going: Option<Tolerance>,
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
        let (speed, height) = (config.speed, config.stand_height);
        let going = Tolerance::above(speed).margin(speed, Sigmoid::Linear(0.0));
        Ok(Self {
            torso: s.body("torso")?,
            head: s.body("head")?,
            limbs: [
                s.body("left_hand")?,
                s.body("left_foot")?,
                s.body("right_hand")?,
                s.body("right_foot")?,
            ],
            standing: Tolerance::above(height).margin(height / 4.0, Sigmoid::Gaussian),
            going: (speed != 0.0).then_some(going),
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
            let (pos, mat) = (d.xpos[self.torso], &d.xmat[self.torso]);
            out.vector("joint_angles", d.qpos[7..].iter().copied());
            out.scalar("head_height", d.xpos[self.head][2]);
            let limbs = self.limbs.map(|limb| times(minus(d.xpos[limb], pos), mat));
            out.vector("extremities", limbs.into_iter().flatten());
            out.vector("torso_vertical", mat[ZX..].iter().copied());
            out.vector("com_velocity", d.sensordata[..3].iter().copied());
        }
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        let standing = self.standing.of(d.xpos[self.head][2]);
        let stand = standing * UPRIGHT.of(d.xmat[self.torso][ZZ]);
        let small_control = (4.0 + small_control(&d.ctrl)) / 5.0;
        let velocity = [d.sensordata[0], d.sensordata[1]];
        let well = match &self.going {
            None => mean(&velocity, |v| STILL.of_element(*v)),
            Some(going) => (5.0 * going.of(norm(velocity)) + 1.0) / 6.0,
        };
        small_control * stand * well
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
