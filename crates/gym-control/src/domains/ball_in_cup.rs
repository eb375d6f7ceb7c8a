//! Ball in cup: swing a ball on a string into a cup.
//!
//! | | |
//! |---|---|
//! | observation | `position` and `velocity` of cup and ball, in x and z |
//! | action | forces on the cup in x and z, as a share of 5 N |
//! | reward | 1 with the ball in the cup, else 0 |
//! | start | the ball at a random place without contacts |
//! | end | never |
//! | limit | 20 s: 1000 steps of 0.02 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default.
//!
//! Source: dm_control 1.0.45, `suite/ball_in_cup.py`.

use std::borrow::Cow;

use gym_core::Result;
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::config;
use crate::domain::clip;
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

config! { 20.0; }

/// The domain.
#[derive(Clone, Debug)]
pub struct BallInCup {
    ball: usize,
    target: usize,
    /// The largest distance of the ball's centre from the target's, in x and z.
    within: [f64; 2],
}

impl Domain for BallInCup {
    type Config = Config;

    const NAME: &'static str = "BallInCup";

    const TIMESTEPS: usize = 10;

    fn text(_: &Config) -> Result<Cow<'static, str>> {
        Ok(include_str!("../../models/ball_in_cup.xml").into())
    }

    fn new(_: &Config, s: &Simulation) -> Result<Self> {
        let target = s.site("target")?;
        let geom = s.geom("ball")?;
        Ok(Self {
            ball: s.body("ball")?,
            target,
            within: [0, 2].map(|k| s.model.site_size[target][k] - s.model.geom_size[geom][0]),
        })
    }
}

impl SimTask for BallInCup {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.draw_apart(|start| {
            start.data.qpos[2] = start.uniform(-0.2, 0.2);
            start.data.qpos[3] = start.uniform(0.2, 0.5);
        })
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        out.vector("position", d.qpos.iter().copied());
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xpos, Derived::SiteXpos])
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("position").positions(..);
        names.part("velocity").velocities(..);
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        let (target, ball) = (d.site_xpos[self.target], d.xpos[self.ball]);
        let near = |(axis, within): (usize, f64)| (target[axis] - ball[axis]).abs() < within;
        f64::from([0, 2].into_iter().zip(self.within).all(near))
    }
}

gym_core::register!(
    register::<BallInCup>(
        "dm_control/ball_in_cup-catch-v0",
        "Swing a ball on a string into a cup."
    )
    .clip(clip(2))
);
