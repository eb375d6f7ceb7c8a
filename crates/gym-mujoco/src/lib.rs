//! MuJoCo's physics, and Gymnasium's environments on it, in pure Rust.
//!
//! The engine repeats libmujoco 3.12.0 (the Linux x86-64 wheel, and 3.13.0 with it) to the last bit
//! for models within the subset that [`Model`] describes. It does not depend on reinforcement
//! learning: a [`Model`] is constant, a [`Data`] is a state and everything computed from it, and
//! [`physics::step`] advances the data by a timestep of the model.

#![warn(clippy::disallowed_methods)]
// Unit tests register no environment, so that the compiler leaves out all that they do not call.
#![cfg_attr(test, allow(dead_code, unused_imports))]

pub mod data;
mod error;
mod libm;
mod mjcf;
pub mod model;
pub mod physics;
pub mod recording;
pub mod tasks;
pub mod view;

pub use data::{Contact, Data};
pub use error::{Error, Result};
pub use model::{CompiledModel, Model};
pub use physics::{forward, step};
pub use tasks::{
    Ant, HalfCheetah, Hopper, Humanoid, HumanoidStandup, InvertedDoublePendulum, InvertedPendulum,
    Pusher, Reacher, Simulated, Swimmer, Walker2d, simulated, simulated_mut,
};
