//! Forks: the threads and the owners of locks that a child process no longer has.

use std::sync::atomic::{AtomicU64, Ordering};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How many forks lie between this process and the first.
static FORKS: AtomicU64 = AtomicU64::new(0);

/// Says that this process is the child of a fork; Python calls it by `os.register_at_fork`.
#[pyfunction]
pub(crate) fn after_fork_in_child() {
    FORKS.fetch_add(1, Ordering::Relaxed);
}

/// The process in which something was made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Origin(u64);

impl Origin {
    /// This process.
    pub(crate) fn here() -> Self {
        Self(FORKS.load(Ordering::Relaxed))
    }

    /// Whether this is still the process.
    pub(crate) fn is_here(self) -> bool {
        self.0 == Self::here().0
    }

    /// Refuses to wait for threads of the parent, which would never end.
    pub(crate) fn check(self, what: &str) -> PyResult<()> {
        if self.is_here() {
            return Ok(());
        }
        Err(PyRuntimeError::new_err(format!(
            "this {what} was made before the process was forked, and the threads it needs stayed in the parent: make it in the child"
        )))
    }
}
