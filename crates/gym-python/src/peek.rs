//! The table of an environment's dynamics, in Python.

use gym::{BoxEnv, Env as _, Inspect};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};
use serde_json::Value as Json;

/// Gymnasium's `P` and `initial_state_distrib`, for environments that have them: `{state: {action:
/// [(probability, next state, reward, terminated), ...]}}`, and a list of probabilities.
/// `is_whole`: whether integral rewards have the type `int`.
#[expect(clippy::cast_possible_truncation, reason = "rewards are small numbers")]
pub(crate) fn table<'py>(
    py: Python<'py>,
    env: &BoxEnv,
    is_whole: bool,
) -> PyResult<Option<Bound<'py, PyTuple>>> {
    let Some(table) = env.inspect().and_then(Inspect::table) else {
        return Ok(None);
    };
    let states = PyDict::new(py);
    for (state, row) in table["P"].as_array().into_iter().flatten().enumerate() {
        let actions = PyDict::new(py);
        for (action, outcomes) in row.as_array().into_iter().flatten().enumerate() {
            let outcomes = outcomes.as_array().into_iter().flatten().map(|outcome| {
                let [probability, next, reward, terminated] = [0, 1, 2, 3].map(|i| &outcome[i]);
                let reward = reward.as_f64();
                let whole = reward.filter(|reward| is_whole && reward.fract() == 0.0);
                let reward = match whole {
                    Some(whole) => (whole as i64).into_bound_py_any(py)?,
                    None => reward.into_bound_py_any(py)?,
                };
                (
                    probability.as_f64(),
                    next.as_u64(),
                    reward,
                    terminated.as_bool(),
                )
                    .into_bound_py_any(py)
            });
            let outcomes = PyList::new(py, outcomes.collect::<PyResult<Vec<_>>>()?)?;
            actions.set_item(action, outcomes)?;
        }
        states.set_item(state, actions)?;
    }
    let initial = table["initial_state_distrib"].as_array();
    let initial: Vec<_> = initial.into_iter().flatten().map(Json::as_f64).collect();
    (states, initial).into_pyobject(py).map(Some)
}
