//! The cores to which the threads of a vector can be bound.

use crate::value::{Error, Result};

/// A core that the program may use.
#[derive(Clone, Copy, Debug)]
pub(super) struct Core(#[cfg(not(target_family = "wasm"))] core_affinity::CoreId);

/// The cores that the program may use, from number `first` on, around the end.
///
/// # Errors
/// [`Error::InvalidArgument`] if there is no such core, [`Error::Custom`] if the operating system
/// does not tell the cores.
pub(super) fn from(first: usize) -> Result<Vec<Core>> {
    let mut cores = all().filter(|cores| !cores.is_empty()).ok_or_else(cannot)?;
    let n = cores.len();
    if first >= n {
        let reason = format!(
            "affinity is {first}: this program may use {n} cores, 0 to {}",
            n - 1
        );
        return Err(Error::argument("an async vector", reason));
    }
    cores.rotate_left(first);
    Ok(cores)
}

fn all() -> Option<Vec<Core>> {
    #[cfg(not(target_family = "wasm"))]
    let all = core_affinity::get_core_ids()?.into_iter().map(Core);
    #[cfg(target_family = "wasm")]
    let all = std::iter::empty();
    Some(all.collect())
}

impl Core {
    /// Binds the calling thread to this core.
    pub(super) fn bind(self) -> Result<()> {
        #[cfg(not(target_family = "wasm"))]
        if core_affinity::set_for_current(self.0) {
            return Ok(());
        }
        Err(cannot())
    }
}

fn cannot() -> Error {
    Error::custom("the system does not bind threads to cores: leave out `affinity`")
}
