//! Specs: an environment, a wrapper or a vector as data, with its arguments.

pub mod arguments;
mod env;
mod id;
mod options;
mod reset;
mod suggest;
mod vector;
mod wrapper;

pub use arguments::{Argument, ArgumentType, Arguments};
pub use env::EnvSpec;
pub use id::EnvId;
pub use options::ResetOptions;
pub use reset::{Kwargs, Reset};
pub(crate) use suggest::nearest;
pub use vector::{Autoreset, Each, VectorKind, VectorSpec};
pub use wrapper::{WrapperConfig, WrapperSpec};
