use std::env;
use std::path::{Path, PathBuf};
use std::time::Duration;

use gym_core::{Error, Kwargs, Result};

gym_core::arguments! {
    /// The arguments of a Python environment.
    pub struct Config {
        /// The id in Python; `module:id` imports the module first.
        pub env_id: Option<String>,
        /// Keyword arguments of Python's `make`.
        pub make_kwargs: Kwargs,
        /// The library whose `make` is called: `gym` or `gymnasium`.
        pub backend: Option<String>,
        /// A module to import first, which registers the environment.
        pub module: Option<String>,
        /// The interpreter.
        pub python: Option<PathBuf>,
        /// The time to wait for an answer.
        #[unit = "s"]
        pub timeout: f64 = 60.0,
        /// Whether snapshots are taken and restored, which runs code that the snapshot names.
        pub allow_pickle: bool,
    }
}

impl Config {
    /// Returns the id if all arguments are valid.
    pub(crate) fn check(&self) -> Result<&str> {
        /// The longest timeout: a year.
        const LONGEST: f64 = 3.2e7; // seconds
        let wrong = |reason: &str| Err(Error::argument("`GymV26Environment-v0`", reason));
        let Some(env_id) = self.env_id.as_deref().filter(|id| !id.is_empty()) else {
            return wrong(
                "`env_id` is missing: add `.arg(\"env_id\", \"CartPole-v1\")`, the id of the environment in Python",
            );
        };
        if !(self.timeout > 0.0 && self.timeout <= LONGEST) {
            return wrong(&format!(
                "`timeout` is {}: it is a number of seconds above 0",
                self.timeout
            ));
        }
        match self.backend.as_deref() {
            None | Some("gym" | "gymnasium") => Ok(env_id),
            Some(other) => wrong(&format!(
                "`backend` is {other:?}: choose \"gym\" or \"gymnasium\""
            )),
        }
    }

    pub(crate) fn timeout(&self) -> Duration {
        Duration::from_secs_f64(self.timeout)
    }

    /// Returns the interpreter: the argument, else the virtual environment's, else the system's.
    pub(crate) fn python(&self) -> PathBuf {
        let of_venv = |venv| {
            let folder = if cfg!(windows) {
                "Scripts/python.exe"
            } else {
                "bin/python"
            };
            Some(Path::new(&venv).join(folder)).filter(|python| python.exists())
        };
        let python = self
            .python
            .clone()
            .or_else(|| env::var_os("VIRTUAL_ENV").and_then(of_venv));
        python.unwrap_or_else(|| if cfg!(windows) { "python" } else { "python3" }.into())
    }
}
