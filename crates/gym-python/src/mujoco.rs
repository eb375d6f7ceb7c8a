//! The MuJoCo tasks in Python: the arrays of `mjData`, and the parts of their model.

use gym::BoxEnv;
use gym::mujoco::tasks::{self, Simulation};
use gym::mujoco::{Data, Revision, simulated};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The arrays of the state under MuJoCo's names, before the first reset of the initial one; `None`
/// for other environments.
pub(crate) fn data<'py>(py: Python<'py>, env: &BoxEnv) -> PyResult<Option<Bound<'py, PyDict>>> {
    let Some(env) = simulated(env) else {
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
    macro_rules! vectors {
        ($($name:ident)+) => {$(
            arrays.set_item(stringify!($name), PyArray1::from_slice(py, &data.$name))?;
        )+};
    }
    macro_rules! rows {
        ($($name:ident)+) => {$(
            arrays.set_item(stringify!($name), matrix(py, &data.$name)?)?;
        )+};
    }
    vectors!(
        qpos qvel ctrl qacc_warmstart qacc ten_length ten_velocity qfrc_passive qfrc_bias qfrc_actuator qfrc_smooth
        qacc_smooth qfrc_constraint actuator_force
    );
    rows!(
        xpos xquat xmat xipos ximat xanchor xaxis geom_xpos geom_xmat site_xpos site_xmat subtree_com cinert cdof cvel
        cdof_dot cfrc_ext
    );
    Ok(Some(arrays))
}

fn matrix<'py, const N: usize>(
    py: Python<'py>,
    rows: &[[f64; N]],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    PyArray1::from_slice(py, rows.as_flattened()).reshape([rows.len(), N])
}

/// The parts of the model, and its stepping: its source, the text of a built-in one, initial
/// positions, number of velocities, names of bodies, timestep, and the version of MuJoCo with the
/// names of all versions. `None` for other environments.
pub(crate) fn model<'py>(py: Python<'py>, env: &BoxEnv) -> PyResult<Option<Bound<'py, PyDict>>> {
    let Some(env) = simulated(env) else {
        return Ok(None);
    };
    let Simulation {
        model,
        xml_file,
        frame_skip,
        ..
    } = env.simulation();
    let text = tasks::models()
        .find(|(name, _)| name == xml_file)
        .map(|(_, text)| text);
    let facts = PyDict::new(py);
    facts.set_item("xml_file", xml_file)?;
    facts.set_item("xml", text)?;
    facts.set_item("qpos0", PyArray1::from_slice(py, &model.qpos0))?;
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
