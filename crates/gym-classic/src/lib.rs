//! The classic control environments, bit for bit as Gymnasium's: the same seed gives the same
//! episode.
//!
//! | id | task |
//! |---|---|
//! | `CartPole-v0`, `CartPole-v1` | balance a pole on a cart |
//! | `MountainCar-v0`, `MountainCarContinuous-v0` | swing an underpowered car out of a valley |
//! | `Pendulum-v1` | swing a pendulum up and hold it |
//! | `Acrobot-v1` | swing a two-link arm above a line |
//!
//! All have [native vectors](gym_native) with the same bits: each equation is written once, for one
//! number and for a SIMD register of numbers.
//!
//! Linking this crate registers them. If your code uses nothing else of this crate, name it once:
//! `use gym_classic as _;`.
#![warn(clippy::disallowed_methods)]

pub mod acrobot;
pub mod cartpole;
mod constants;
pub mod mountain_car;
pub mod mountain_car_continuous;
pub mod pendulum;
mod policy;
mod reset;

pub use acrobot::Acrobot;
pub use cartpole::CartPole;
pub use mountain_car::MountainCar;
pub use mountain_car_continuous::MountainCarContinuous;
pub use pendulum::Pendulum;

gym_core::family!(gym_core::registry::Family::new("Classic control", 10));

/// Compiles and runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
