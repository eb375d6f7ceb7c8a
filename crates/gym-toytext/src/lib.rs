//! The toy-text environments, bit for bit as Gymnasium's: the same seed gives the same episode.
//!
//! | id | task |
//! |---|---|
//! | `Blackjack-v1` | come closer to 21 than the dealer |
//! | `CliffWalking-v0`, `CliffWalking-v1`, `CliffWalkingSlippery-v1` | reach the goal along a cliff |
//! | `FrozenLake-v1`, `FrozenLake8x8-v1` | cross a lake with holes in its slippery ice |
//! | `Taxi-v3`, `Taxi-v4` | fetch a passenger and drive to the destination |
//!
//! All except Blackjack have a transition table, for planning: see [`tabular`].
//!
//! Linking this crate registers them. If your code uses nothing else of this crate, name it once:
//! `use gym_toytext as _;`.
#![warn(clippy::disallowed_methods)]
// Unit tests register no environment, so that unused code is not compiled into them.
#![cfg_attr(test, allow(dead_code, unused_imports))]

mod art;
pub mod blackjack;
pub mod cliff_walking;
mod distribution;
pub mod frozen_lake;
pub mod grid;
mod planning;
pub mod tabular;
pub mod taxi;

pub use blackjack::Blackjack;
pub use cliff_walking::CliffWalking;
pub use frozen_lake::FrozenLake;
pub use taxi::Taxi;

gym_core::family!(gym_core::registry::Family::new("Toy text", 20));

/// Compiles and runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
