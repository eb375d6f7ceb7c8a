//! Pictures of a model: a camera, and shaded shapes on a canvas.

use gym_core::canvas::Canvas;
use gym_core::{Error, Result};
use serde::{Deserialize, Serialize};

use crate::tasks::Common;
use crate::{Data, Model};

/// Where a free camera is, in the names of MuJoCo's `mjvCamera`; what is absent is computed from the model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CameraConfig {
    /// Distance from the point that it looks at, in m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// Direction in the horizontal plane, in degrees; at 90 x is to the right.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<f64>,
    /// Direction to the vertical, in degrees; negative from above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elevation: Option<f64>,
    /// The point that it looks at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lookat: Option<[f64; 3]>,
    /// The body that it follows; -1 for none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trackbodyid: Option<i32>,
}

/// From where a model is seen.
#[derive(Clone, Debug)]
pub(crate) struct View {}

impl View {
    pub(crate) fn new(_model: &Model, _arguments: &Common) -> Result<Self> {
        let _ = Error::custom("");
        Ok(Self {})
    }

    pub(crate) fn draw(
        &self,
        _model: &Model,
        _data: &Data,
        _followed: Option<usize>,
        _size: (u32, u32),
        _canvas: &mut dyn Canvas,
    ) {
    }
}
