//! AdroitHandHammer: take a hammer and drive a nail into a board with it.
//!
//! | | |
//! |---|---|
//! | observation | angles of arm, hand and nail in rad and m; velocities of the hammer, limited to 1; places of palm and hammer in m; the hammer's Euler angles in rad; the nail's place in m, and the force on it, limited to 1; `Box(46, float64)` |
//! | action | positions of the joints of arm and hand, as shares of their ranges; `Box(-1, 1, (26,), float32)` |
//! | reward | 0.1 times the distance from palm to hammer, minus that from its head to the nail, minus 10 times that from the nail to its goal, in m, minus 0.01 times the length of the velocities; plus 2 for a lifted hammer, and 25 and 75 for a nail within 0.02 and 0.01 m of its goal. Ids with `Sparse`: 10 within 0.01 m, else -0.1 |
//! | start | the board at a random height from 0.1 to 0.25 m |
//! | end | never |
//! | limit | 200 steps of 0.01 s |
//!
//! `info` has `success`, whether the nail is within 0.01 m of its goal. The reset option
//! `initial_state_dict` gives `qpos`, `qvel` and `board_pos`.
//!
//! Differences from Gymnasium-Robotics: all numbers are Gymnasium-Robotics' with the version of
//! MuJoCo that `mujoco` names, for Linux on x86-64. The hand has no visual meshes, and sensors that
//! no observation reads are left out. Dense rewards are numpy's on a CPU for which OpenBLAS has a
//! kernel with AVX2 and none with AVX-512; with such a kernel, lengths differ in the last bit.
//!
//! Actions in the picture are random: no policy was trained for this task, and none is scripted.
//!
//! Source: Gymnasium-Robotics 1.4.2, `envs/adroit_hand/adroit_hammer.py`, and the hand of Vikash
//! Kumar's ADROIT.

use gym_core::Result;
use gym_sim::numpy::norm_avx2;
use gym_sim::{Naming, Observation, Rng, Simulation};
use mujoco_engine::{CompiledModel, Data, Model};

use super::hand::ArmJoint;
use super::{Skill, apart, ids, zeros};
use crate::rotation::quat_to_euler;

/// The task.
#[derive(Debug)]
struct Hammer {
    nail: usize,
    goal: usize,
    palm: usize,
    head: usize,
    hammer: usize,
    board: usize,
    impact: usize,
}

impl Skill for Hammer {
    const NAME: &'static str = "AdroitHandHammerEnv";
    const ARM: &'static [ArmJoint] = &[("ARRx", [-0.4, 0.25]), ("ARRy", [-0.3, 0.3])];
    const MODEL: &'static str = include_str!("../../models/adroit_hammer.xml");
    const CAMERA: [f64; 2] = [2.0, 45.0];
    const CONSTANTS: &'static [(&'static str, usize)] = &[("board_pos", 3)];

    fn new(simulation: &Simulation) -> Result<Self> {
        Ok(Self {
            nail: simulation.site("S_target")?,
            goal: simulation.site("nail_goal")?,
            palm: simulation.site("S_grasp")?,
            head: simulation.site("tool")?,
            hammer: simulation.body("Object")?,
            board: simulation.body("nail_board")?,
            impact: simulation.model.sensor_adr[simulation.sensor("S_nail")?],
        })
    }

    fn constants(&self, m: &Model, constants: &mut Vec<f64>) {
        constants.extend(m.body_pos[self.board]);
    }

    fn draw(&self, constants: &mut [f64], rng: &mut Rng) {
        constants[2] = rng.uniform(0.1, 0.25);
    }

    fn apply(&self, constants: &[f64], m: &mut CompiledModel) {
        m.body_pos[self.board].copy_from_slice(constants);
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        let joints = d.qpos[..d.qpos.len() - 6].iter().copied();
        let velocities = d.qvel[d.qvel.len() - 6..].iter();
        out.extend(
            joints
                .chain(velocities.map(|v| v.clamp(-1.0, 1.0)))
                .chain(d.site_xpos[self.palm])
                .chain(d.xpos[self.hammer])
                .chain(quat_to_euler(d.xquat[self.hammer]))
                .chain(d.site_xpos[self.nail])
                .chain([d.sensordata[self.impact].clamp(-1.0, 1.0)]),
        );
    }

    fn names(&self, names: &mut Naming<'_>) {
        let [nq, nv] = [names.model().nq(), names.model().nv()];
        names.positions(..nq - 6).velocities(nv - 6..);
        names.xyz("{} of the palm (m)").xyz("{} of the hammer (m)");
        names.xyz("Euler angle of the hammer about {} (rad)");
        names.xyz("{} of the nail (m)");
        names.add(names.sensor(self.impact));
    }

    fn judge(&self, d: &Data) -> (f64, bool) {
        let (hammer, [palm, head, nail, goal]) = (
            d.xpos[self.hammer],
            [self.palm, self.head, self.nail, self.goal].map(|site| d.site_xpos[site]),
        );
        let distance = apart(nail, goal);
        let mut reward = 0.1 * apart(palm, hammer);
        reward -= apart(head, nail);
        reward -= 10.0 * distance;
        reward -= 1e-2 * norm_avx2(&d.qvel);
        if hammer[2] > 0.04 && head[2] > 0.04 {
            reward += 2.0;
        }
        for (most, bonus) in [(0.02, 25.0), (0.01, 75.0)] {
            if distance < most {
                reward += bonus;
            }
        }
        (reward, distance < 0.01)
    }
}

ids!(
    Hammer,
    "AdroitHandHammer",
    "Take a hammer and drive a nail into a board with a hand.",
    concat!(
        "{\"qpos\":",
        zeros!(33),
        ",\"qvel\":",
        zeros!(33),
        ",\"board_pos\":[0.05,0,0.2]}"
    )
);
