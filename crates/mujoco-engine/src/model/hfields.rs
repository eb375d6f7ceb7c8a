//! The height fields of a model.

use serde::{Deserialize, Serialize};

/// The height fields of a model, with the field names of MuJoCo's `mjModel`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Hfields {
    /// Half sizes along x and y, the greatest height, and the depth of the base below 0.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hfield_size: Vec<[f64; 4]>,
    /// Number of points along y.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hfield_nrow: Vec<usize>,
    /// Number of points along x.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hfield_ncol: Vec<usize>,
    /// First elevation of the height field.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hfield_adr: Vec<usize>,
    /// Elevations of all height fields, row by row from the least y, as parts of the greatest
    /// height: 0 to 1.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hfield_data: Vec<f32>,
}
