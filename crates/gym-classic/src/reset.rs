//! Reset options that the environments share.

use gym_core::registry::Exceptions;
use gym_core::{Error, Reset, Result};
use serde::{Deserialize, Deserializer};

/// The largest magnitude of a number of a state: far beyond any episode, and small enough that no
/// equation overflows in one step.
const LIMIT: f64 = 1e6;

/// The conformance exceptions of environments whose options bound the start.
pub(crate) const EXCEPTIONS: Exceptions = &[(
    "options-in-space",
    "bounds of the start may lie beyond an episode, as in Gymnasium",
)];

/// Whether a deserialized state is possible in a task with the default constants. With other
/// constants, such as a mass of 0, a state may be infinite or NaN.
pub(crate) fn plausible(state: &[f64]) -> bool {
    state.iter().all(|x| x.abs() <= LIMIT)
}

/// Checks the value of a reset option: refuses a number from which no episode could start.
pub(crate) fn check(env: &str, name: &str, value: f64) -> Result<f64> {
    if value.abs() <= LIMIT {
        return Ok(value);
    }
    let reason = format!("`{name}` is {value:?}: it must lie within \u{b1}{LIMIT:?}");
    Err(Error::argument(format!("reset options of {env}"), reason))
}

/// Checks a reset option that bounds a number on both sides of 0.
pub(crate) fn check_bound(env: &str, name: &str, value: f64) -> Result<f64> {
    if value >= 0.0 {
        return check(env, name, value);
    }
    let reason = format!(
        "`{name}` is {value:?}: a start between -`{name}` and `{name}` needs a positive number"
    );
    Err(Error::argument(format!("reset options of {env}"), reason))
}

#[derive(Deserialize)]
struct Bounds {
    #[serde(default, deserialize_with = "number")]
    low: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    high: Option<f64>,
}

/// Reads an option that may be missing but not null.
pub(crate) fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    f64::deserialize(deserializer).map(Some)
}

/// Reads the reset options `low` and `high`: the bounds of the initial state.
pub(crate) fn bounds(
    reset: &Reset,
    env: &str,
    default_low: f64,
    default_high: f64,
) -> Result<(f64, f64)> {
    if reset.options.is_empty() {
        return Ok((default_low, default_high));
    }
    let Bounds { low, high } = reset.options(env)?;
    let low = check(env, "low", low.unwrap_or(default_low))?;
    let high = check(env, "high", high.unwrap_or(default_high))?;
    if low > high {
        let reason = format!("lower bound ({low:?}) must be lower than higher bound ({high:?})");
        return Err(Error::argument(format!("reset options of {env}"), reason));
    }
    Ok((low, high))
}
