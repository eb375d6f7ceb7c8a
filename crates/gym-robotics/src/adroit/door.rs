//! AdroitHandDoor: undo a latch and open a door with the hand.
//!
//! | | |
//! |---|---|
//! | observation | angles of the arm's joints but its slide, and of the hand's, of the latch and the door, in rad; places of palm and handle, and their difference, in m; 1 if the door is open by more than 1 rad, else -1; `Box(39, float64)` |
//! | action | positions of the joints of arm and hand, as shares of their ranges; `Box(-1, 1, (28,), float32)` |
//! | reward | 0.1 times the distance from palm to handle in m, minus 0.1 times the squared distance of the door's angle from 1.57 rad, minus 1e-5 times the sum of the squared velocities; plus 2, 8 and 10 beyond 0.2, 1 and 1.35 rad. Ids with `Sparse`: 10 from 1.35 rad on, else -0.1 |
//! | start | the frame of the door at random: x from -0.3 to -0.2 m, y from 0.25 to 0.35 m, z from 0.252 to 0.35 m |
//! | end | never |
//! | limit | 200 steps of 0.01 s |
//!
//! `info` has `success`, whether the door is open by 1.35 rad. The reset option `initial_state_dict`
//! gives `qpos`, `qvel` and `door_body_pos`.
//!
//! Differences from Gymnasium-Robotics: all numbers are Gymnasium-Robotics' with the version of
//! MuJoCo that `mujoco` names, for Linux on x86-64. The hand has no visual meshes, and sensors that
//! no observation reads are left out. Dense rewards are numpy's on a CPU for which OpenBLAS has a
//! kernel with AVX2 and none with AVX-512; with such a kernel, lengths differ in the last bit.
//!
//! Actions in the picture are random: no policy was trained for this task, and none is scripted.
//!
//! Source: Gymnasium-Robotics 1.4.2, `envs/adroit_hand/adroit_door.py`, and the hand of Vikash
//! Kumar's ADROIT.

use gym_core::Result;
use gym_sim::numpy::sum_of_squares;
use gym_sim::{Naming, Observation, Rng, Simulation};
use mujoco_engine::{CompiledModel, Data, Model};

use super::hand::ArmJoint;
use super::{Skill, apart, ids, minus, zeros};

/// The task.
#[derive(Debug)]
struct Door {
    hinge: usize,
    palm: usize,
    handle: usize,
    frame: usize,
}

impl Skill for Door {
    const NAME: &'static str = "AdroitHandDoorEnv";
    const ARM: &'static [ArmJoint] = &[
        ("ARTz", [-0.3, 0.5]),
        ("ARRx", [-0.75, 0.75]),
        ("ARRy", [-0.75, 0.75]),
        ("ARRz", [-1.0, 2.0]),
    ];
    const MODEL: &'static str = include_str!("../../models/adroit_door.xml");
    const CAMERA: [f64; 2] = [1.5, 90.0];
    const CONSTANTS: &'static [(&'static str, usize)] = &[("door_body_pos", 3)];

    fn new(simulation: &Simulation) -> Result<Self> {
        Ok(Self {
            hinge: simulation.model.jnt_qposadr[simulation.joint("door_hinge")?],
            palm: simulation.site("S_grasp")?,
            handle: simulation.site("S_handle")?,
            frame: simulation.body("frame")?,
        })
    }

    fn constants(&self, m: &Model, constants: &mut Vec<f64>) {
        constants.extend(m.body_pos[self.frame]);
    }

    fn draw(&self, constants: &mut [f64], rng: &mut Rng) {
        let ranges = [(-0.3, -0.2), (0.25, 0.35), (0.252, 0.35)];
        for (x, (low, high)) in constants.iter_mut().zip(ranges) {
            *x = rng.uniform(low, high);
        }
    }

    fn apply(&self, constants: &[f64], m: &mut CompiledModel) {
        m.body_pos[self.frame].copy_from_slice(constants);
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        let (angle, palm, handle) = (
            d.qpos[self.hinge],
            d.site_xpos[self.palm],
            d.site_xpos[self.handle],
        );
        let n = d.qpos.len();
        let open = if angle > 1.0 { 1.0 } else { -1.0 };
        let joints = d.qpos[1..n - 2].iter().copied();
        out.extend(
            joints
                .chain([d.qpos[n - 1], angle])
                .chain(palm)
                .chain(handle)
                .chain(minus(palm, handle))
                .chain([open]),
        );
    }

    fn names(&self, names: &mut Naming<'_>) {
        let n = names.model().nq();
        names.positions(1..n - 2).positions(n - 1..);
        names.add(names.position(self.hinge));
        names.xyz("{} of the palm (m)").xyz("{} of the handle (m)");
        names.xyz("{} from handle to palm (m)");
        names.add("1 if the door is open, else -1");
    }

    fn judge(&self, d: &Data) -> (f64, bool) {
        let angle = d.qpos[self.hinge];
        let mut reward = 0.1 * apart(d.site_xpos[self.palm], d.site_xpos[self.handle]);
        reward += -0.1 * (angle - 1.57) * (angle - 1.57);
        reward += -1e-5 * sum_of_squares(d.qvel.len(), |i| d.qvel[i]);
        for (least, bonus) in [(0.2, 2.0), (1.0, 8.0), (1.35, 10.0)] {
            if angle > least {
                reward += bonus;
            }
        }
        (reward, angle >= 1.35)
    }
}

ids!(
    Door,
    "AdroitHandDoor",
    "Undo a latch and open a door with a hand.",
    concat!(
        "{\"qpos\":",
        zeros!(30),
        ",\"qvel\":",
        zeros!(30),
        ",\"door_body_pos\":[-0.25,0.3,0.3]}"
    )
);
