//! minigrid's wrappers, registered under its names.
//!
//! [`maps`] change observations by themselves, also those of vectors; [`looks`] observe the world
//! in another way; [`effects`] change rewards, actions and starts.

pub mod effects;
pub mod looks;
pub mod maps;
