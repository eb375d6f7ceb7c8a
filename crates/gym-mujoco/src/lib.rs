//! Gymnasium's environments on MuJoCo's physics, in pure Rust.
//!
//! The physics is the crate [`mujoco_engine`], which repeats libmujoco to the last bit.

#![warn(clippy::disallowed_methods)]
// unit tests register no environment, so that the compiler leaves out all code that they do not
// call
#![cfg_attr(test, allow(dead_code, unused_imports))]

pub mod recording;
pub mod tasks;
pub mod view;

pub use mujoco_engine::{
    CompiledModel, Contact, Data, Error, Model, Result, Revision, forward, lanes, math, model,
    physics, step, step1, step2,
};
pub use tasks::{
    Ant, HalfCheetah, Hopper, Humanoid, HumanoidStandup, InvertedDoublePendulum, InvertedPendulum,
    Pusher, Reacher, Simulated, Swimmer, Walker2d, simulated, simulated_mut,
};

gym_core::family!(gym_core::registry::Family::new("MuJoCo", 40));
