//! The MuJoCo tasks in Python: the arrays of `mjData`, and the parts of their model.

use gym::sim::engine::{Data, Revision};
use gym::sim::{SimEnv, Simulation};
use gym::{BoxEnv, EnvExt, mujoco};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// The arrays of the state under MuJoCo's names (before the first reset, of the initial state);
/// `None` for other environments.
pub(crate) fn data<'py>(py: Python<'py>, env: &BoxEnv) -> PyResult<Option<Bound<'py, PyDict>>> {
    let Some(env) = env.layer::<SimEnv>() else {
        return Ok(None);
    };
    let initial;
    let data = match env.data() {
        Some(data) => data,
        None => {
            initial = Data::new(&env.simulation().model);
            &initial
        }
    };
    let arrays = PyDict::new(py);
    arrays.set_item("time", data.time)?;
    macro_rules! set {
        ($array:ident: $($name:ident)+) => {$(
            arrays.set_item(stringify!($name), $array(py, &data.$name)?)?;
        )+};
    }
    set!(vector: qpos qvel ctrl qacc_warmstart qacc ten_length ten_velocity qfrc_passive qfrc_bias qfrc_actuator qfrc_smooth
        qacc_smooth qfrc_constraint actuator_force
    );
    set!(matrix: xpos xquat xmat xipos ximat xanchor xaxis geom_xpos geom_xmat site_xpos site_xmat subtree_com cinert cdof cvel
        cdof_dot cfrc_ext
    );
    Ok(Some(arrays))
}

/// The names of the built-in models.
#[pyfunction]
pub(crate) fn mujoco_models() -> Vec<&'static str> {
    mujoco::models().map(|(name, _)| name).collect()
}

/// Returns whether the last call of the engine was a step, the state before the call, and the state
/// after the step. `None` before the first reset, and for other environments.
pub(crate) fn before<'py>(py: Python<'py>, env: &BoxEnv) -> PyResult<Option<Bound<'py, PyTuple>>> {
    let Some(data) = env.layer::<SimEnv>().and_then(SimEnv::data) else {
        return Ok(None);
    };
    let dict = |arrays: &[(&str, &[f64])]| {
        let dict = PyDict::new(py);
        let mut filled = arrays.iter().filter(|(_, numbers)| !numbers.is_empty());
        filled.try_for_each(|(name, numbers)| match (*name, *numbers) {
            ("time", [time]) => dict.set_item("time", time),
            (name, numbers) => dict.set_item(name, PyArray1::from_slice(py, numbers)),
        })?;
        PyResult::Ok(dict)
    };
    let now: [(_, &[f64]); 4] = [
        ("time", std::slice::from_ref(&data.time)),
        ("qpos", &data.qpos),
        ("qvel", &data.qvel),
        ("qacc_warmstart", &data.qacc_warmstart),
    ];
    let start = match data.start() {
        Some(start) => dict(&start)?,
        None => dict(&now)?,
    };
    (data.is_stepped(), start, dict(&now)?)
        .into_pyobject(py)
        .map(Some)
}

fn vector<'py>(py: Python<'py>, numbers: &[f64]) -> PyResult<Bound<'py, PyArray1<f64>>> {
    Ok(PyArray1::from_slice(py, numbers))
}

fn matrix<'py, const N: usize>(
    py: Python<'py>,
    rows: &[[f64; N]],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    PyArray1::from_slice(py, rows.as_flattened()).reshape([rows.len(), N])
}

/// The model: its source, its XML unless it is a file's, initial positions, number of velocities,
/// names of bodies, timestep, and the version of MuJoCo with the names of all versions. `None` for
/// other environments.
pub(crate) fn model<'py>(py: Python<'py>, env: &BoxEnv) -> PyResult<Option<Bound<'py, PyDict>>> {
    let Some(env) = env.layer::<SimEnv>() else {
        return Ok(None);
    };
    let simulation = env.simulation();
    let Simulation {
        model,
        xml_file,
        frame_skip,
        ..
    } = simulation;
    let built_in = || mujoco::models().find(|(name, _)| name == xml_file);
    let text = match xml_file.starts_with('<') {
        true => Some(&**xml_file),
        false => built_in().map(|(_, text)| text),
    };
    let facts = PyDict::new(py);
    facts.set_item("xml_file", xml_file)?;
    facts.set_item("xml", text)?;
    facts.set_item(
        "init_qpos",
        PyArray1::from_slice(py, simulation.initial_qpos()),
    )?;
    facts.set_item(
        "init_qvel",
        PyArray1::from_vec(py, simulation.initial_qvel()),
    )?;
    facts.set_item("nv", model.nv())?;
    facts.set_item("bodies", &model.names.body)?;
    facts.set_item("timestep", model.opt.timestep)?;
    facts.set_item("frame_skip", frame_skip)?;
    facts.set_item("mujoco", model.revision.name())?;
    let versions = PyDict::new(py);
    for revision in Revision::ALL {
        versions.set_item(revision.name(), revision.versions())?;
    }
    facts.set_item("versions", versions)?;
    Ok(Some(facts))
}
