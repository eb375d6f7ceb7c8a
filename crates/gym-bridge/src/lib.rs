//! Any Python environment from Rust: Gymnasium's `GymV26Environment-v0`.
//!
//! ```no_run
//! use gym_bridge as _;
//! use gym_core::{Env, EnvExt, builder};
//!
//! # fn main() -> gym_core::Result<()> {
//! let mut env = builder("GymV26Environment-v0").arg("env_id", "CartPole-v1").build()?;
//! env.reset(42)?;
//! # Ok(())
//! # }
//! ```
//!
//! The environment runs in a separate Python process, the *worker*. No Python is linked,
//! environments run in parallel, and a crash or hang of the worker is an `Err`. The worker ends
//! with its environment and with this process, even after a crash.
//!
//! | argument | default | meaning |
//! |---|---|---|
//! | `env_id` | none, it is required | the id in Python; `module:id` imports the module first |
//! | `make_kwargs` | `{}` | keyword arguments of Python's `make`; `disable_env_checker` is true unless it is given |
//! | `backend` | `gym` if it is installed, else `gymnasium` | the library whose `make` is called |
//! | `module` | none | a module to import first, which registers the environment |
//! | `python` | `$VIRTUAL_ENV`'s, else `python3` | the interpreter |
//! | `timeout` | 60 | seconds to wait for an answer |
//! | `allow_pickle` | `false` | whether snapshots are taken and restored, by `pickle`: **restoring runs code that the snapshot names** |
//!
//! - The render mode goes to Python, which draws: `rgb_array`, `ansi`, their `_list` forms, and
//!   `human` in Python's own window.
//! - All ten kinds of spaces are converted, and spaces of texts such as minigrid's. Spaces may
//!   change at a reset, as highway-env's do, if their elements keep their form.
//! - `info` contains numbers, texts, arrays, lists and dicts; other objects are left out.
//! - The generator lives in Python, so wrappers that draw from
//!   [`Env::generator`](gym_core::Env::generator) refuse.
//! - A clone is another worker, which loads the environment by `pickle` (or `cloudpickle`); if that
//!   fails, the clone's calls return the error.
//!
//! The worker speaks length-prefixed frames over a socket pair, and exits when the other end of its
//! socket closes. A large array is never copied into a frame: its numbers are written from Python's
//! memory and read into the caller's array.

mod config;
mod env;
#[cfg(test)]
mod fake;
mod spaces;
#[doc(hidden)]
pub mod wire;
mod worker;

pub use config::Config;
pub use env::PythonEnv;

gym_core::family!(
    gym_core::registry::Family::new("Python's environments", 80)
        .page("bridge.md")
        .needs(
            "a Python environment, named by the argument `env_id`",
            || false
        )
);

/// The example of the README, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
