//! Actions of a single environment, and the errors of Gymnasium's environments for invalid actions.

use gym::registry::find;
use gym::{Space, Value};
use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::convert::{action_from_python, numpy};
use crate::error::gymnasium;

/// How Gymnasium's environment checks an action.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Check {
    /// Requires an element of the action space.
    Element,
    /// Looks up the action in a table, so any object that equals an element is accepted.
    Equal,
    /// Requires the shape of the action space.
    Shape,
    /// Takes numbers beyond the last action as 0.
    Beyond,
}

impl Check {
    /// Returns the check of the environment `id`.
    pub(crate) fn of(id: &str) -> Self {
        match find(id).map_or("", |registration| registration.source.package) {
            "gym-toytext" if !id.starts_with("Blackjack") => Self::Equal,
            "gym-mujoco" => Self::Shape,
            "gym-minigrid" if id.starts_with("MiniGrid-Dynamic-Obstacles-") => Self::Beyond,
            _ => Self::Element,
        }
    }

    /// An element of the action space from Python.
    pub(crate) fn action(self, space: &Space, action: &Bound<'_, PyAny>) -> PyResult<Value> {
        if matches!(self, Self::Beyond)
            && let Some(first) = beyond(space, action)
        {
            return Ok(first);
        }
        action_from_python(space, None, action).or_else(|error| match self {
            Self::Equal => equal(space, action).ok_or_else(|| refused(space, action, &error)),
            Self::Shape => {
                Err(mismatch(space, action).unwrap_or_else(|| refused(space, action, &error)))
            }
            Self::Beyond | Self::Element => Err(refused(space, action, &error)),
        })
    }
}

/// Returns the action that equals `action`, such as 1 for `1.0` and `np.True_`.
fn equal(space: &Space, action: &Bound<'_, PyAny>) -> Option<Value> {
    let Space::Discrete(space) = space else {
        return None;
    };
    let array = action.cast::<PyUntypedArray>();
    if array.is_ok_and(|array| array.ndim() > 0) {
        return None;
    }
    let mut actions = space.start()..space.start() + space.n();
    let found = actions.find(|number| action.eq(number).unwrap_or(false));
    found.map(Value::Int)
}

/// Returns the action 0 if `action` is greater than the last action.
fn beyond(space: &Space, action: &Bound<'_, PyAny>) -> Option<Value> {
    let Space::Discrete(space) = space else {
        return None;
    };
    let is_beyond = action.gt(space.last()).unwrap_or(false);
    is_beyond.then_some(Value::Int(0))
}

/// The error for an action of another shape, which Gymnasium's MuJoCo tasks compare first.
fn mismatch(space: &Space, action: &Bound<'_, PyAny>) -> Option<PyErr> {
    let py = action.py();
    let expected = PyTuple::new(py, space.shape()?).ok()?;
    let found = numpy(py).ok()?.call_method1("shape", (action,)).ok()?;
    if found.eq(&expected).ok()? {
        return None;
    }
    let text = format!("Action dimension mismatch. Expected {expected}, found {found}");
    Some(PyValueError::new_err(text))
}

fn refused(space: &Space, action: &Bound<'_, PyAny>, error: &PyErr) -> PyErr {
    let py = action.py();
    let brief = py
        .import("rustgym._json")
        .and_then(|module| module.getattr("brief")?.call1((action,)));
    let shown = brief.map_or_else(|_| "?".to_owned(), |text| text.to_string());
    let reason = error.value(py);
    let text = format!("invalid action {shown}: the action space is {space} ({reason})");
    gymnasium(py, "InvalidAction", text)
}
