//! Environments for reinforcement learning.
//!
//! | id | task |
//! |---|---|
//! | `plugin_name/Corridor-v0` | find the way out of a dark corridor, on a slippery floor |
//!
//! Linking this crate registers them; name it (`use plugin_name as _;`) if nothing else of it is
//! used.

pub mod corridor;

pub use corridor::Corridor;
