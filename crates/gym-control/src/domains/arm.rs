//! The arm in the domains manipulator and stacker.

use std::f64::consts::PI;

use gym_core::{Result, math};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::{minus, norm};
use gym_sim::{Naming, Observation, Simulation, Start};

/// Returns the text of the model, with the bodies `props`, and the pairs of bodies without contacts
/// `apart`.
pub(super) fn text(solref: f64, props: &str, apart: &str) -> String {
    include_str!("../../models/arm.xml")
        .replace("{solref}", &solref.to_string())
        .replace("{props}", props)
        .replace("{apart}", apart)
}

/// The derived arrays that tasks read.
pub(super) const READS: [Derived; 4] = [
    Derived::Xpos,
    Derived::Xquat,
    Derived::SiteXpos,
    Derived::Sensors(5),
];

/// The joints of the arm, in the order in which the task draws and observes them.
const JOINTS: [&str; 8] = [
    "arm_root",
    "arm_shoulder",
    "arm_elbow",
    "arm_wrist",
    "finger",
    "fingertip",
    "thumb",
    "thumbtip",
];
const FINGER: usize = 4;
const THUMB: usize = 6;

/// The observed joints, sensors and hand of the arm.
#[derive(Clone, Debug)]
pub(super) struct Arm {
    joints: [usize; 8],
    hand: usize,
    touch: [usize; 5],
}

impl Arm {
    /// Finds the arm in a model. `touch` names the touch sensors in the order of the observation.
    pub(super) fn new(s: &Simulation, touch: [&str; 5]) -> Result<Self> {
        let mut found = [0; 8];
        for (id, name) in found.iter_mut().zip(JOINTS) {
            *id = s.joint(name)?;
        }
        let mut sensors = [0; 5];
        for (adr, name) in sensors.iter_mut().zip(touch) {
            *adr = s.model.sensor_adr[s.sensor(name)?];
        }
        Ok(Self {
            joints: found,
            hand: s.body("hand")?,
            touch: sensors,
        })
    }

    /// Draws the joints' positions. The finger gets the thumb's position.
    pub(super) fn start(&self, start: &mut Start<'_>) {
        let place = |start: &Start<'_>, i: usize| start.model().jnt_qposadr[self.joints[i]];
        for (i, &joint) in self.joints.iter().enumerate() {
            let [low, high] = if start.model().jnt_limited[joint] {
                start.model().jnt_range[joint]
            } else {
                [-PI, PI]
            };
            let place = place(start, i);
            start.data.qpos[place] = start.uniform(low, high);
        }
        let (finger, thumb) = (place(start, FINGER), place(start, THUMB));
        start.data.qpos[finger] = start.data.qpos[thumb];
    }

    /// Observes `arm_pos`, `arm_vel` and `touch`.
    pub(super) fn observe(&self, m: &Model, d: &Data, out: &mut Observation) {
        let turns = self.joints.map(|j| {
            let (sin, cos) = math::sin_cos(d.qpos[m.jnt_qposadr[j]]);
            [sin, cos]
        });
        out.rows("arm_pos", turns);
        out.vector("arm_vel", self.joints.map(|j| d.qvel[m.jnt_dofadr[j]]));
        out.vector(
            "touch",
            self.touch.map(|i| math::numpy_ln_1p(d.sensordata[i])),
        );
    }

    /// Names what [`observe`](Self::observe) observes.
    pub(super) fn names(&self, names: &mut Naming<'_>) {
        let m = names.model();
        names.part("arm_pos");
        for joint in self.joints {
            for function in ["sine of", "cosine of"] {
                names.of(function, &names.position(m.jnt_qposadr[joint]));
            }
        }
        names.part("arm_vel");
        for joint in self.joints {
            names.add(names.velocity(m.jnt_dofadr[joint]));
        }
        names.part("touch");
        for sensor in self.touch {
            names.of("logarithm of 1 N plus", &names.sensor(sensor));
        }
    }

    /// Observes `hand_pos`.
    pub(super) fn observe_hand(&self, d: &Data, out: &mut Observation) {
        out.vector("hand_pos", pose(d, self.hand));
    }

    /// Names what [`observe_hand`](Self::observe_hand) observes.
    pub(super) fn name_hand(&self, names: &mut Naming<'_>) {
        name_pose(names.part("hand_pos"), self.hand);
    }
}

/// Returns the position of a body in the plane (x, z), and its orientation (w and y of the
/// quaternion).
pub(super) fn pose(d: &Data, body: usize) -> [f64; 4] {
    let (pos, quat) = (d.xpos[body], d.xquat[body]);
    [pos[0], pos[2], quat[0], quat[2]]
}

/// Adds the names of a [`pose`].
pub(super) fn name_pose(names: &mut Naming<'_>, body: usize) {
    let body = names.body(body);
    names.each(&["x", "z"], &format!("{{}} of {body} (m)"));
    names.each(&["w", "y"], &format!("quaternion {{}} of {body}"));
}

/// Returns the distance between two sites.
pub(super) fn distance(d: &Data, from: usize, to: usize) -> f64 {
    norm(minus(d.site_xpos[from], d.site_xpos[to]))
}

/// Returns the quaternion of the rotation by `angle` about the y axis.
pub(super) fn turned(angle: f64) -> [f64; 4] {
    [math::cos(angle / 2.0), 0.0, math::sin(angle / 2.0), 0.0]
}
