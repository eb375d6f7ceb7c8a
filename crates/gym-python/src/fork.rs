//! Forks: a child process lacks the parent's other threads, and the locks that these held.

use std::sync::atomic::{AtomicU64, Ordering};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Of an object that works on threads of its own.
pub(crate) const THREADS: &str = "the threads it needs stayed";

/// Of an object that one thread uses at a time.
pub(crate) const IN_USE: &str = "another thread was using it";

/// The number of forks between the first process and this one.
static FORKS: AtomicU64 = AtomicU64::new(0);

/// Marks this process as the child of a fork. Python calls the function through
/// `os.register_at_fork`.
#[pyfunction]
pub(crate) fn after_fork_in_child() {
    FORKS.fetch_add(1, Ordering::Relaxed);
}

/// The process in which an object was made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Origin(u64);

impl Origin {
    /// Returns the origin of objects made in this process.
    pub(crate) fn here() -> Self {
        Self(FORKS.load(Ordering::Relaxed))
    }

    /// Whether this process is the one in which the object was made.
    pub(crate) fn is_here(self) -> bool {
        self.0 == Self::here().0
    }

    /// Returns an error in a forked child, where the threads of the parent do not exist. `stayed`
    /// says what the object needs of them.
    pub(crate) fn check(self, what: &str, stayed: &str) -> PyResult<()> {
        if self.is_here() {
            return Ok(());
        }
        Err(PyRuntimeError::new_err(format!(
            "this {what} was made before the process was forked, and {stayed} in the parent: make it in the child"
        )))
    }
}
