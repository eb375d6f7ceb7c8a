//! Walker: stand, walk or run on two legs, in a plane.
//!
//! | | |
//! |---|---|
//! | observation | `orientations`: cosine and sine of each body's angle; `height` of the torso; `velocity` of all joints |
//! | action | torques of right hip, knee, ankle, left hip, knee, ankle, as a share of 100, 50, 20 N m |
//! | reward | standing (3/4 for a torso above 1.2 m, 1/4 for its uprightness), times a value of the speed |
//! | start | joints and orientation at random |
//! | end | never |
//! | limit | 25 s: 1000 steps of 0.025 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default.
//!
//! Source: dm_control 1.0.45, `suite/walker.py`.

use std::borrow::Cow;

use gym_core::Result;
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::axis::{XX, XZ, ZZ};
use super::{check, config};
use crate::domain::{STANDING, clip};
use crate::rewards::{Sigmoid, Tolerance};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

config! { 25.0;
    /// The speed that is rewarded by 1; 0 for standing.
    #[unit = "m/s"]
    pub speed: f64 = 0.0,
    /// The least height of the torso at which the walker counts as standing.
    #[unit = "m"]
    pub stand_height: f64 = 1.2,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Walker {
    torso: usize,
    standing: Tolerance,
    /// The rewarded speed; `None` to stand.
    going: Option<Tolerance>,
}

impl Domain for Walker {
    type Config = Config;

    const NAME: &'static str = "Walker";

    const TIMESTEPS: usize = 10;

    fn text(_: &Config) -> Result<Cow<'static, str>> {
        Ok(include_str!("../../models/walker.xml").into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        check("speed", config.speed, 0.0, 1000.0)?;
        check("stand_height", config.stand_height, 0.01, 10.0)?;
        let (speed, height) = (config.speed, config.stand_height);
        let going = Tolerance::above(speed).margin(speed / 2.0, Sigmoid::Linear(0.5));
        Ok(Self {
            torso: s.body("torso")?,
            standing: Tolerance::above(height).margin(height / 2.0, Sigmoid::Gaussian),
            going: (speed != 0.0).then_some(going),
        })
    }
}

impl SimTask for Walker {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.joints();
        Ok(())
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xpos, Derived::Xmat, Derived::Sensors(3)])
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        let bodies = d.xmat[1..].iter().flat_map(|mat| [mat[XX], mat[XZ]]);
        out.vector("orientations", bodies);
        out.scalar("height", d.xpos[self.torso][2]);
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("orientations");
        for body in 1..names.model().nbody() {
            let body = names.body(body);
            names.each(&["cosine", "sine"], &format!("{{}} of angle of {body}"));
        }
        names.part("height").add("height of torso (m)");
        names.part("velocity").velocities(..);
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        let standing = self.standing.of(d.xpos[self.torso][2]);
        let upright = (1.0 + d.xmat[self.torso][ZZ]) / 2.0;
        let stand = (3.0 * standing + upright) / 4.0;
        match &self.going {
            None => stand,
            Some(going) => stand * (5.0 * going.of(d.sensordata[0]) + 1.0) / 6.0,
        }
    }
}

gym_core::register!(
    register::<Walker>(
        "dm_control/walker-stand-v0",
        "Stand on two legs, in a plane."
    )
    .exceptions(STANDING),
    register::<Walker>("dm_control/walker-walk-v0", "Walk on two legs, in a plane.")
        .exceptions(STANDING)
        .kwargs(r#"{"speed": 1.0}"#)
        .clip(clip(2)),
    register::<Walker>("dm_control/walker-run-v0", "Run on two legs, in a plane.")
        .exceptions(STANDING)
        .kwargs(r#"{"speed": 8.0}"#),
);
