//! Checks of constants that are arguments.

use gym_core::{Error, Result};

/// The largest magnitude of a constant: far beyond physical values, and far below an overflow in
/// one step.
const LIMIT: f64 = 1e6;

/// Refuses constants that are not finite or too large.
pub(crate) fn finite<const N: usize>(env: &str, constants: [(&str, f64); N]) -> Result<()> {
    within(env, constants, -LIMIT)
}

/// Refuses lengths and masses by which the equations divide, if a value is 0 or nearly 0, because
/// the results would not be finite.
pub(crate) fn divisors<const N: usize>(env: &str, constants: [(&str, f64); N]) -> Result<()> {
    finite(env, constants)?;
    for (name, value) in constants {
        if value.abs() < 1.0 / LIMIT {
            let least = 1.0 / LIMIT;
            let reason =
                format!("{name} is {value:?}: its absolute value must be at least {least:?}");
            return Err(Error::argument(env, reason));
        }
    }
    Ok(())
}

/// Refuses lengths and moments of inertia that are negative, 0 or nearly so.
pub(crate) fn positive<const N: usize>(env: &str, constants: [(&str, f64); N]) -> Result<()> {
    for (name, value) in constants {
        let least = 1.0 / LIMIT;
        if value.is_nan() || value < least {
            let reason = format!("{name} is {value:?}: it must be at least {least:?}");
            return Err(Error::argument(env, reason));
        }
    }
    Ok(())
}

/// Refuses limits that are NaN or negative.
pub(crate) fn limits<const N: usize>(env: &str, limits: [(&str, f64); N]) -> Result<()> {
    within(env, limits, 0.0)
}

/// Refuses limits of observations that do not contain every start of an episode.
pub(crate) fn contains_starts<const N: usize>(
    env: &str,
    limits: [(&str, f64); N],
    least: f64,
) -> Result<()> {
    for (name, value) in limits {
        if value < least {
            let reason = format!(
                "{name} is {value:?}: it must be at least {least:?}, because observations at the start of an episode exceed a smaller one"
            );
            return Err(Error::argument(env, reason));
        }
    }
    Ok(())
}

fn within<const N: usize>(env: &str, constants: [(&str, f64); N], low: f64) -> Result<()> {
    for (name, value) in constants {
        if !(low..=LIMIT).contains(&value) {
            let reason = format!("{name} is {value:?}: it must lie between {low:?} and {LIMIT:?}");
            return Err(Error::argument(env, reason));
        }
    }
    Ok(())
}
