//! Keyframes.

use std::rc::Rc;

use super::{Attached, Spec};
use crate::Result;
use crate::mjcf::xml::{Element, Place};
use crate::model::DynamicsType;

/// A keyframe. Missing parts have the values of the initial configuration.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Key {
    pub(crate) place: Place,
    pub(crate) name: Option<String>,
    pub(crate) time: f64,
    pub(crate) qpos: Option<Vec<f64>>,
    pub(crate) qvel: Option<Vec<f64>>,
    pub(crate) act: Option<Vec<f64>>,
    pub(crate) ctrl: Option<Vec<f64>>,
    pub(crate) mpos: Option<Vec<f64>>,
    pub(crate) mquat: Option<Vec<f64>>,
    /// For a key of an attached model: where its numbers belong.
    pub(crate) stored: Option<Rc<Stored>>,
}

/// The parts of a model to which the numbers in the keys of an attached one belong. All others are as
/// in the initial configuration.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Stored {
    /// Each attached joint: its number, and where its coordinates and velocities are in the key.
    pub(crate) joints: Vec<(usize, usize, usize)>,
    /// Each attached mocap body: its number among these, and in the key.
    pub(crate) mocap: Vec<(usize, usize)>,
    /// The number of the attachment.
    pub(crate) number: usize,
    /// Where the activation of each actuator of the attached model is in the key.
    pub(crate) activations: Vec<Option<usize>>,
    /// How many coordinates, velocities, activations and mocap bodies a key has.
    sizes: [usize; 4],
}

impl Stored {
    /// `start` is the number in `model` of the first attached body.
    pub(crate) fn of(
        spec: &Spec,
        model: &Spec,
        attached: &Attached,
        start: usize,
        number: usize,
    ) -> Self {
        let mut stored = Self {
            number,
            ..Self::default()
        };
        let before = &spec.bodies[..attached.first];
        let mut joint: usize = before.iter().map(|body| body.joints.len()).sum();
        let mut mocap = before.iter().filter(|body| body.mocap).count();
        let [nq, nv, na, nmocap] = &mut stored.sizes;
        for (id, body) in model.bodies.iter().enumerate() {
            let is_part = (start..start + attached.count).contains(&id);
            for of in &body.joints {
                if is_part {
                    stored.joints.push((joint, *nq, *nv));
                    joint += 1;
                }
                *nq += of.kind.nq();
                *nv += of.kind.nv();
            }
            if body.mocap {
                if is_part {
                    stored.mocap.push((mocap, *nmocap));
                    mocap += 1;
                }
                *nmocap += 1;
            }
        }
        for actuator in &model.actuators {
            let active = actuator.dynamics != DynamicsType::None;
            stored.activations.push(active.then_some(*na));
            *na += usize::from(active);
        }
        stored
    }

    /// Checks the lengths of a key's lists.
    pub(crate) fn check(&self, key: &Key) -> Result<()> {
        let [nq, nv, na, nmocap] = self.sizes;
        for (name, list, need) in [
            ("qpos", &key.qpos, nq),
            ("qvel", &key.qvel, nv),
            ("act", &key.act, na),
            ("ctrl", &key.ctrl, self.activations.len()),
            ("mpos", &key.mpos, 3 * nmocap),
            ("mquat", &key.mquat, 4 * nmocap),
        ] {
            let have = list.as_ref().map_or(need, Vec::len);
            if have != need {
                let reason = format!("{have} numbers, and the attached model needs {need}");
                return Err(key.place.attribute(name, reason));
            }
        }
        Ok(())
    }
}

impl Key {
    pub(crate) fn read(mut element: Element<'_, '_>) -> Result<Self> {
        let key = Self {
            place: element.place(),
            name: element.text("name")?,
            time: element.number("time")?.unwrap_or(0.0),
            qpos: element.list("qpos")?,
            qvel: element.list("qvel")?,
            act: element.list("act")?,
            ctrl: element.list("ctrl")?,
            mpos: element.list("mpos")?,
            mquat: element.list("mquat")?,
            stored: None,
        };
        element.finish_without_children()?;
        Ok(key)
    }
}
