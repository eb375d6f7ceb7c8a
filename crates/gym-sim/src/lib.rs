//! Environments on MuJoCo's physics.
//!
//! [`SimEnv`] is the one environment: a [`SimTask`] on a model of the crate [`mujoco_engine`].
//! Pictures and depths, snapshots, changes of the state, MuJoCo's versions and vectors whose worlds
//! step together come with it. Gymnasium's MuJoCo tasks and the DeepMind Control Suite are tasks on
//! it. [`viewer`] shows a model without a task.
//!
//! A task with arguments implements [`FromArguments`] too, and registers as an [`Entry`].
#![warn(clippy::disallowed_methods)]

mod arguments;
mod entry;
mod env;
mod episode;
mod keyframe;
mod load;
mod naming;
pub mod numpy;
mod observation;
mod pixels;
mod rng;
mod settings;
mod simulation;
mod start;
mod task;
mod together;
mod version;
pub mod view;
pub mod viewer;

pub use arguments::{Common, TaskArguments};
pub use entry::{Entry, Family, FromArguments, Own, names, register};
pub use env::SimEnv;
pub use keyframe::{keyframe, keyframes};
pub use load::{compile, load, text};
pub use mujoco_engine as engine;
pub use naming::Naming;
pub use observation::Observation;
pub use rng::Rng;
pub use settings::Settings;
pub use simulation::{Simulation, Stepper};
pub use start::Start;
pub use task::{Measured, Measures, SimTask, Visit};
pub use together::{Groups, Member};
pub use version::Version;

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
