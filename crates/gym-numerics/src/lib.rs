#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods)]

pub mod exact;
pub mod file;
pub mod math;
pub mod rng;
pub mod text;
pub mod unique;

pub use rng::{Generator, RandomState, Seed, SeedError};
