//! The DeepMind Control Suite: tasks of continuous control. With `mujoco="3.12"` they are dm_control
//! 1.0.45's, step for step; the default is 4.0, on which dm_control 1.0.45 does not run.
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
//! A domain is a file of [`domains`], with its model in `models`: it implements [`Domain`] and
//! [`SimTask`](gym_sim::SimTask), and [`make()`] makes an environment of it.
//!
//! Linking this crate registers the tasks; name it (`use gym_control as _;`) if nothing else of it
//! is used.
#![warn(clippy::disallowed_methods)]

mod arguments;
mod domain;
pub mod domains;
mod look;
pub mod rewards;

pub use arguments::Common;
pub use domain::{Domain, Entry, make, register};

gym_core::family!(gym_core::registry::Family::new(
    "DeepMind Control Suite",
    70
));

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
