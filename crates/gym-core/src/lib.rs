//! Reinforcement-learning environments in Rust.
//!
//! The modules have an order: `value`, `drawing`, `spec`, `spaces`, `env`, `play`, `vector`,
//! `wrappers`, `registry`. Each names only earlier ones, which a test checks (`tests/tests/it/rooms.rs`).
#![cfg_attr(docsrs, feature(doc_cfg))]
#![warn(clippy::disallowed_methods)]

mod value;

mod drawing;

mod spec;

pub mod spaces;

mod env;

mod play;

pub mod vector;

pub mod wrappers;

pub mod registry;

/// The imports for using environments: `use gym::prelude::*`.
pub mod prelude {
    #[doc(no_inline)]
    pub use crate::render::RenderMode;
    #[doc(no_inline)]
    pub use crate::{
        BoxEnv, Env, EnvExt, Reset, Result, Space, Value, VectorEnv, VectorEnvExt, builder, make,
        make_vec,
    };
}

#[doc(hidden)]
pub use inventory;

pub use gym_numerics::{Generator, RandomState, Seed, exact, file, math, rng, unique};

pub use drawing::{canvas, pygame, render};
pub use env::{
    BoxEnv, Configure, Dynamics, Env, EnvExt, Goals, Inspect, NoArguments, Outcome, Stateful, Step,
    Task, Transition, Wrapper, equations,
};
pub use play::{Keys, Names, Policy, keys, names, policy};
pub use registry::{Registration, builder, make, make_vec};
pub use spaces::{Sampler, Space};
pub use spec::{Argument, ArgumentType, Arguments, EnvSpec, Kwargs, Reset, WrapperSpec, arguments};
pub use value::{
    Array, Continuous, DType, Data, Element, Error, GraphInstance, Info, Precision, Result,
    Snapshot, Value, array, printable,
};
pub use vector::{BoxVector, VectorEnv, VectorEnvExt, wrapper::VectorWrapper};

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
