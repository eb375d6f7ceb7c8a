//! Drawing: what an environment draws on, the calls of pygame, and render modes.

pub mod canvas;
mod image;
pub mod pygame;
pub mod render;
