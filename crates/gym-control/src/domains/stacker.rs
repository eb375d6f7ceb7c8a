//! Stacker: stack boxes at a target with an arm and a gripper, in a plane.
//!
//! | | |
//! |---|---|
//! | observation | `arm_pos`: sines and cosines of the joints; `arm_vel`; `touch`: logarithms of the forces on the hand; if `fully_observable`, `hand_pos`, `box_pos`, `box_vel`, `target_pos` |
//! | action | torques of root, shoulder, elbow, wrist and grasp, as a share of 12, 8, 4, 2, 2 N m |
//! | reward | nearness of a box to the target, with the hand at least 0.1 m away from it |
//! | start | arm, boxes and target at random, without contacts |
//! | end | never |
//! | limit | 10 s: 1000 steps of 0.01 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default. The last bit of some numbers is numpy's on a CPU with AVX-512, for which
//! `OPENBLAS_CORETYPE=SkylakeX` asks; on other CPUs dm_control's own differs.
//!
//! Source: dm_control 1.0.45, `suite/stacker.py`.

use std::borrow::Cow;
use std::f64::consts::PI;

use gym_core::{Error, Result};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::arm::{self, Arm, distance, name_pose, pose};
use super::config;
use crate::domain::clip;
use crate::rewards::{Sigmoid, Tolerance};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

/// Half the width of a box.
const SIZE: f64 = 0.022; // m
const CLOSE: Tolerance = Tolerance::within(0.0, 0.0).margin(2.0 * SIZE, Sigmoid::Gaussian);
const FAR: Tolerance = Tolerance::above(0.1).margin(0.01, Sigmoid::Gaussian);
const TOUCH: [&str; 5] = ["palm", "finger", "thumb", "fingertip", "thumbtip"];

config! { 10.0;
    /// Number of boxes.
    pub boxes: u32 = 2,
    /// Whether hand, boxes and target are observed.
    pub fully_observable: bool = true,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Stacker {
    arm: Arm,
    fully_observable: bool,
    /// For each box: its body, its site, and the first of its three joints (x, z, angle).
    boxes: Vec<[usize; 3]>,
    target: [usize; 2],
    grasp: usize,
}

impl Domain for Stacker {
    type Config = Config;

    const NAME: &'static str = "Stacker";

    const TIMESTEPS: usize = 10;

    fn text(config: &Config) -> Result<Cow<'static, str>> {
        if !(1..=4).contains(&config.boxes) {
            let reason = format!("{} is not from 1 to 4", config.boxes);
            return Err(Error::argument("boxes", reason));
        }
        let mut props = String::new();
        for (i, x) in (0..config.boxes).zip([0.5, 0.4, 0.3, 0.2]) {
            props += &format!(
                r#"<body name="box{i}" pos="{x} 0 0.4" childclass="prop">
                  <joint name="box{i}" type="slide" axis="1 0 0" ref="{x}"/><joint type="slide" axis="0 0 1" ref="0.4"/>
                  <joint type="hinge" axis="0 1 0"/>
                  <geom type="box" size="{SIZE} {SIZE} {SIZE}"/><site name="box{i}" type="sphere"/></body>"#
            );
        }
        props += &format!(
            r#"<body name="target" mocap="true" pos="0 0.001 {SIZE}" childclass="ghost">
              <geom type="box" size="{SIZE} {SIZE} {SIZE}"/><site name="target" type="sphere"/></body>"#
        );
        Ok(arm::text(0.01, &props, "").into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        let both = |name: &str| -> Result<[usize; 2]> {
            let body = s.body(name)?;
            Ok([body, s.site(name)?])
        };
        let one = |i: u32| -> Result<[usize; 3]> {
            let name = format!("box{i}");
            let [body, site] = both(&name)?;
            Ok([body, site, s.joint(&name)?])
        };
        Ok(Self {
            arm: Arm::new(s, TOUCH)?,
            fully_observable: config.fully_observable,
            boxes: (0..config.boxes).map(one).collect::<Result<_>>()?,
            target: both("target")?,
            grasp: s.site("grasp")?,
        })
    }
}

impl SimTask for Stacker {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.draw_apart(|start| {
            self.arm.start(start);
            let level = f64::from(2 * start.rng.integer(self.boxes.len() as u32) + 1);
            let x = start.uniform(-0.37, 0.37);
            let target = &mut start.data.mocap_pos[0];
            (target[0], target[2]) = (x, SIZE * level);
            for [_, _, joint] in &self.boxes {
                let place = start.model().jnt_qposadr[*joint];
                start.data.qpos[place] = start.uniform(0.1, 0.3);
                start.data.qpos[place + 1] = start.uniform(0.0, 0.7);
                start.data.qpos[place + 2] = start.uniform(0.0, 2.0 * PI);
            }
        })
    }

    fn observe(&self, m: &Model, d: &Data, out: &mut Observation) {
        self.arm.observe(m, d, out);
        if self.fully_observable {
            self.arm.observe_hand(d, out);
            out.rows(
                "box_pos",
                self.boxes.iter().map(|[body, ..]| pose(d, *body)),
            );
            // x, angle, z
            let velocities = |[_, _, joint]: &[usize; 3]| {
                let v = m.jnt_dofadr[*joint];
                [d.qvel[v], d.qvel[v + 2], d.qvel[v + 1]]
            };
            out.vector("box_vel", self.boxes.iter().flat_map(velocities));
            let target = d.xpos[self.target[0]];
            out.vector("target_pos", [target[0], target[2]]);
        }
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(arm::READS.to_vec())
    }

    fn names(&self, names: &mut Naming<'_>) {
        self.arm.names(names);
        if self.fully_observable {
            let m = names.model();
            self.arm.name_hand(names);
            names.part("box_pos");
            for [body, ..] in &self.boxes {
                name_pose(names, *body);
            }
            names.part("box_vel");
            for [_, _, joint] in &self.boxes {
                let v = m.jnt_dofadr[*joint];
                for dof in [v, v + 2, v + 1] {
                    names.add(names.velocity(dof));
                }
            }
            names.part("target_pos");
            names.each(&["x", "z"], "{} of target (m)");
        }
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        let target = self.target[1];
        let near = self
            .boxes
            .iter()
            .map(|[_, site, _]| distance(d, *site, target));
        CLOSE.of(near.fold(f64::INFINITY, f64::min)) * FAR.of(distance(d, self.grasp, target))
    }
}

gym_core::register!(
    register::<Stacker>(
        "dm_control/stacker-stack_2-v0",
        "Stack two boxes with an arm."
    )
    .clip(clip(5)),
    register::<Stacker>(
        "dm_control/stacker-stack_4-v0",
        "Stack four boxes with an arm."
    )
    .kwargs(r#"{"boxes": 4}"#),
);
