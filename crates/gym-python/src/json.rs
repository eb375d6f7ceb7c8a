//! What Python gives as JSON.

use gym::{Error, Kwargs, Reset, Result, Seed};
use pyo3::prelude::*;
use serde::de::DeserializeOwned;

use crate::error::OrRaise;

/// Reads JSON from Python about an id.
pub(crate) fn from_json<T: DeserializeOwned>(id: &str, json: &str) -> PyResult<T> {
    serde_json::from_str(json)
        .map_err(|error| Error::argument(format!("`{id}`"), error.to_string()))
        .or_raise()
}

/// A reset from its Python form.
pub(crate) fn reset_of(seed: Option<&str>, options: Option<&str>) -> Result<Reset> {
    let seed = seed.map(str::parse::<Seed>).transpose()?;
    let options = match options {
        Some(json) => serde_json::from_str(json)
            .map_err(|error| Error::argument("options", error.to_string()))?,
        None => Kwargs::new(),
    };
    Ok(Reset { seed, options })
}
