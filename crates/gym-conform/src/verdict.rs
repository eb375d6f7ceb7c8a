//! The results of checks.

use std::any::Any;

use gym_core::Error;

/// The result of a check.
pub(crate) type Verdict<T = ()> = std::result::Result<T, Trouble>;

/// The reason why a check did not pass.
pub(crate) enum Trouble {
    /// The rule is broken: the fault, and its place.
    Broken(String),
    /// The check does not apply, or a crate that the check needs is not linked.
    Skipped(String),
    /// A call failed. Another check reports this error.
    Error(Error),
}

impl From<Error> for Trouble {
    fn from(error: Error) -> Self {
        Self::Error(error)
    }
}

pub(crate) fn broken<T>(message: impl Into<String>) -> Verdict<T> {
    Err(Trouble::Broken(message.into()))
}

pub(crate) fn skipped<T>(reason: impl Into<String>) -> Verdict<T> {
    Err(Trouble::Skipped(reason.into()))
}

/// Returns the message of a panic.
pub(crate) fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    format!("it panics with {:?}", text.unwrap_or("no message"))
}
