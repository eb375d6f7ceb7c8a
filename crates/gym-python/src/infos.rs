//! The infos of a vector in Gymnasium's form: columns in Gymnasium's order, each followed by its
//! mask.

use gym::{BoxEnv, Env as _, EnvExt as _, EnvSpec, Info, Value};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{new_array, numpy, to_python};
use crate::registry;

/// In `SameStep` mode: the keys that come before those of the environments.
const FINAL: [&str; 2] = ["final_obs", "final_info"];

/// Adds the columns with the keys of `order`, then the others; a mask follows each column.
pub(crate) fn ordered<'py>(
    py: Python<'py>,
    infos: &Info,
    order: &[String],
    dict: &Bound<'py, PyDict>,
) -> PyResult<()> {
    let known = FINAL
        .into_iter()
        .chain(order.iter().map(String::as_str))
        .filter(|key| infos.contains_key(*key));
    let is_mask = |key: &str| {
        key.strip_prefix('_')
            .is_some_and(|key| infos.contains_key(key))
    };
    let others = infos.keys().map(String::as_str).filter(|key| {
        !is_mask(key) && !FINAL.contains(key) && !order.iter().any(|known| known == key)
    });
    for key in known.chain(others) {
        let column = match &infos[key] {
            Value::Dict(entries) => {
                let inner: Info = entries.clone().into_iter().collect();
                let dict = PyDict::new(py);
                ordered(py, &inner, order, &dict)?;
                dict.into_any()
            }
            column => column_to_python(py, column)?,
        };
        dict.set_item(key, column)?;
        let mask = format!("_{key}");
        if let Some(column) = infos.get(&mask) {
            dict.set_item(mask, column_to_python(py, column)?)?;
        }
    }
    Ok(())
}

/// The keys of an environment's `info` in their order, after a reset and after a step. Both are
/// empty if the environment cannot be made or stepped here.
pub(crate) fn info_keys(spec: &EnvSpec) -> [Vec<String>; 2] {
    let mut keys = [Vec::new(), Vec::new()];
    let made = registry::bare(
        &spec.id,
        spec.kwargs.clone(),
        None,
        spec.additional_wrappers.clone(),
    );
    let Ok(mut env) = made else { return keys };
    let Ok(action) = env.action_space().zero() else {
        return keys;
    };
    let seen = |env: &BoxEnv, keys: &mut Vec<String>| {
        env.info(&mut |key, _| keys.push(key.to_owned()));
    };
    if env.reset(0).is_ok() {
        seen(&env, &mut keys[0]);
        if env.step(&action).is_ok() {
            seen(&env, &mut keys[1]);
        }
    }
    let [reset, step] = &mut keys;
    let missing = |of: &[String], from: &[String]| -> Vec<String> {
        from.iter()
            .filter(|key| !of.contains(key))
            .cloned()
            .collect()
    };
    let (more, less) = (missing(reset, step), missing(step, reset));
    reset.extend(more);
    step.extend(less);
    keys
}

/// A column of infos in Python: an array for flags and numbers, a dict of columns for a dict, else
/// an array of objects.
fn column_to_python<'py>(py: Python<'py>, column: &Value) -> PyResult<Bound<'py, PyAny>> {
    match column {
        Value::Tuple(items) => {
            let flags: Option<Vec<bool>> = items.iter().map(Value::as_bool).collect();
            if let Some(flags) = flags {
                return Ok(new_array(py, &[flags.len()], &flags));
            }
            let objects = numpy(py)?.call_method1("empty", (items.len(), "O"))?;
            for (i, item) in items.iter().enumerate() {
                objects.set_item(i, to_python(py, item)?)?;
            }
            Ok(objects)
        }
        Value::Dict(entries) => {
            let dict = PyDict::new(py);
            for (key, column) in entries {
                dict.set_item(key, column_to_python(py, column)?)?;
            }
            Ok(dict.into_any())
        }
        other => to_python(py, other),
    }
}
