//! The infos of a vector as Gymnasium has them: columns in an order, each followed by its mask.

use gym::{BoxEnv, Env as _, EnvExt as _, EnvSpec, Info, Value};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::convert::{new_array, numpy, to_python};
use crate::numbers::Numbers;
use crate::registry;

/// The keys of a vector with `SameStep` autoreset for environments that ended.
const FINAL: [&str; 2] = ["final_obs", "final_info"];

/// A key of infos, and the key of its mask.
#[derive(Debug)]
pub(crate) struct Key {
    name: String,
    mask: String,
    python: [Py<PyString>; 2],
}

impl Key {
    fn new(py: Python<'_>, name: &str) -> Self {
        let mask = format!("_{name}");
        let python = [name, &mask].map(|text| PyString::intern(py, text).unbind());
        let name = name.to_owned();
        Self { name, mask, python }
    }
}

/// Adds the columns with the keys of `order`, then all others; each is followed by its mask.
/// `numbers` has the types of the numbers, and whether the actions were `float32`.
pub(crate) fn ordered<'py>(
    py: Python<'py>,
    infos: &Info,
    order: &[Key],
    numbers: (&Numbers, bool),
    dict: &Bound<'py, PyDict>,
) -> PyResult<()> {
    let add = |key: &Key| -> PyResult<usize> {
        let Some(column) = infos.get(&key.name) else {
            return Ok(0);
        };
        let [name, mask] = &key.python;
        dict.set_item(name, typed_column(py, &key.name, column, order, numbers)?)?;
        let Some(column) = infos.get(&key.mask) else {
            return Ok(1);
        };
        dict.set_item(mask, column_to_python(py, column)?)?;
        Ok(2)
    };
    let ended = infos
        .contains_key(FINAL[0])
        .then(|| FINAL.map(|key| Key::new(py, key)));
    // Gymnasium adds the infos of one environment after another, and those of its end before those of its reset
    let first_end = ended.as_ref().map_or(0, |[key, _]| first(infos, key));
    let is_before = |key: &&Key| first_end > 0 && first(infos, key) < first_end;
    let before = order.iter().filter(is_before);
    let after = order.iter().filter(|key| !is_before(key));
    let mut added = 0;
    for key in before.chain(ended.iter().flatten()).chain(after) {
        added += add(key)?;
    }
    if added < infos.len() {
        let is_known = |key: &str| {
            let is_mask = key
                .strip_prefix('_')
                .is_some_and(|key| infos.contains_key(key));
            is_mask || FINAL.contains(&key) || order.iter().any(|known| known.name == key)
        };
        for key in infos.keys().filter(|key| !is_known(key)) {
            add(&Key::new(py, key))?;
        }
    }
    Ok(())
}

/// The first environment that has the key, or a number that is larger than any.
fn first(infos: &Info, key: &Key) -> usize {
    match infos.get(&key.mask) {
        Some(Value::Tuple(flags)) => flags.iter().position(|flag| flag.as_bool() == Some(true)),
        _ => None,
    }
    .unwrap_or(usize::MAX)
}

/// A column of infos with the type of its numbers, or a dict of columns.
fn typed_column<'py>(
    py: Python<'py>,
    key: &str,
    column: &Value,
    order: &[Key],
    (numbers, is_single): (&Numbers, bool),
) -> PyResult<Bound<'py, PyAny>> {
    if let Value::Dict(entries) = column {
        let inner: Info = entries.clone().into_iter().collect();
        let dict = PyDict::new(py);
        ordered(py, &inner, order, (numbers, is_single), &dict)?;
        return Ok(dict.into_any());
    }
    match numbers.column(py, key, column, is_single) {
        Some(column) => Ok(column),
        None => column_to_python(py, column),
    }
}

/// Returns the keys of an environment's `info` after a reset and after a step, each in the
/// environment's order. Returns no keys for an environment that cannot be made or stepped.
pub(crate) fn info_keys(py: Python<'_>, spec: &EnvSpec) -> [Vec<Key>; 2] {
    found_keys(spec).map(|keys| keys.iter().map(|key| Key::new(py, key)).collect())
}

fn found_keys(spec: &EnvSpec) -> [Vec<String>; 2] {
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

/// Converts a column of infos. Flags and numbers become arrays of their types, a dict becomes a
/// dict of columns, and other values become an array of objects.
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
