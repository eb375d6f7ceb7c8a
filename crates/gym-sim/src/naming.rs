//! The names of the numbers that a task observes, from the names in its model.

use std::ops::{Bound, RangeBounds};

use gym_core::Names;
use mujoco_engine::Model;
use mujoco_engine::model::{
    BiasType, DynamicsType, GainType, JointType, ObjectType, SensorType, TransmissionType,
};

use crate::viewer::name;

/// The names of an observation under construction: a task adds them part by part, in the order of
/// its numbers in [`SimTask::observe`](crate::SimTask::observe).
#[derive(Debug)]
pub struct Naming<'a> {
    model: &'a Model,
    parts: Vec<(&'static str, Vec<String>)>,
    action: Vec<String>,
}

/// The names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];
/// The names of the numbers of a quaternion.
const QUATERNION: [&str; 4] = ["w", "x", "y", "z"];

/// What a velocity, or a position that is no quaternion, is of.
struct Motion {
    /// The joint; or the body, if it moves in the world along an axis.
    of: String,
    /// Such as ` along x`.
    axis: String,
    turns: bool,
}

impl<'a> Naming<'a> {
    pub(crate) fn new(model: &'a Model) -> Self {
        Self {
            model,
            parts: Vec::new(),
            action: Vec::new(),
        }
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &'a Model {
        self.model
    }

    /// Starts a part of a dict; names that follow are its own. An observation of one part needs no
    /// call.
    pub fn part(&mut self, name: &'static str) -> &mut Self {
        self.parts.push((name, Vec::new()));
        self
    }

    /// Adds a name.
    pub fn add(&mut self, name: impl Into<String>) -> &mut Self {
        if self.parts.is_empty() {
            self.part("observation");
        }
        if let Some((_, names)) = self.parts.last_mut() {
            names.push(name.into());
        }
        self
    }

    /// Adds a name for each word, which replaces `{}` in `text`.
    pub fn each(&mut self, words: &[&str], text: &str) -> &mut Self {
        for word in words {
            self.add(text.replace("{}", word));
        }
        self
    }

    /// Adds a name for each of x, y and z, which replaces `{}` in `text`.
    pub fn xyz(&mut self, text: &str) -> &mut Self {
        self.each(&AXES, text)
    }

    /// Adds the names of a place in m and a quaternion.
    pub fn pose(&mut self, of: &str) -> &mut Self {
        self.xyz(&format!("{{}} of {of} (m)"));
        self.each(&QUATERNION, &format!("quaternion {{}} of {of}"))
    }

    /// Adds the names of positions: of elements of `qpos`.
    pub fn positions(&mut self, range: impl RangeBounds<usize>) -> &mut Self {
        for i in within(range, self.model.nq()) {
            self.add(self.position(i));
        }
        self
    }

    /// Adds the names of velocities: of elements of `qvel`.
    pub fn velocities(&mut self, range: impl RangeBounds<usize>) -> &mut Self {
        for i in within(range, self.model.nv()) {
            self.add(self.velocity(i));
        }
        self
    }

    /// Adds the names of forces of the kind `what` on degrees of freedom.
    pub fn forces(&mut self, what: &str, range: impl RangeBounds<usize>) -> &mut Self {
        for i in within(range, self.model.nv()) {
            let Motion { of, axis, turns } = self.motion(i);
            let (force, unit) = if turns {
                ("torque", "N m")
            } else {
                ("force", "N")
            };
            self.add(format!("{what} {force} on {of}{axis} ({unit})"));
        }
        self
    }

    /// Adds the names of elements of `sensordata`.
    pub fn sensors(&mut self, range: impl RangeBounds<usize>) -> &mut Self {
        for i in within(range, self.model.nsensordata()) {
            self.add(self.sensor(i));
        }
        self
    }

    /// Adds the names of the activations of the actuators that have one: of elements of `act`.
    pub fn activations(&mut self) -> &mut Self {
        for actuator in 0..self.model.nu() {
            if self.model.actuator_actadr[actuator] >= 0 {
                self.add(format!("activation of {}", self.actuator(actuator)));
            }
        }
        self
    }

    /// Adds the name of a function, such as `sine of`, of the number that is called `name`.
    pub fn of(&mut self, function: &str, name: &str) -> &mut Self {
        let plain = name.rsplit_once(" (").map_or(name, |(plain, _)| plain);
        self.add(format!("{function} {plain}"))
    }

    /// Adds the name of a number of an action. Without such names, the numbers are the controls of
    /// the actuators.
    pub fn action(&mut self, name: impl Into<String>) -> &mut Self {
        self.action.push(name.into());
        self
    }

    /// The name of a body.
    #[must_use]
    pub fn body(&self, body: usize) -> String {
        name(self.model, ObjectType::Body, body)
    }

    /// The name of a site.
    #[must_use]
    pub fn site(&self, site: usize) -> String {
        name(self.model, ObjectType::Site, site)
    }

    /// The name of an actuator, or of the joint that it moves.
    #[must_use]
    pub fn actuator(&self, actuator: usize) -> String {
        let own = self.model.name(ObjectType::Actuator, actuator);
        match (own, self.actuated_joint(actuator)) {
            (Some(own), _) => own.to_owned(),
            (None, Some(joint)) => name(self.model, ObjectType::Joint, joint),
            (None, None) => format!("actuator {actuator}"),
        }
    }

    /// The name of an element of `qpos`.
    #[must_use]
    pub fn position(&self, i: usize) -> String {
        let m = self.model;
        let joint = m.jnt_qposadr.partition_point(|first| *first <= i) - 1;
        let k = i - m.jnt_qposadr[joint];
        match m.jnt_type[joint] {
            JointType::Free if k >= 3 => {
                let body = self.body(m.jnt_bodyid[joint]);
                format!("quaternion {} of {body}", QUATERNION[k - 3])
            }
            JointType::Ball => {
                let name = name(m, ObjectType::Joint, joint);
                format!("quaternion {} of {name}", QUATERNION[k])
            }
            _ => {
                let Motion { of, axis, turns } = self.motion(m.jnt_dofadr[joint] + k);
                let (position, unit) = if turns {
                    ("angle", "rad")
                } else {
                    ("position", "m")
                };
                format!("{position} of {of}{axis} ({unit})")
            }
        }
    }

    /// The name of an element of `qvel`.
    #[must_use]
    pub fn velocity(&self, i: usize) -> String {
        let Motion { of, axis, turns } = self.motion(i);
        let (velocity, unit) = if turns {
            ("angular velocity", "rad/s")
        } else {
            ("velocity", "m/s")
        };
        format!("{velocity} of {of}{axis} ({unit})")
    }

    /// The name of an element of `sensordata`.
    #[must_use]
    pub fn sensor(&self, i: usize) -> String {
        let m = self.model;
        let found = (0..m.nsensor()).find(|s| {
            let first = m.sensor_adr[*s];
            (first..first + m.sensor_dim[*s]).contains(&i)
        });
        let Some(sensor) = found else {
            return format!("sensor number {i}");
        };
        let k = i - m.sensor_adr[sensor];
        let id = usize::try_from(m.sensor_objid[sensor]).unwrap_or_default();
        let of = m.name(m.sensor_objtype[sensor], id);
        let of = of.map_or_else(|| format!("object {id}"), str::to_owned);
        let axis = AXES.get(k).copied().unwrap_or_default();
        match m.sensor_type[sensor] {
            SensorType::Touch => format!("force on {of} (N)"),
            SensorType::Accelerometer => format!("acceleration of {of} along its {axis} (m/s²)"),
            SensorType::Velocimeter => format!("velocity of {of} along its {axis} (m/s)"),
            SensorType::Gyro => format!("angular velocity of {of} about its {axis} (rad/s)"),
            SensorType::Force => format!("force on {of} along its {axis} (N)"),
            SensorType::Torque => format!("torque on {of} about its {axis} (N m)"),
            SensorType::Rangefinder => format!("distance from {of} (m)"),
            SensorType::SubtreeLinVel => {
                format!("velocity of the centre of mass of {of} along {axis} (m/s)")
            }
            _ => match &m.names.sensor[sensor] {
                Some(name) if m.sensor_dim[sensor] == 1 => name.clone(),
                Some(name) => format!("{name}, number {k}"),
                None => format!("sensor {sensor}, number {k}"),
            },
        }
    }

    /// What the velocity `dof` is of.
    fn motion(&self, dof: usize) -> Motion {
        let m = self.model;
        let joint = m.dof_jntid[dof];
        let k = dof - m.jnt_dofadr[joint];
        let body = || self.body(m.jnt_bodyid[joint]);
        let name = || name(m, ObjectType::Joint, joint);
        let (of, axis, turns) = match m.jnt_type[joint] {
            JointType::Free if k < 3 => (body(), format!(" along {}", AXES[k]), false),
            JointType::Free => (body(), format!(" about its {}", AXES[k - 3]), true),
            JointType::Ball => (name(), format!(" about its {}", AXES[k]), true),
            kind => {
                let turns = kind == JointType::Hinge;
                let way = if turns { "about" } else { "along" };
                match self.axis_in_world(joint) {
                    Some(axis) => (body(), format!(" {way} {axis}"), turns),
                    None => (name(), String::new(), turns),
                }
            }
        };
        Motion { of, axis, turns }
    }

    /// The axis of a joint of a body that slides in the world, such as the torso of a runner in a
    /// plane; `None` for a joint between bodies, and for one along another line.
    fn axis_in_world(&self, joint: usize) -> Option<&'static str> {
        let m = self.model;
        let body = m.jnt_bodyid[joint];
        let first = usize::try_from(m.body_jntadr[body]).ok()?;
        let mut joints = m.jnt_type[first..first + m.body_jntnum[body]].iter();
        let slides = joints.any(|kind| *kind == JointType::Slide);
        let is_turned = m.body_quat[body] != [1.0, 0.0, 0.0, 0.0];
        if m.body_parentid[body] != 0 || is_turned || !slides {
            return None;
        }
        let unit = |axis: usize| std::array::from_fn(|k| f64::from(u8::from(k == axis)));
        let axis = (0..3).find(|axis| m.jnt_axis[joint] == unit(*axis))?;
        Some(AXES[axis])
    }

    /// The joint that an actuator moves.
    fn actuated_joint(&self, actuator: usize) -> Option<usize> {
        use TransmissionType::{Joint, JointInParent};
        match self.model.actuator_trntype[actuator] {
            Joint | JointInParent => self.model.actuator_trnid[actuator][0].try_into().ok(),
            _ => None,
        }
    }

    /// The name of the control of an actuator.
    fn control(&self, actuator: usize) -> String {
        let (m, name) = (self.model, self.actuator(actuator));
        let joint = self.actuated_joint(actuator);
        let kind = joint.map(|joint| m.jnt_type[joint]);
        let (gain, bias) = (
            m.actuator_gainprm[actuator].0[0],
            m.actuator_biasprm[actuator].0,
        );
        let gear = m.actuator_gear[actuator][0];
        let is_fixed = m.actuator_gaintype[actuator] == GainType::Fixed;
        // the control of an integrated velocity is no position
        let integrates = m.actuator_dyntype[actuator] == DynamicsType::Integrator;
        let turns = kind == Some(JointType::Hinge);
        let moves = turns || kind == Some(JointType::Slide);
        match m.actuator_biastype[actuator] {
            BiasType::None if is_fixed && moves => {
                let (force, unit) = if turns {
                    ("torque", "N m")
                } else {
                    ("force", "N")
                };
                match gain * gear {
                    1.0 => format!("{force} of {name} ({unit})"),
                    most => format!("{force} of {name} ({most} {unit})"),
                }
            }
            BiasType::Affine if is_fixed && gain == -bias[1] && integrates => {
                format!("target velocity of {name}")
            }
            BiasType::Affine if is_fixed && gain == -bias[1] => match (moves, turns) {
                (true, true) if gear == 1.0 => format!("target angle of {name} (rad)"),
                (true, false) if gear == 1.0 => format!("target position of {name} (m)"),
                _ => format!("target of {name}"),
            },
            BiasType::Affine if is_fixed && gain == -bias[2] => {
                format!("target velocity of {name}")
            }
            _ => format!("control of {name}"),
        }
    }

    /// The names, for an action of `actions` numbers. In a dict, the parts are sorted by name.
    pub(crate) fn finish(mut self, is_flat: bool, actions: usize) -> Names {
        if !is_flat {
            self.parts.sort_by_key(|(part, _)| *part);
        }
        if self.action.is_empty() && actions == self.model.nu() {
            self.action = (0..actions).map(|i| self.control(i)).collect();
        }
        Names {
            observation: self
                .parts
                .into_iter()
                .flat_map(|(_, names)| names)
                .collect(),
            action: self.action,
        }
    }
}

/// The indices of `range` below `end`.
fn within(range: impl RangeBounds<usize>, end: usize) -> std::ops::Range<usize> {
    let start = match range.start_bound() {
        Bound::Included(start) => *start,
        Bound::Excluded(start) => start + 1,
        Bound::Unbounded => 0,
    };
    let stop = match range.end_bound() {
        Bound::Included(last) => last + 1,
        Bound::Excluded(stop) => *stop,
        Bound::Unbounded => end,
    };
    start.min(end)..stop.min(end)
}

#[cfg(test)]
mod tests;
