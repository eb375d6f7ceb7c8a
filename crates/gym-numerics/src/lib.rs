#![doc = include_str!("../README.md")]

pub mod math;
pub mod rng;

pub use rng::{Generator, Seed, SeedError};
