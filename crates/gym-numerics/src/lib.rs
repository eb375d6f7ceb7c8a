#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_methods)]

pub mod math;
pub mod rng;

pub use rng::{Generator, RandomState, Seed, SeedError};
