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
//! All have [native vectors](gym_core::vector::native). These start as the environments do, and a step
//! from the same state gives the same numbers up to this part of the larger of their size and 1:
//!
//! | environment | state | observation | reward |
//! |---|---|---|---|
//! | CartPole, MountainCar | 1e-15 | 1 ulp | equal |
//! | MountainCarContinuous | 1 ulp of `float32` | 1 ulp | equal |
//! | Pendulum | 2e-15 | 1 ulp | 1e-9 |
//! | Acrobot | 1e-14 | 1 ulp | equal |
//!
//! Linking this crate registers them; name it (`use gym_classic as _;`) if nothing else of it is
//! used.

pub mod acrobot;
pub mod cartpole;
pub mod mountain_car;
pub mod mountain_car_continuous;
mod numpy;
pub mod pendulum;
mod reset;

pub use acrobot::Acrobot;
pub use cartpole::CartPole;
pub use mountain_car::MountainCar;
pub use mountain_car_continuous::MountainCarContinuous;
pub use pendulum::Pendulum;

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
