//! Swimmer: swim to a target with a chain of links, in a plane.
//!
//! | | |
//! |---|---|
//! | observation | angles of the `joints`; `to_target`: from the nose, in the head's frame; `body_velocities`: x, y and turning of each link in its frame |
//! | action | torques of the joints, as a share of 5e-4 N m |
//! | reward | 1 with the nose in the target, falling to 0.1 at 0.5 m |
//! | start | joints and orientation at random; the target within 0.3 m in one of five episodes, else within 2 m |
//! | end | never |
//! | limit | 30 s: 1000 steps of 0.03 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default. The last bit of some numbers is numpy's on a CPU with AVX-512, for which
//! `OPENBLAS_CORETYPE=SkylakeX` asks; on other CPUs dm_control's own differs.
//!
//! Source: dm_control 1.0.45, `suite/swimmer.py`.

use std::borrow::Cow;

use gym_core::{Error, Result};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::{config, minus, norm, times};
use crate::domain::clip;
use crate::rewards::{Sigmoid, Tolerance};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

config! { 30.0;
    /// Number of links.
    pub links: u32 = 6,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Swimmer {
    head: usize,
    nose: usize,
    target: usize,
    near: Tolerance,
}

impl Swimmer {
    fn to_target(&self, d: &Data) -> [f64; 2] {
        let to = minus(d.geom_xpos[self.target], d.geom_xpos[self.nose]);
        let [x, y, _] = times(to, &d.xmat[self.head]);
        [x, y]
    }
}

impl Domain for Swimmer {
    type Config = Config;

    const NAME: &'static str = "Swimmer";

    const TIMESTEPS: usize = 15;

    fn text(config: &Config) -> Result<Cow<'static, str>> {
        let n = config.links;
        if !(3..=50).contains(&n) {
            return Err(Error::argument("links", format!("{n} is not from 3 to 50")));
        }
        let limit = 360.0 / f64::from(n);
        let (mut links, mut motors, mut sensors) = (String::new(), String::new(), String::new());
        for i in (0..n - 1).rev() {
            links = format!(
                r#"<body pos="0 0.1 0"><geom class="skin"/><geom class="bulk"/><site name="{i}"/><joint name="{i}" range="{} {limit}"/>{links}</body>"#,
                -limit
            );
        }
        for i in 0..n - 1 {
            motors += &format!(r#"<motor joint="{i}"/>"#);
            sensors += &format!(r#"<velocimeter site="{i}"/><gyro site="{i}"/>"#);
        }
        let scale = f64::from(n) / 6.0;
        let mut text = include_str!("../../models/swimmer.xml")
            .replace("{links}", &links)
            .replace("{motors}", &motors)
            .replace("{sensors}", &sensors);
        for (name, x) in [
            ("{back}", -0.2),
            ("{up}", 0.5),
            ("{left}", -0.9),
            ("{ahead}", 0.5),
            ("{low}", 0.15),
        ] {
            text = text.replace(name, &(x * scale).to_string());
        }
        Ok(text.into())
    }

    fn new(_: &Config, s: &Simulation) -> Result<Self> {
        let target = s.geom("target")?;
        let size = s.model.geom_size[target][0];
        Ok(Self {
            head: s.body("head")?,
            nose: s.geom("nose")?,
            target,
            near: Tolerance::within(0.0, size).margin(5.0 * size, Sigmoid::LongTail),
        })
    }
}

impl SimTask for Swimmer {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.joints();
        let reach = if start.rng.random() < 0.2 { 0.3 } else { 2.0 };
        for k in 0..2 {
            start.data.mocap_pos[0][k] = start.uniform(-reach, reach);
        }
        Ok(())
    }

    fn reads(&self, model: &Model) -> Option<Vec<Derived>> {
        Some(vec![
            Derived::GeomXpos,
            Derived::Xmat,
            Derived::Sensors(model.nsensordata()),
        ])
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        out.vector("joints", d.qpos[3..].iter().copied());
        out.vector("to_target", self.to_target(d));
        let planar = |v: &[f64; 6]| [v[0], v[1], v[5]];
        out.vector(
            "body_velocities",
            d.sensordata.as_chunks().0.iter().flat_map(planar),
        );
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("joints").positions(3..);
        names.part("to_target");
        names.each(
            &["x", "y"],
            "{} from nose to target in the head's frame (m)",
        );
        names.part("body_velocities");
        for link in 0..names.model().nsensordata() / 6 {
            for k in [0, 1, 5] {
                names.add(names.sensor(6 * link + k));
            }
        }
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        self.near.of(norm(self.to_target(d)))
    }
}

gym_core::register!(
    register::<Swimmer>(
        "dm_control/swimmer-swimmer6-v0",
        "Swim to a target with six links."
    ),
    register::<Swimmer>(
        "dm_control/swimmer-swimmer15-v0",
        "Swim to a target with fifteen links."
    )
    .kwargs(r#"{"links": 15}"#)
    .clip(clip(2)),
);
