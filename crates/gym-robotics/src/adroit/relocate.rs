//! AdroitHandRelocate: carry a ball to a place.
//!
//! | | |
//! |---|---|
//! | observation | positions of arm and hand in m and rad; differences of palm and ball, of palm and goal, and of ball and goal, in m; `Box(39, float64)` |
//! | action | positions of the joints of arm and hand, as shares of their ranges; `Box(-1, 1, (30,), float32)` |
//! | reward | 0.1 times the distance from palm to ball in m; for a ball above 0.04 m plus 1, minus half the distances from palm and ball to the goal; plus 10 and 20 for a ball within 0.1 and 0.05 m of the goal. Ids with `Sparse`: 10 within 0.1 m, else -0.1 |
//! | start | ball and goal at random: the ball at x from -0.15 to 0.15 m and y from -0.15 to 0.3 m, the goal within 0.2 m along x and y, at a height from 0.15 to 0.35 m |
//! | end | never |
//! | limit | 200 steps of 0.01 s |
//!
//! `info` has `success`, whether the ball is within 0.1 m of the goal. The reset option
//! `initial_state_dict` gives `qpos`, `qvel`, `obj_pos` and `target_pos`.
//!
//! Differences from Gymnasium-Robotics: all numbers are Gymnasium-Robotics' with the version of
//! MuJoCo that `mujoco` names, for Linux on x86-64. The hand has no visual meshes, and sensors that
//! no observation reads are left out. Dense rewards are numpy's on a CPU for which OpenBLAS has a
//! kernel with AVX2 and none with AVX-512; with such a kernel, lengths differ in the last bit.
//!
//! Actions in the picture are random: no policy was trained for this task, and none is scripted.
//!
//! Source: Gymnasium-Robotics 1.4.2, `envs/adroit_hand/adroit_relocate.py`, and the hand of Vikash
//! Kumar's ADROIT.

use gym_core::Result;
use gym_sim::{Naming, Observation, Rng, Simulation};
use mujoco_engine::{CompiledModel, Data, Model};

use super::hand::ArmJoint;
use super::{Skill, apart, ids, minus, zeros};

/// The task.
#[derive(Debug)]
struct Relocate {
    ball: usize,
    palm: usize,
    target: usize,
}

impl Relocate {
    /// The places of palm, ball and goal.
    fn places(&self, d: &Data) -> [[f64; 3]; 3] {
        let [palm, target] = [self.palm, self.target].map(|site| d.site_xpos[site]);
        [palm, d.xpos[self.ball], target]
    }
}

impl Skill for Relocate {
    const NAME: &'static str = "AdroitHandRelocateEnv";
    const ARM: &'static [ArmJoint] = &[
        ("ARTx", [-0.25, 0.25]),
        ("ARTy", [0.0, 0.2]),
        ("ARTz", [-0.3, 0.5]),
        ("ARRx", [-0.75, 0.75]),
        ("ARRy", [-0.75, 0.75]),
        ("ARRz", [-0.75, 0.75]),
    ];
    const MODEL: &'static str = include_str!("../../models/adroit_relocate.xml");
    const CAMERA: [f64; 2] = [1.5, 90.0];
    const CONSTANTS: &'static [(&'static str, usize)] = &[("obj_pos", 3), ("target_pos", 3)];

    fn new(simulation: &Simulation) -> Result<Self> {
        Ok(Self {
            ball: simulation.body("Object")?,
            palm: simulation.site("S_grasp")?,
            target: simulation.site("target")?,
        })
    }

    fn constants(&self, m: &Model, constants: &mut Vec<f64>) {
        constants.extend(m.body_pos[self.ball]);
        constants.extend(m.site_pos[self.target]);
    }

    fn draw(&self, constants: &mut [f64], rng: &mut Rng) {
        for (k, low, high) in [
            (0, -0.15, 0.15),
            (1, -0.15, 0.3),
            (3, -0.2, 0.2),
            (4, -0.2, 0.2),
            (5, 0.15, 0.35),
        ] {
            constants[k] = rng.uniform(low, high);
        }
    }

    fn apply(&self, constants: &[f64], m: &mut CompiledModel) {
        m.body_pos[self.ball].copy_from_slice(&constants[..3]);
        m.site_pos[self.target].copy_from_slice(&constants[3..]);
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        let [palm, ball, target] = self.places(d);
        let joints = d.qpos[..d.qpos.len() - 6].iter().copied();
        out.extend(
            joints
                .chain(minus(palm, ball))
                .chain(minus(palm, target))
                .chain(minus(ball, target)),
        );
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.positions(..names.model().nq() - 6);
        names.xyz("{} from ball to palm (m)");
        names.xyz("{} from target to palm (m)");
        names.xyz("{} from target to ball (m)");
    }

    fn judge(&self, d: &Data) -> (f64, bool) {
        let [palm, ball, target] = self.places(d);
        let distance = apart(ball, target);
        let mut reward = 0.1 * apart(palm, ball);
        if ball[2] > 0.04 {
            reward += 1.0;
            reward += -0.5 * apart(palm, target);
            reward += -0.5 * distance;
        }
        for (most, bonus) in [(0.1, 10.0), (0.05, 20.0)] {
            if distance < most {
                reward += bonus;
            }
        }
        (reward, distance < 0.1)
    }
}

ids!(
    Relocate,
    "AdroitHandRelocate",
    "Carry a ball to a place with a hand.",
    concat!(
        "{\"qpos\":",
        zeros!(36),
        ",\"qvel\":",
        zeros!(36),
        ",\"obj_pos\":[0.1,0.1,0.035],\"target_pos\":[-0.1,0,0.2]}"
    )
);
