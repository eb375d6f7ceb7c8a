//! Reinforcement-learning environments in Rust.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![warn(clippy::disallowed_methods)]

pub mod arguments;
pub mod array;
mod boxed;
pub mod canvas;
mod clock;
mod continuous;
mod data;
mod env;
mod env_ext;
pub mod equations;
mod error;
mod functional;
pub mod keys;
mod number;
mod numpy_fmt;
pub mod policy;
pub mod pygame;
pub mod registry;
pub mod render;
mod reset;
mod snapshot;
pub mod spaces;
mod stored;
mod value;
pub mod vector;
mod wrapper;
pub mod wrappers;

/// The imports for using environments: `use gym::prelude::*`.
pub mod prelude {
    #[doc(no_inline)]
    pub use crate::{
        BoxEnv, Env, EnvExt, Reset, Result, Space, Value, VectorEnv, VectorEnvExt, builder, make,
        make_vec,
    };
}

/// The entries of [`Env::info`] by name.
pub type Info = std::collections::BTreeMap<String, Value>;

#[doc(hidden)]
pub use inventory;

pub use arguments::{Argument, ArgumentType, Arguments};
pub use array::{Array, DType, Data};
pub use boxed::BoxEnv;
pub use continuous::{Continuous, Precision};
pub use env::{Env, Outcome, Step};
pub use env_ext::EnvExt;
pub use error::{Error, Result};
pub use functional::{Dynamics, Stateful, Task, Transition};
pub use gym_numerics::{Generator, Seed, math, rng};
pub use keys::Keys;
pub use policy::Policy;
pub use registry::{
    Configure, EnvSpec, NoArguments, Registration, WrapperSpec, builder, make, make_vec,
};
pub use reset::{Kwargs, Reset};
pub use snapshot::Snapshot;
pub use spaces::{Sampler, Space};
pub use value::{Element, GraphInstance, Value};
pub use vector::wrapper::VectorWrapper;
pub use vector::{BoxVector, VectorEnv, VectorEnvExt};
pub use wrapper::Wrapper;

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
