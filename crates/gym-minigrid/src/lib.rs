//! MiniGrid and BabyAI: tasks on a grid of cells, which the agent sees a part of, step for step as
//! minigrid 3.2.0 has them.
//!
//! ```
//! use gym_core::{EnvExt, Env};
//! use gym_minigrid::{Action, GridEnv, tasks::empty::Empty};
//!
//! let mut env = GridEnv::new(Empty { size: 5, ..Empty::default() })?;
//! env.reset(0)?;
//! for action in [Action::Forward, Action::Forward, Action::Right, Action::Forward] {
//!     env.step(&action)?;
//! }
//! let step = env.step(&Action::Forward)?;
//! assert!(step.terminated && step.reward > 0.95);
//! # Ok::<(), gym_core::Error>(())
//! ```
//!
//! A task is a [`Level`]: it makes a [`World`] with a [`Draft`], and decides when an episode ends.
//! [`GridEnv`] makes an environment of it. Where objects leave the agent no place to face none,
//! minigrid looks for one for ever (one seed in 700 of `BabyAI-SynthS5R2-v0`); here another level
//! is drawn.
//!
//! Linking this crate registers the tasks of [`tasks`] and [`babyai`]; name it
//! (`use gym_minigrid as _;`) if nothing else of it is used.
#![warn(clippy::disallowed_methods)]

mod advice;
pub mod babyai;
mod cell;
mod draft;
mod env;
mod grid;
pub mod level;
mod picture;
mod planner;
mod rooms;
pub mod tasks;
mod vector;
mod view;
mod world;
pub mod wrappers;

#[doc(hidden)]
pub use gym_core;

pub use cell::{Cell, Color, Kind, State};
pub use draft::{Area, Draft, Generated, GenerationError};
pub use env::{Entry, Facts, GridEnv, register};
pub use grid::{Grid, Pos};
pub use level::Level;
pub use world::{Action, World};

gym_core::family!(gym_core::registry::Family::new("MiniGrid and BabyAI", 60).page("minigrid.md"));

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
