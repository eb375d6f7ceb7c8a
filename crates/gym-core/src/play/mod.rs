//! Playing: the keys of a person, and policies that play well.

pub mod keys;
pub mod policy;

pub use keys::Keys;
pub use policy::Policy;
