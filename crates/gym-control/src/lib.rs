//! The DeepMind Control Suite: tasks of continuous control, step for step as dm_control 1.0.45 has
//! them with MuJoCo 3.12.
//!
//! ```
//! use gym_control as _;
//! use gym_core::{EnvExt, Result, Value, make};
//!
//! # fn main() -> Result<()> {
//! let mut env = make("dm_control/cartpole-swingup-v0")?;
//! let observation = env.reset(1)?;
//! assert_eq!(observation.get("velocity").and_then(Value::as_array).map(|array| array.len()), Some(2));
//! # Ok(())
//! # }
//! ```
//!
//! A domain is a file of [`domains`], with its model in `models`: it implements [`Domain`]
//! and [`Task`], and [`ControlEnv`] makes an environment of it, on the engine of gym-mujoco.
//!
//! Linking this crate registers the tasks; name it (`use gym_control as _;`) if nothing else of it
//! is used.
#![warn(clippy::disallowed_methods)]
// unit tests register no environment, so that unused code is not compiled into them
#![cfg_attr(test, allow(dead_code, unused_imports))]

mod arguments;
pub mod domains;
mod env;
mod observation;
mod pixels;
pub mod rewards;
mod start;
mod task;
mod world;

pub use arguments::Common;
pub use env::{ControlEnv, Of};
pub use observation::Observation;
pub use start::Start;
pub use task::{Domain, Task, register};

gym_core::family!(gym_core::registry::Family::new(
    "DeepMind Control Suite",
    70
));

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
