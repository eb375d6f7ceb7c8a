//! Finger: spin a body on a hinge, or turn its tip to a target, with a finger of two links.
//!
//! | | |
//! |---|---|
//! | observation | `position`: of both joints, and of the tip against the hinge in x and z; `velocity` of joints and hinge; `touch`: logarithms of the forces on the fingertip; to turn, `target_position` and `dist_to_target` |
//! | action | torques of both joints, as a share of 30 and 15 N m |
//! | reward | 1 where the body spins at 15 rad/s or more, or where the tip is in the target; else 0 |
//! | start | joints, body and target at random, without contacts |
//! | end | never |
//! | limit | 20 s: 1000 steps of 0.02 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default.
//!
//! Source: dm_control 1.0.45, `suite/finger.py`.

use std::borrow::Cow;
use std::f64::consts::PI;

use gym_core::{Result, math};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::{check, config, minus, norm};
use crate::domain::{TARGET, clip};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

const FAST: f64 = -15.0; // rad/s

config! { 20.0;
    /// Radius of the target; 0 for none, to spin.
    #[unit = "m"]
    pub target_size: f64 = 0.0,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Finger {
    target_size: f64,
    spinner: usize,
    tip: usize,
    target: usize,
    /// The distance from the hinge to the tip.
    reach: f64,
}

impl Finger {
    /// Returns the vector from the hinge to a site, in x and z.
    fn offset(&self, d: &Data, site: usize) -> [f64; 2] {
        [0, 2].map(|k| d.site_xpos[site][k] - d.xpos[self.spinner][k])
    }

    fn distance(&self, d: &Data) -> f64 {
        let (target, tip) = (self.offset(d, self.target), self.offset(d, self.tip));
        norm(minus(target, tip)) - self.target_size
    }

    fn turns(&self) -> bool {
        self.target_size > 0.0
    }
}

impl Domain for Finger {
    type Config = Config;

    const NAME: &'static str = "Finger";

    const TIMESTEPS: usize = 2;

    fn text(config: &Config) -> Result<Cow<'static, str>> {
        check("target_size", config.target_size, 0.0, 0.2)?;
        let turns = config.target_size > 0.0;
        // in the spin task, the hinge has less damping, and the target is invisible
        let (damping, look) = if turns {
            ("0.5", "0.82 0.27 0.25 0.7")
        } else {
            ("0.03", "0 0 0 0")
        };
        let size = if turns { config.target_size } else { 0.03 };
        let text = include_str!("../../models/finger.xml")
            .replace("{damping}", damping)
            .replace("{look}", look)
            .replace("{target}", &size.to_string());
        Ok(text.into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        let cap = s.geom("cap1")?;
        Ok(Self {
            target_size: config.target_size,
            spinner: s.body("spinner")?,
            tip: s.site("tip")?,
            target: s.site("target")?,
            reach: s.model.geom_size[cap].iter().sum(),
        })
    }
}

impl SimTask for Finger {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        if self.turns() {
            let angle = start.uniform(-PI, PI);
            let hinge = start.data.xanchor[2];
            let x = hinge[0] + self.reach * math::sin(angle);
            let z = hinge[2] + self.reach * math::cos(angle);
            start.data.mocap_pos[0] = [x, 0.0, z];
        }
        start.draw_apart(Start::joints)
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        let tip = self.offset(d, self.tip);
        out.vector("position", [d.qpos[0], d.qpos[1], tip[0], tip[1]]);
        out.vector("velocity", d.qvel.iter().copied());
        out.vector("touch", [0, 1].map(|i| math::numpy_ln_1p(d.sensordata[i])));
        if self.turns() {
            out.vector("target_position", self.offset(d, self.target));
            out.scalar("dist_to_target", self.distance(d));
        }
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xpos, Derived::SiteXpos, Derived::Sensors(2)])
    }

    fn names(&self, names: &mut Naming<'_>) {
        let axes = &["x", "z"];
        names.part("position").positions(..2);
        names.each(axes, "{} from hinge to tip (m)");
        names.part("velocity").velocities(..);
        names.part("touch");
        for sensor in [0, 1] {
            names.of("logarithm of 1 N plus", &names.sensor(sensor));
        }
        if self.turns() {
            names.part("target_position");
            names.each(axes, "{} from hinge to target (m)");
            names.part("dist_to_target");
            names.add("distance from tip to target (m)");
        }
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        f64::from(if self.turns() {
            self.distance(d) <= 0.0
        } else {
            d.qvel[2] <= FAST
        })
    }
}

gym_core::register!(
    register::<Finger>(
        "dm_control/finger-spin-v0",
        "Spin a body on a hinge with a finger."
    )
    .exceptions(TARGET)
    .clip(clip(2)),
    register::<Finger>(
        "dm_control/finger-turn_easy-v0",
        "Turn a body's tip to a large target with a finger."
    )
    .exceptions(TARGET)
    .kwargs(r#"{"target_size": 0.07}"#),
    register::<Finger>(
        "dm_control/finger-turn_hard-v0",
        "Turn a body's tip to a small target with a finger."
    )
    .exceptions(TARGET)
    .kwargs(r#"{"target_size": 0.03}"#),
);
