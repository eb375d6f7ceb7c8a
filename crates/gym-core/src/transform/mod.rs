//! What wrappers of environments and of vectors do to numbers and pictures.

pub(crate) mod affine;
pub(crate) mod area;
pub(crate) mod bins;
pub(crate) mod clip;
pub(crate) mod noise;

use serde_json::Value as Json;

use crate::{Error, Value};

pub use affine::Bound;
pub use bins::Bins;

/// A number as JSON, where infinity is a string as in the stored form of spaces.
pub(crate) fn number_to_json(number: impl Into<Option<f64>>) -> Json {
    number.into().map_or(Json::Null, |x| Value::Float(x).to_json())
}

/// The error of an observation that is none of the space's type.
pub(crate) fn not_an_array(value: &Value) -> Error {
    Error::Contract(format!("{value} should be an array of the space's type"))
}
