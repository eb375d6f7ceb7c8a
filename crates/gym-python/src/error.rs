//! Errors and panics as Python exceptions.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use gym::{Error, Result};
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    rustgym,
    PanicError,
    PyRuntimeError,
    "A bug: the Rust code of an environment panicked. The environment can be used again after `reset`."
);

/// Runs `f`. A panic in it becomes a [`PanicError`]; pyo3 would raise a `BaseException`.
pub(crate) fn guard<T>(f: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(f))
        .unwrap_or_else(|panic| Err(PanicError::new_err(message(&*panic).to_owned())))
}

/// The message of a panic.
fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no message")
}

/// Converts a Rust `Result` to Python's.
pub(crate) trait OrRaise<T> {
    /// Raises the exception that Gymnasium has for the error, with this error's text.
    fn or_raise(self) -> PyResult<T>;
}

impl<T> OrRaise<T> for Result<T> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(|error| Python::attach(|py| exception(py, &error)))
    }
}

/// The text of an error, in Python's terms.
fn text(error: &Error) -> String {
    match error {
        Error::SubEnvironment { index, source } => {
            format!("sub-environment {index}: {}", text(source))
        }
        Error::ResetNeeded(call) => {
            format!("cannot call `{call}` before `reset`: call `reset(seed=0)` first")
        }
        Error::InvalidArgument { .. } => {
            WORDS.iter().fold(error.to_string(), |text, (ours, words)| {
                text.replace(ours, words)
            })
        }
        // linking crates is advice for Rust users
        _ => error
            .to_string()
            .split(" (linked crates")
            .next()
            .unwrap_or_default()
            .replace(
                "`reset_into` with a mask",
                "`reset` with the option `reset_mask`",
            ),
    }
}

/// Words of JSON and the operating system, and their replacements in Python's terms.
const WORDS: [(&str, &str); 14] = [
    (
        " (NaN and infinite numbers become null: give a finite number)",
        "",
    ),
    ("invalid type: null", "invalid type: None"),
    ("expected a sequence", "expected a list"),
    ("expected an array of length", "expected a list of length"),
    ("expected fewer elements in array", "expected fewer"),
    ("expected a boolean", "expected True or False"),
    ("expected path string", "expected a text"),
    ("expected a string", "expected a text"),
    ("unknown variant", "unknown value"),
    (" (os error 2)", ""),
    (" (os error 13)", ""),
    ("recv_into", "recv"),
    (
        "expected a whole number, or a list of two, [low, high]",
        "expected a whole number, or a pair of them, (low, high)",
    ),
    (
        "expected a list of a value for each environment, or the range {\"low\": ..., \"high\": ...}",
        "expected a value for each environment, or a pair of numbers, (low, high)",
    ),
];

fn exception(py: Python<'_>, error: &Error) -> PyErr {
    let text = text(error);
    match class(error) {
        Class::Value => PyValueError::new_err(text),
        Class::Gymnasium(name) => gymnasium(py, name, text),
    }
}

/// The exception `gymnasium.error.NAME`, or this package's subclass of it.
pub(crate) fn gymnasium(py: Python<'_>, name: &str, text: String) -> PyErr {
    let module = match name {
        "InvalidAction" | "InvalidArgument" | "ResetNeeded" => "rustgym._errors",
        _ => "gymnasium.error",
    };
    let raised = py
        .import(module)
        .and_then(|module| module.getattr(name)?.call1((text,)));
    raised.map_or_else(|error| error, PyErr::from_value)
}

enum Class {
    Value,
    Gymnasium(&'static str),
}

fn class(error: &Error) -> Class {
    Class::Gymnasium(match error {
        Error::InvalidSpace(_) | Error::Snapshot(_) => return Class::Value,
        Error::InvalidArgument { .. } => "InvalidArgument",
        Error::SubEnvironment { source, .. } => return class(source),
        Error::NamespaceNotFound { .. } => "NamespaceNotFound",
        Error::NameNotFound { .. } => "NameNotFound",
        Error::VersionNotFound { .. } => "VersionNotFound",
        Error::DeprecatedVersion { .. } => "DeprecatedEnv",
        Error::Registration { .. } | Error::Duplicate { .. } => "RegistrationError",
        Error::InvalidAction { .. } | Error::NotInSpace { .. } => "InvalidAction",
        Error::ResetNeeded(_) => "ResetNeeded",
        Error::Closed(_) => "ClosedEnvironmentError",
        Error::UnsupportedMode { .. } => "UnsupportedMode",
        _ => "Error",
    })
}
