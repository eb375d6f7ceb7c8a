//! Manipulator: bring a ball or a peg to a target, or into a cup or a slot, with an arm and a
//! gripper, in a plane.
//!
//! | | |
//! |---|---|
//! | observation | `arm_pos`: sines and cosines of the joints; `arm_vel`; `touch`: logarithms of the forces on the hand; if `fully_observable`, `hand_pos`, `object_pos`, `object_vel`, `target_pos`: places and orientations |
//! | action | torques of root, shoulder, elbow, wrist and grasp, as a share of 12, 8, 4, 2, 2 N m |
//! | reward | 1 within 1 cm of the target, falling to 0.1 at 3 cm; for a peg also a third for its grasp |
//! | start | arm and target at random; the object in the hand or in the target in one of ten episodes each |
//! | end | never |
//! | limit | 10 s: 1000 steps of 0.01 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default. The last bit of some numbers is numpy's on a CPU with AVX-512, for which
//! `OPENBLAS_CORETYPE=SkylakeX` asks; on other CPUs dm_control's own differs.
//!
//! Source: dm_control 1.0.45, `suite/manipulator.py`.

use std::borrow::Cow;
use std::f64::consts::PI;

use gym_core::{Result, math};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::arm::{self, Arm, distance, name_pose, pose, turned};
use super::axis::{XX, ZX};
use super::config;
use crate::domain::clip;
use crate::rewards::{Sigmoid, Tolerance};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

const CLOSE: Tolerance = Tolerance::within(0.0, 0.01).margin(0.02, Sigmoid::Gaussian);
/// The probabilities that the object starts in the hand, in the target, or elsewhere.
const STARTS: [f64; 3] = [0.1, 0.1, 1.0 - 0.1 - 0.1];
const TOUCH: [&str; 5] = ["palm", "finger", "thumb", "fingertip", "thumbtip"];

const BALL: &str = include_str!("../../models/ball.xml");
const PEG: &str = include_str!("../../models/peg.xml");
const CUP: &str = include_str!("../../models/cup.xml");
const SLOT: &str = include_str!("../../models/slot.xml");

config! { 10.0;
    /// Whether the object is a peg instead of a ball.
    pub use_peg: bool = false,
    /// Whether the target is in a cup, or in a slot.
    pub insert: bool = false,
    /// Whether hand, object and target are observed.
    pub fully_observable: bool = true,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Manipulator {
    arm: Arm,
    insert: bool,
    fully_observable: bool,
    object: usize,
    /// The first of the object's three joints, which are x, z and angle.
    joint: usize,
    target: usize,
    grasp: usize,
    /// Pairs of sites that the task brings together: the object's and the target's.
    pairs: Vec<[usize; 2]>,
    /// The pairs of sites of a peg's grasp; empty for a ball.
    grasping: Vec<[usize; 2]>,
}

impl Domain for Manipulator {
    type Config = Config;

    const NAME: &'static str = "Manipulator";

    const TIMESTEPS: usize = 10;

    fn text(config: &Config) -> Result<Cow<'static, str>> {
        let (object, holder) = if config.use_peg {
            (PEG, SLOT)
        } else {
            (BALL, CUP)
        };
        let (object, ghost) = object.split_once("<!-- target -->").unwrap_or((object, ""));
        let (holder, apart) = if config.insert {
            (holder, r#"<exclude body1="world" body2="holder"/>"#)
        } else {
            ("", "")
        };
        Ok(arm::text(0.005, &format!("{object}{holder}{ghost}"), apart).into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        let pair = |a, b| -> Result<[usize; 2]> { Ok([s.site(a)?, s.site(b)?]) };
        let (mut pairs, mut grasping) = (vec![pair("object", "target")?], Vec::new());
        if config.use_peg {
            pairs.push(pair("target_tip", "peg_tip")?);
            grasping = vec![pair("peg_grasp", "grasp")?, pair("peg_pinch", "pinch")?];
        }
        Ok(Self {
            arm: Arm::new(s, TOUCH)?,
            insert: config.insert,
            fully_observable: config.fully_observable,
            object: s.body("object")?,
            joint: s.joint("object_x")?,
            target: s.body("target")?,
            grasp: s.site("grasp")?,
            pairs,
            grasping,
        })
    }
}

impl SimTask for Manipulator {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let first = start.model().jnt_qposadr[self.joint];
        start.draw_apart(|start| {
            self.arm.start(start);
            let (x, z) = (start.uniform(-0.4, 0.4), start.uniform(0.1, 0.4));
            let reach = if self.insert { PI / 3.0 } else { PI };
            let angle = start.uniform(-reach, reach);
            // the mocap bodies are the target and, with `insert`, the cup or slot around it: both
            // get the same pose
            let data = &mut *start.data;
            for (pos, quat) in data.mocap_pos.iter_mut().zip(&mut data.mocap_quat) {
                (pos[0], pos[2], *quat) = (x, z, turned(angle));
            }
            let object = match start.rng.choice(&STARTS) {
                0 => {
                    start.settle();
                    let (pos, mat) = (
                        start.data.site_xpos[self.grasp],
                        &start.data.site_xmat[self.grasp],
                    );
                    [pos[0], pos[2], PI - math::numpy_atan2(mat[ZX], mat[XX])]
                }
                1 => [x, z, angle],
                _ => {
                    let place = [start.uniform(-0.5, 0.5), start.uniform(0.0, 0.7)];
                    let angle = start.uniform(0.0, 2.0 * PI);
                    start.data.qvel[first] = start.uniform(-5.0, 5.0);
                    [place[0], place[1], angle]
                }
            };
            start.data.qpos[first..first + 3].copy_from_slice(&object);
        })
    }

    fn observe(&self, m: &Model, d: &Data, out: &mut Observation) {
        self.arm.observe(m, d, out);
        if self.fully_observable {
            let first = m.jnt_dofadr[self.joint];
            self.arm.observe_hand(d, out);
            out.vector("object_pos", pose(d, self.object));
            out.vector("object_vel", d.qvel[first..first + 3].iter().copied());
            out.vector("target_pos", pose(d, self.target));
        }
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(arm::READS.to_vec())
    }

    fn names(&self, names: &mut Naming<'_>) {
        self.arm.names(names);
        if self.fully_observable {
            let first = names.model().jnt_dofadr[self.joint];
            self.arm.name_hand(names);
            name_pose(names.part("object_pos"), self.object);
            names.part("object_vel").velocities(first..first + 3);
            name_pose(names.part("target_pos"), self.target);
        }
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        let close = |pairs: &[[usize; 2]]| {
            let all = pairs.iter().map(|[a, b]| CLOSE.of(distance(d, *a, *b)));
            all.sum::<f64>() / pairs.len() as f64
        };
        let bringing = close(&self.pairs);
        if self.grasping.is_empty() {
            return bringing;
        }
        bringing.max(close(&self.grasping) / 3.0)
    }
}

gym_core::register!(
    register::<Manipulator>(
        "dm_control/manipulator-bring_ball-v0",
        "Bring a ball to a target with an arm."
    )
    .clip(clip(5)),
    register::<Manipulator>(
        "dm_control/manipulator-bring_peg-v0",
        "Bring a peg to a target with an arm."
    )
    .kwargs(r#"{"use_peg": true}"#),
    register::<Manipulator>(
        "dm_control/manipulator-insert_ball-v0",
        "Bring a ball into a cup with an arm."
    )
    .kwargs(r#"{"insert": true}"#),
    register::<Manipulator>(
        "dm_control/manipulator-insert_peg-v0",
        "Bring a peg into a slot with an arm."
    )
    .kwargs(r#"{"use_peg": true, "insert": true}"#),
);
