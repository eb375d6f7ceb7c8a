//! MJCF, MuJoCo's model format: a strict reader and compiler of the part that the engine supports.
//!
//! The reader turns a text into a tree of elements ([`xml`]), and the tree into a [`spec`].
//! `compile` turns the `spec` into a compiled model. Anything outside the supported part is an
//! error that names element, attribute and line; nothing is skipped silently.
//!
//! [`Model::from_xml`](crate::Model::from_xml) lists what is supported.

mod attach;
mod bodies;
mod copies;
mod defaults;
pub(crate) mod files;
pub(crate) mod orientation;
pub(crate) mod reader;
mod refers;
pub(crate) mod spec;
mod tidy;
pub(crate) mod xml;

/// The largest number of bodies, geoms and degrees of freedom (the engine's matrices are dense),
/// and of each kind of object that is looked up by name.
pub(crate) const MOST: usize = 1000;
