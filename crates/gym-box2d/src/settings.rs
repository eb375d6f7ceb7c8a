//! Arguments and versions of the three environments.

use gym_core::{Arguments, Error, Result, arguments};
use serde_json::Value as Json;

/// Returns `config` with the argument `name` set to `value`. Arguments that decide the spaces or
/// the engine cannot be set.
pub(crate) fn assigned<C: Arguments>(
    config: &C,
    name: &str,
    value: Json,
    whose: &str,
) -> Result<C> {
    if matches!(name, "continuous" | "physics") {
        return Err(Error::argument(
            whose,
            format!("{name} is fixed: make a new environment to change it"),
        ));
    }
    arguments::read(
        config,
        u32::MAX,
        &[(name.to_owned(), value)].into_iter().collect(),
        whose,
    )
}

/// Returns the version whose rules apply: versions above 3 use the rules of version 3.
///
/// # Errors
/// [`Error::InvalidArgument`] for a version that never existed.
pub(crate) fn version(env: &str, version: u32) -> Result<u32> {
    match version {
        0 | 1 => {
            let reason = format!(
                "version {version} does not exist: set 2 or 3 with `Registration::version`"
            );
            Err(Error::argument(env, reason))
        }
        _ => Ok(version.min(3)),
    }
}
