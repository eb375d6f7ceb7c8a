//! minigrid's wrappers, registered under its names.
//!
//! [`maps`] change observations, also those of vectors; [`looks`] observe the world in another
//! form; [`effects`] change rewards, actions and initial states.

pub mod effects;
pub mod looks;
pub mod maps;
