//! What Python gives as JSON.

use gym::{Error, Kwargs, Reset, Result, Seed};
use pyo3::prelude::*;
use serde::de::DeserializeOwned;

use crate::error::OrRaise;

/// Reads JSON from Python about an id.
pub(crate) fn from_json<T: DeserializeOwned>(id: &str, json: &str) -> PyResult<T> {
    serde_json::from_str(json)
        .map_err(|error| Error::argument(format!("`{id}`"), reason(&error)))
        .or_raise()
}

/// Why JSON cannot be read, without the place: Python's users have not written it.
fn reason(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text
        .rsplit_once(" at line ")
        .map_or(&*text, |(text, _)| text)
    {
        "number out of range" => "a whole number is beyond 1.8e308".into(),
        "recursion limit exceeded" => "lists or dicts are nested more than 126 deep".into(),
        other => other.into(),
    }
}

/// A reset from its Python form.
pub(crate) fn reset_of(seed: Option<&str>, options: Option<&str>) -> Result<Reset> {
    let seed = seed.map(str::parse::<Seed>).transpose()?;
    let options = match options {
        Some(json) => serde_json::from_str(json)
            .map_err(|error| Error::argument("options", reason(&error)))?,
        None => Kwargs::new(),
    };
    Ok(Reset { seed, options })
}
