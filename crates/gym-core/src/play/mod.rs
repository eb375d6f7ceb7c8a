//! Playing: names of what is shown, the keys of a person, and policies that play well.

pub mod keys;
pub mod names;
pub mod policy;

pub use keys::Keys;
pub use names::Names;
pub use policy::Policy;
