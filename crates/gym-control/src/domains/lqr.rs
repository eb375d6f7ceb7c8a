//! LQR: bring masses on springs to rest, at the cost of a linear-quadratic regulator.
//!
//! | | |
//! |---|---|
//! | observation | `position` and `velocity` of each mass |
//! | action | forces on the first masses, in N |
//! | reward | 1 less half the squared positions, less 0.05 times the squared forces |
//! | start | positions of length √2, with stiffnesses from 15 to 25 N/m that each seed draws |
//! | end | terminated at rest in the middle, within 1e-6 |
//! | limit | none |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default. The last bit of some numbers is numpy's on a CPU with AVX-512, for which
//! `OPENBLAS_CORETYPE=SkylakeX` asks; on other CPUs dm_control's own differs.
//!
//! Source: dm_control 1.0.45, `suite/lqr.py`.

use std::borrow::Cow;

use gym_core::{Env, Error, Policy, Result, Space, Value};
use gym_sim::numpy::{dot, norm};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{CompiledModel, Data, Model};

use super::{check, config};
use crate::domain::{UNLIMITED, clip};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

const STIFFNESS: [f64; 2] = [15.0, 25.0]; // N/m
const AT_REST: f64 = 1e-6;

config! { None;
    /// Number of masses.
    pub bodies: u32 = 2,
    /// Number of masses with a motor.
    pub actuators: u32 = 1,
    /// Cost of half a squared force of 1 N.
    pub control_cost: f64 = 0.1,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Lqr {
    bodies: usize,
    control_cost: f64,
}

impl Domain for Lqr {
    type Config = Config;

    const NAME: &'static str = "Lqr";

    fn text(config: &Config) -> Result<Cow<'static, str>> {
        let (n, motors) = (config.bodies, config.actuators);
        if !(1..=30).contains(&n) || !(1..=n).contains(&motors) {
            let reason = format!("{motors} of {n} bodies: from 1 to all of at most 30 are driven");
            return Err(Error::argument("actuators", reason));
        }
        let mut bodies = String::new();
        for i in (0..n).rev() {
            let height = if i == 0 { 0.1 } else { 0.0 };
            bodies = format!(
                r#"<body name="{i}" pos="0.25 0 {height}"><joint name="{i}"/><geom/><site name="{i}"/>{bodies}</body>"#
            );
        }
        let list = |n: u32, item: &dyn Fn(u32) -> String| (0..n).map(item).collect::<String>();
        let tendon = |i: u32| {
            format!(
                r#"<spatial><site site="{i}"/><site site="{}"/></spatial>"#,
                i + 1
            )
        };
        let text = include_str!("../../models/lqr.xml")
            .replace("{bodies}", &bodies)
            .replace(
                "{motors}",
                &list(motors, &|i| format!(r#"<motor joint="{i}"/>"#)),
            )
            .replace("{tendons}", &list(n - 1, &tendon));
        Ok(text.into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        check("control_cost", config.control_cost, 1e-9, 1e9)?;
        Ok(Self {
            bodies: s.model.nq(),
            control_cost: config.control_cost,
        })
    }
}

impl SimTask for Lqr {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        if start.seeded || start.constants.is_empty() {
            start.constants.clear();
            for _ in 0..self.bodies {
                let stiffness = start.uniform(STIFFNESS[0], STIFFNESS[1]);
                start.constants.push(stiffness);
                start.rng.random(); // the damping, which is always 0
            }
            start.change(|constants, model| self.apply(constants, model))?;
        }
        let unit: Vec<f64> = (0..self.bodies)
            .map(|_| start.rng.standard_normal())
            .collect();
        let length = norm(5, &unit);
        for (position, x) in start.data.qpos.iter_mut().zip(unit) {
            *position = 2.0_f64.sqrt() * x / length;
        }
        Ok(())
    }

    fn apply(&self, constants: &[f64], model: &mut CompiledModel) {
        model.jnt_stiffness.copy_from_slice(constants);
    }

    fn has(&self, constants: &[f64]) -> bool {
        constants.len() == self.bodies && constants.iter().all(|x| x.is_finite())
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(Vec::new())
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        out.vector("position", d.qpos.iter().copied());
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        for (part, unit) in [("position", "m"), ("velocity", "m/s")] {
            names.part(part);
            for mass in 0..self.bodies {
                names.add(format!("{part} of mass {mass} ({unit})"));
            }
        }
        for mass in 0..names.model().nu() {
            names.action(format!("force on mass {mass} (N)"));
        }
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        1.0 - (0.5 * dot(5, &d.qpos) + 0.5 * dot(5, &d.ctrl) * self.control_cost)
    }

    fn is_over(&self, d: &Data) -> bool {
        (dot(5, &d.qpos) + dot(5, &d.qvel)).sqrt() < AT_REST
    }
}

/// Applies a force against the velocity to each mass with a motor.
const BRAKE: Policy = Policy::rules("pushes against the velocities of the masses", |env| {
    let forces: usize = env.action_space().shape()?.iter().product();
    matches!(env.observation_space(), Space::Dict(_)).then_some(())?;
    Some(Box::new(move |_, seen| {
        let velocities = seen.get("velocity")?.as_array()?.iter_f64();
        let pushes: Vec<f64> = velocities.take(forces).map(|v| -v).collect();
        Some(Value::Array(pushes.into()))
    }))
});

gym_core::register!(
    register::<Lqr>(
        "dm_control/lqr-lqr_2_1-v0",
        "Bring two masses on springs to rest, by one force."
    )
    .policy(BRAKE)
    .clip(clip(2))
    .exceptions(UNLIMITED),
    register::<Lqr>(
        "dm_control/lqr-lqr_6_2-v0",
        "Bring six masses on springs to rest, by two forces."
    )
    .policy(BRAKE)
    .exceptions(UNLIMITED)
    .kwargs(r#"{"bodies": 6, "actuators": 2}"#),
);
