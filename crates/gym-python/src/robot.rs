//! Models as the page of `rustgym.view` takes them: compiled, as JSON.

use gym::sim::SimEnv;
use gym::sim::engine::{CompiledModel, Data, Model, Revision};
use gym::{BoxEnv, EnvExt, Error, Result};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::{OrRaise, guard};

/// The keyframe that holds the state of an environment.
const NOW: &str = "now";

/// The model of a file in MJCF or, if `is_text`, of a text, for a version of MuJoCo.
#[pyfunction]
pub(crate) fn compiled_model<'py>(
    py: Python<'py>,
    source: &str,
    is_text: bool,
    mujoco: Option<&str>,
) -> PyResult<Bound<'py, PyBytes>> {
    let compile = || {
        let revision = match mujoco {
            Some(version) => version
                .parse::<Revision>()
                .map_err(|error| Error::argument("mujoco", error.to_string()))?,
            None => Revision::default(),
        };
        let model = if is_text {
            Model::from_xml_with(source, revision)
        } else {
            Model::from_path_with(source, revision)
        };
        let wrong =
            |error: gym::sim::engine::Error| Error::argument("model_or_env", error.to_string());
        let model = model.map_err(wrong)?;
        to_json(&model)
    };
    let bytes = py.detach(|| guard(|| compile().or_raise()))?;
    Ok(PyBytes::new(py, &bytes))
}

/// The model of an environment, with its state as the keyframe `now`; `None` if it has no model.
pub(crate) fn of_env<'py>(py: Python<'py>, env: &BoxEnv) -> PyResult<Option<Bound<'py, PyBytes>>> {
    let Some(env) = env.layer::<SimEnv>() else {
        return Ok(None);
    };
    let model = &env.simulation().model;
    let initial;
    let data = match env.data() {
        Some(data) => data,
        None => {
            initial = Data::new(model);
            &initial
        }
    };
    let mut model = CompiledModel::clone(model);
    add_key(&mut model, data);
    let bytes = guard(|| to_json(&model).or_raise())?;
    Ok(Some(PyBytes::new(py, &bytes)))
}

/// Adds a keyframe with the state; it replaces one of the same name.
fn add_key(m: &mut CompiledModel, data: &Data) {
    let known = m
        .names
        .key
        .iter()
        .position(|name| name.as_deref() == Some(NOW));
    if let Some(key) = known {
        m.names.key[key] = None;
    }
    m.names.key.resize(m.key_qpos.len(), None);
    m.names.key.push(Some(NOW.to_owned()));
    m.key_time.push(data.time);
    m.key_qpos.push(data.qpos.clone());
    m.key_qvel.push(data.qvel.clone());
    m.key_act.push(data.act.clone());
    m.key_ctrl.push(data.ctrl.clone());
    m.key_mpos.push(data.mocap_pos.as_flattened().to_vec());
    m.key_mquat.push(data.mocap_quat.as_flattened().to_vec());
}

fn to_json(model: &CompiledModel) -> Result<Vec<u8>> {
    serde_json::to_vec(model).map_err(|error| Error::custom(error.to_string()))
}
