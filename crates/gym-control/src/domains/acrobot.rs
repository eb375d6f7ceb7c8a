//! Acrobot: swing up an arm of two links, driven at the elbow.
//!
//! | | |
//! |---|---|
//! | observation | `orientations`: sines and cosines of both links against the vertical; `velocity` of both joints |
//! | action | torque of the elbow, as a share of 2 N m |
//! | reward | 1 with the tip within 0.2 m of the target, falling to 0.1 at 1 m from there; 1 or 0 if `sparse` |
//! | start | angles uniformly |
//! | end | never |
//! | limit | 10 s: 1000 steps of 0.01 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default. The last bit of some numbers is numpy's on a CPU with AVX-512, for which
//! `OPENBLAS_CORETYPE=SkylakeX` asks; on other CPUs dm_control's own differs.
//!
//! Source: dm_control 1.0.45, `suite/acrobot.py`.

use std::borrow::Cow;
use std::f64::consts::PI;

use gym_core::Result;
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::axis::{XZ, ZZ};
use super::{config, minus, norm};
use crate::domain::clip;
use crate::rewards::{Sigmoid, Tolerance};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

config! { 10.0;
    /// Whether the reward is sparse: 1 in the target, otherwise 0.
    pub sparse: bool = false,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Acrobot {
    arms: [usize; 2],
    tip: usize,
    target: usize,
    near: Tolerance,
}

impl Domain for Acrobot {
    type Config = Config;

    const NAME: &'static str = "Acrobot";

    fn text(_: &Config) -> Result<Cow<'static, str>> {
        Ok(include_str!("../../models/acrobot.xml").into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        let target = s.site("target")?;
        let margin = if config.sparse { 0.0 } else { 1.0 };
        Ok(Self {
            arms: [s.body("upper_arm")?, s.body("lower_arm")?],
            tip: s.site("tip")?,
            target,
            near: Tolerance::within(0.0, s.model.site_size[target][0])
                .margin(margin, Sigmoid::Gaussian),
        })
    }
}

impl SimTask for Acrobot {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        for joint in 0..2 {
            start.data.qpos[joint] = start.uniform(-PI, PI);
        }
        Ok(())
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xmat, Derived::SiteXpos])
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        let part = |axis: usize| self.arms.map(|arm| d.xmat[arm][axis]);
        out.vector("orientations", part(XZ).into_iter().chain(part(ZZ)));
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("orientations");
        for function in ["sine", "cosine"] {
            for arm in self.arms {
                let arm = names.body(arm);
                names.add(format!("{function} of angle of {arm} from the vertical"));
            }
        }
        names.part("velocity").velocities(..);
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        self.near
            .of(norm(minus(d.site_xpos[self.target], d.site_xpos[self.tip])))
    }
}

gym_core::register!(
    register::<Acrobot>(
        "dm_control/acrobot-swingup-v0",
        "Swing an arm up by its elbow, and balance it."
    )
    .clip(clip(5)),
    register::<Acrobot>(
        "dm_control/acrobot-swingup_sparse-v0",
        "Swing an arm up by its elbow; only the goal is rewarded."
    )
    .kwargs(r#"{"sparse": true}"#),
);
