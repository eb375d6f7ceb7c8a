//! Point mass: bring a mass on a plane to a target.
//!
//! | | |
//! |---|---|
//! | observation | `position` and `velocity` in x and y |
//! | action | two forces, as a share of 0.1 N, along x and y or, if `randomize_gains`, along two random directions |
//! | reward | 1 within the target, falling to 0.1 at the same distance from it, times a value of small controls |
//! | start | at a random place |
//! | end | never |
//! | limit | 20 s: 1000 steps of 0.02 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default. The last bit of some numbers is numpy's on a CPU with AVX-512, for which
//! `OPENBLAS_CORETYPE=SkylakeX` asks; on other CPUs dm_control's own differs.
//!
//! Source: dm_control 1.0.45, `suite/point_mass.py`.

use std::borrow::Cow;

use gym_core::Result;
use mujoco_engine::lanes::Derived;
use mujoco_engine::{CompiledModel, Data, Model};

use super::{check, config, minus, norm};
use crate::domain::clip;
use crate::rewards::{Sigmoid, Tolerance, small_control};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, Rng, SimTask, Simulation, Start};

/// Two directions are too similar if the cosine between them exceeds this.
const PARALLEL: f64 = 0.9;

config! { 20.0;
    /// Whether each episode has other directions of the forces.
    pub randomize_gains: bool = false,
    /// Radius of the target.
    #[unit = "m"]
    pub target_size: f64 = 0.015,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct PointMass {
    randomize_gains: bool,
    mass: usize,
    target: usize,
    near: Tolerance,
}

/// Draws a random unit vector.
fn direction(rng: &mut Rng) -> [f64; 2] {
    let v = [(); 2].map(|()| rng.standard_normal());
    let length = norm(v);
    v.map(|x| x / length)
}

impl Domain for PointMass {
    type Config = Config;

    const NAME: &'static str = "PointMass";

    fn text(config: &Config) -> Result<Cow<'static, str>> {
        check("target_size", config.target_size, 0.001, 0.3)?;
        let size = config.target_size.to_string();
        Ok(include_str!("../../models/point_mass.xml")
            .replace("{target}", &size)
            .into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        let size = config.target_size;
        Ok(Self {
            randomize_gains: config.randomize_gains,
            mass: s.geom("mass")?,
            target: s.geom("target")?,
            near: Tolerance::within(0.0, size).margin(size, Sigmoid::Gaussian),
        })
    }
}

impl SimTask for PointMass {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.joints();
        if self.randomize_gains {
            let first = direction(start.rng);
            let second = loop {
                let second = direction(start.rng);
                if dot(first, second).abs() <= PARALLEL {
                    break second;
                }
            };
            start.constants.clear();
            start.constants.extend(first.into_iter().chain(second));
            start.change(|constants, model| self.apply(constants, model))?;
        }
        Ok(())
    }

    fn apply(&self, constants: &[f64], model: &mut CompiledModel) {
        model.wrap_prm.copy_from_slice(constants);
    }

    fn has(&self, constants: &[f64]) -> bool {
        let number = if self.randomize_gains { 4 } else { 0 };
        constants.len() == number && constants.iter().all(|x| x.is_finite())
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::GeomXpos])
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        out.vector("position", d.qpos.iter().copied());
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("position").positions(..);
        names.part("velocity").velocities(..);
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        let distance = norm(minus(d.geom_xpos[self.target], d.geom_xpos[self.mass]));
        self.near.of(distance) * ((small_control(&d.ctrl) + 4.0) / 5.0)
    }
}

/// Returns `np.dot(a, b)`, as numpy computes it on a CPU with AVX-512.
#[expect(
    clippy::disallowed_methods,
    reason = "a fused product is the same on every platform"
)]
fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[1].mul_add(b[1], a[0] * b[0])
}

gym_core::register!(
    register::<PointMass>(
        "dm_control/point_mass-easy-v0",
        "Bring a mass on a plane to a target."
    )
    .clip(clip(2)),
    register::<PointMass>(
        "dm_control/point_mass-hard-v0",
        "Bring a mass to a target by forces of unknown directions."
    )
    .kwargs(r#"{"randomize_gains": true}"#),
);
