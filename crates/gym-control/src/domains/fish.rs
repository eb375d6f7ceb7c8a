//! Fish: stay upright, or swim to a target.
//!
//! | | |
//! |---|---|
//! | observation | `joint_angles`; `upright`: cosine of the torso's inclination; `target` from the mouth, in its frame (to swim); `velocity` |
//! | action | angles that tail and fins are driven to, in rad |
//! | reward | a value of the uprightness; to swim, 7/8 for the mouth in the target, 1/8 for uprightness |
//! | start | orientation and joints at random, and the target |
//! | end | never |
//! | limit | 40 s: 1000 steps of 0.04 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default. The last bit of some numbers is numpy's on a CPU with AVX-512, for which
//! `OPENBLAS_CORETYPE=SkylakeX` asks; on other CPUs dm_control's own differs.
//!
//! Source: dm_control 1.0.45, `suite/fish.py`.

use std::borrow::Cow;

use gym_core::Result;
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::axis::ZZ;
use super::{config, minus, norm, times};
use crate::domain::clip;
use crate::rewards::{Sigmoid, Tolerance};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, Rng, SimTask, Simulation, Start};

const UPRIGHT: Tolerance = Tolerance::within(1.0, 1.0).margin(1.0, Sigmoid::Gaussian);
/// The indices of the joints after the root in `qpos`. In `qvel`, each index is one lower.
const JOINTS: std::ops::Range<usize> = 7..14;

config! { 40.0;
    /// Whether there is a target to swim to.
    pub swim: bool = false,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Fish {
    swim: bool,
    torso: usize,
    mouth: usize,
    target: usize,
    near: Tolerance,
}

impl Fish {
    fn to_target(&self, d: &Data) -> [f64; 3] {
        let to = minus(d.geom_xpos[self.target], d.geom_xpos[self.mouth]);
        times(to, &d.geom_xmat[self.mouth])
    }
}

impl Domain for Fish {
    type Config = Config;

    const NAME: &'static str = "Fish";

    const TIMESTEPS: usize = 10;

    fn text(config: &Config) -> Result<Cow<'static, str>> {
        let look = if config.swim {
            r#"material="goal""#
        } else {
            r#"rgba="0 0 0 0""#
        };
        Ok(include_str!("../../models/fish.xml")
            .replace("{look}", look)
            .into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        let mouth = s.geom("mouth")?;
        let target = s.geom("target")?;
        let radii = s.model.geom_size[mouth][0] + s.model.geom_size[target][0];
        Ok(Self {
            swim: config.swim,
            torso: s.body("torso")?,
            mouth,
            target,
            near: Tolerance::within(0.0, radii).margin(2.0 * radii, Sigmoid::Gaussian),
        })
    }
}

impl SimTask for Fish {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let quat = start.quaternion(Rng::standard_normal, norm);
        start.data.qpos[3..7].copy_from_slice(&quat);
        for joint in JOINTS {
            start.data.qpos[joint] = start.uniform(-0.2, 0.2);
        }
        if self.swim {
            let place = [[-0.4, 0.4], [-0.4, 0.4], [0.1, 0.3]];
            start.data.mocap_pos[0] = place.map(|[low, high]| start.rng.uniform(low, high));
        }
        Ok(())
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xmat, Derived::GeomXpos, Derived::GeomXmat])
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        out.vector("joint_angles", d.qpos[JOINTS].iter().copied());
        out.scalar("upright", d.xmat[self.torso][ZZ]);
        if self.swim {
            out.vector("target", self.to_target(d));
        }
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("joint_angles").positions(JOINTS);
        names.part("upright");
        names.add("cosine of the inclination of torso");
        if self.swim {
            names.part("target");
            names.xyz("{} from mouth to target in the mouth's frame (m)");
        }
        names.part("velocity").velocities(..);
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        let upright = d.xmat[self.torso][ZZ];
        if !self.swim {
            return UPRIGHT.of(upright);
        }
        let in_target = self.near.of(norm(self.to_target(d)));
        (7.0 * in_target + 0.5 * (upright + 1.0)) / 8.0
    }
}

gym_core::register!(
    register::<Fish>("dm_control/fish-upright-v0", "Keep a fish upright."),
    register::<Fish>("dm_control/fish-swim-v0", "Swim to a target.")
        .kwargs(r#"{"swim": true}"#)
        .clip(clip(2)),
);
