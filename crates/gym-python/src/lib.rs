//! `rustgym._native`: environments, vectors and the registry, as the Python part of the package
//! sees them.
//!
//! Gymnasium's interface is written in Python, in `python/rustgym`: the results of a reset, the
//! exceptions, the registration of specs. This crate exchanges numpy arrays, numbers, and
//! descriptions as JSON with it.
//!
//! Ids, arguments, spaces and metadata come from the registry as JSON, so a new family needs no
//! code here. A `Mutex` protects an environment, because `BoxEnv` is only `Send`. A thread that
//! waits for it releases the GIL.

mod action;
mod atari;
mod convert;
mod env;
mod error;
#[cfg(feature = "faults")]
mod faults;
mod fork;
mod goals;
mod history;
mod infos;
mod json;
mod mujoco;
mod numbers;
mod peek;
mod registry;
mod robot;
mod vector;

/// The extension module.
#[pyo3::pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        gym::math::requested_level().map_err(pyo3::exceptions::PyValueError::new_err)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }

    #[pymodule_export]
    use crate::atari::{Ale, AleState};
    #[pymodule_export]
    use crate::env::Env;
    #[pymodule_export]
    use crate::error::PanicError;
    #[pymodule_export]
    use crate::fork::after_fork_in_child;
    #[pymodule_export]
    use crate::mujoco::mujoco_models;
    #[pymodule_export]
    use crate::registry::{describe, generate_random_map, specs};
    #[pymodule_export]
    use crate::robot::compiled_model;
    #[pymodule_export]
    use crate::vector::Vector;
}
