//! MuJoCo's physics, and Gymnasium's environments on it, in pure Rust.
//!
//! The engine repeats libmujoco (the Linux x86-64 wheels of 3.11 to 3.13 and of 4.0, as the model's
//! [`Revision`] says) to the last bit for models within the subset that [`Model`] describes. It
//! does not depend on reinforcement learning: a [`Model`] is constant, a [`Data`] is a state and
//! everything computed from it, and [`physics::step`] advances the data by a timestep of the model.

#![warn(clippy::disallowed_methods)]
// unit tests register no environment, so that the compiler leaves out all code that they do not
// call
#![cfg_attr(test, allow(dead_code, unused_imports))]

mod compile;
mod error;
mod math;
mod mjcf;
pub mod model;
pub mod physics;
pub mod recording;
pub mod tasks;
pub mod view;

pub use error::{Error, Result};
pub use model::{CompiledModel, Model, Revision};
pub use physics::{Contact, Data, forward, step, step1, step2};
pub use tasks::{
    Ant, HalfCheetah, Hopper, Humanoid, HumanoidStandup, InvertedDoublePendulum, InvertedPendulum,
    Pusher, Reacher, Simulated, Swimmer, Walker2d, simulated, simulated_mut,
};

gym_core::family!(gym_core::registry::Family::new("MuJoCo", 40));
