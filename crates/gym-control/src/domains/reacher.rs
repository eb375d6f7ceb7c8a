//! Reacher: bring the tip of an arm of two links to a target.
//!
//! | | |
//! |---|---|
//! | observation | `position` of the joints, `to_target`: from the finger to the target in x and y, `velocity` of the joints |
//! | action | torques of shoulder and wrist, as a share of 0.05 N m |
//! | reward | 1 where finger and target touch, else 0 |
//! | start | joints and the target at random |
//! | end | never |
//! | limit | 20 s: 1000 steps of 0.02 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default.
//!
//! Source: dm_control 1.0.45, `suite/reacher.py`.

use std::borrow::Cow;
use std::f64::consts::PI;

use gym_core::{Result, math};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::{check, config, norm};
use crate::domain::clip;
use crate::rewards::Tolerance;
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

config! { 20.0;
    /// Radius of the target.
    #[unit = "m"]
    pub target_size: f64 = 0.05,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Reacher {
    finger: usize,
    target: usize,
    touching: Tolerance,
}

impl Reacher {
    fn to_target(&self, d: &Data) -> [f64; 2] {
        [0, 1].map(|k| d.geom_xpos[self.target][k] - d.geom_xpos[self.finger][k])
    }
}

impl Domain for Reacher {
    type Config = Config;

    const NAME: &'static str = "Reacher";

    fn text(config: &Config) -> Result<Cow<'static, str>> {
        check("target_size", config.target_size, 0.001, 0.3)?;
        let size = config.target_size.to_string();
        Ok(include_str!("../../models/reacher.xml")
            .replace("{target}", &size)
            .into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        let finger = s.geom("finger")?;
        Ok(Self {
            finger,
            target: s.geom("target")?,
            touching: Tolerance::within(0.0, config.target_size + s.model.geom_size[finger][0]),
        })
    }
}

impl SimTask for Reacher {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.joints();
        let angle = start.uniform(0.0, 2.0 * PI);
        let radius = start.uniform(0.05, 0.2);
        let place = &mut start.data.mocap_pos[0];
        (place[0], place[1]) = (radius * math::sin(angle), radius * math::cos(angle));
        Ok(())
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::GeomXpos])
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        out.vector("position", d.qpos.iter().copied());
        out.vector("to_target", self.to_target(d));
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("position").positions(..);
        names.part("to_target");
        names.each(&["x", "y"], "{} from finger to target (m)");
        names.part("velocity").velocities(..);
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        self.touching.of(norm(self.to_target(d)))
    }
}

gym_core::register!(
    register::<Reacher>(
        "dm_control/reacher-easy-v0",
        "Bring the tip of an arm to a large target."
    )
    .clip(clip(2)),
    register::<Reacher>(
        "dm_control/reacher-hard-v0",
        "Bring the tip of an arm to a small target."
    )
    .kwargs(r#"{"target_size": 0.015}"#),
);
