//! AdroitHandPen: turn a pen in the hand to an orientation.
//!
//! | | |
//! |---|---|
//! | observation | angles of the hand in rad; place of the pen in m, and its velocities; directions of the pen and of the goal; differences of the pen's place from the goal's and of the directions; `Box(45, float64)` |
//! | action | positions of the joints of the hand, as shares of their ranges; `Box(-1, 1, (24,), float32)` |
//! | reward | the cosine of the angle between the directions, minus the distance of the pen from the goal's place in m; plus 10 and 50 within 0.075 m for cosines above 0.9 and 0.95; minus 5 for a pen below 0.075 m. Ids with `Sparse`: 10 within 0.075 m for a cosine above 0.95, else -0.1 |
//! | start | the direction of the goal at random: Euler angles about x and y from -1 to 1 rad |
//! | end | never |
//! | limit | 200 steps of 0.01 s |
//!
//! `info` has `success`, whether the goal is reached as for the sparse reward. The reset option
//! `initial_state_dict` gives `qpos`, `qvel` and `desired_orien`, a quaternion.
//!
//! Differences from Gymnasium-Robotics: all numbers are Gymnasium-Robotics' with the version of
//! MuJoCo that `mujoco` names, for Linux on x86-64. The hand has no visual meshes, and sensors that
//! no observation reads are left out. Dense rewards are numpy's on a CPU for which OpenBLAS has a
//! kernel with AVX2 and none with AVX-512; with such a kernel, lengths differ in the last bit.
//!
//! Actions in the picture are random: no policy was trained for this task, and none is scripted.
//!
//! Source: Gymnasium-Robotics 1.4.2, `envs/adroit_hand/adroit_pen.py`, and the hand of Vikash
//! Kumar's ADROIT.

use gym_core::Result;
use gym_sim::numpy::{inner_avx2, norm_avx2};
use gym_sim::{Naming, Observation, Rng, Simulation};
use mujoco_engine::{CompiledModel, Data, Model};

use super::hand::ArmJoint;
use super::{Skill, apart, ids, minus, zeros};
use crate::rotation::euler_to_quat;

/// The largest difference of a quaternion's length from 1.
const LENGTH: f64 = 1e-3;

/// The task. `userdata` has the lengths of pen and goal.
#[derive(Debug)]
struct Pen {
    pen: usize,
    target: usize,
    place: usize,
    /// The sites at the top and at the bottom of the pen, and of the goal.
    ends: [[usize; 2]; 2],
}

impl Pen {
    /// The directions of pen and goal.
    fn directions(&self, d: &Data) -> [[f64; 3]; 2] {
        std::array::from_fn(|k| {
            let [top, bottom] = self.ends[k].map(|site| d.site_xpos[site]);
            minus(top, bottom).map(|x| x / d.userdata[k])
        })
    }
}

impl Skill for Pen {
    const NAME: &'static str = "AdroitHandPenEnv";
    const ARM: &'static [ArmJoint] = &[];
    const TURNED: &'static str = "0";
    const MODEL: &'static str = include_str!("../../models/adroit_pen.xml");
    const CAMERA: [f64; 2] = [1.0, -45.0];
    const CONSTANTS: &'static [(&'static str, usize)] = &[("desired_orien", 4)];
    const REMEMBERS: usize = 2;

    fn new(simulation: &Simulation) -> Result<Self> {
        let site = |name| simulation.site(name);
        Ok(Self {
            pen: simulation.body("Object")?,
            target: simulation.body("target")?,
            place: site("eps_ball")?,
            ends: [
                [site("object_top")?, site("object_bottom")?],
                [site("target_top")?, site("target_bottom")?],
            ],
        })
    }

    fn constants(&self, m: &Model, constants: &mut Vec<f64>) {
        constants.extend(m.body_quat[self.target]);
    }

    fn draw(&self, constants: &mut [f64], rng: &mut Rng) {
        let euler = [rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), 0.0];
        constants.copy_from_slice(&euler_to_quat(euler));
    }

    fn fault(&self, constants: &[f64]) -> Option<&'static str> {
        let length = norm_avx2(constants);
        let is_one = (length - 1.0).abs() <= LENGTH;
        (!is_one).then_some("`desired_orien` is a quaternion, whose length is 1")
    }

    fn apply(&self, constants: &[f64], m: &mut CompiledModel) {
        m.body_quat[self.target].copy_from_slice(constants);
    }

    fn remember(&self, d: &mut Data) {
        for (k, ends) in self.ends.iter().enumerate() {
            let [top, bottom] = ends.map(|site| d.site_xpos[site]);
            d.userdata[k] = apart(top, bottom);
        }
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        let (place, [direction, goal]) = (d.xpos[self.pen], self.directions(d));
        let joints = d.qpos[..d.qpos.len() - 6].iter().copied();
        let velocities = d.qvel[d.qvel.len() - 6..].iter().copied();
        out.extend(
            joints
                .chain(place)
                .chain(velocities)
                .chain(direction)
                .chain(goal)
                .chain(minus(place, d.site_xpos[self.place]))
                .chain(minus(direction, goal)),
        );
    }

    fn names(&self, names: &mut Naming<'_>) {
        let [nq, nv] = [names.model().nq(), names.model().nv()];
        names.positions(..nq - 6).xyz("{} of the pen (m)");
        names.velocities(nv - 6..);
        names.xyz("{} of the pen's direction");
        names.xyz("{} of the goal's direction");
        names.xyz("{} from the goal to the pen (m)");
        names.xyz("{} of the difference of the directions");
    }

    fn judge(&self, d: &Data) -> (f64, bool) {
        let (place, [direction, goal]) = (d.xpos[self.pen], self.directions(d));
        let distance = apart(place, d.site_xpos[self.place]);
        let similarity = inner_avx2(&direction, &goal);
        let mut reward = -distance + similarity;
        for (least, bonus) in [(0.9, 10.0), (0.95, 50.0)] {
            if distance < 0.075 && similarity > least {
                reward += bonus;
            }
        }
        if place[2] < 0.075 {
            reward -= 5.0;
        }
        (reward, distance < 0.075 && similarity > 0.95)
    }
}

ids!(
    Pen,
    "AdroitHandPen",
    "Turn a pen in a hand to an orientation.",
    concat!(
        "{\"qpos\":",
        zeros!(30),
        ",\"qvel\":",
        zeros!(30),
        ",\"desired_orien\":[1,0,0,0]}"
    )
);
