//! Keyframes.

use crate::Result;
use crate::mjcf::xml::{Element, Place};

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
        };
        element.finish_without_children()?;
        Ok(key)
    }
}
