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
pub(crate) mod store;
mod tidy;
pub(crate) mod xml;

/// The largest number of bodies, of geoms, of degrees of freedom, and of each kind of object that is
/// looked up by name.
pub(crate) const MOST: usize = 4000;
/// The largest number of keyframes: each has the positions of all joints.
pub(crate) const MOST_KEYS: usize = 1000;
