//! Gymnasium-Robotics' tasks, with goals and without, step for step as version 1.4.2 has them.
//!
//! ```
//! use gym_core::{EnvExt, Result, make};
//! use gym_robotics as _;
//!
//! # fn main() -> Result<()> {
//! let mut env = make("PointMaze_UMaze-v3")?;
//! let observation = env.reset(1)?;
//! assert!(observation.get("desired_goal").is_some());
//! let goals = env.goals().map(|goals| goals.compute_reward(&[0.0, 0.0], &[0.0, 0.1]));
//! assert_eq!(goals, Some(1.0));
//! # Ok(())
//! # }
//! ```
//!
//! Mazes and Adroit hands have models of this crate. Those of Fetch, the Shadow hand and the kitchen are
//! the user's: see [`assets`].
//!
//! [`SimEnv`](gym_sim::SimEnv) is the environment of all tasks, [`mujoco_engine`] their physics, and
//! [`Goals`](gym_core::Goals) their rewards.
//!
//! Linking this crate registers the tasks; name it (`use gym_robotics as _;`) if nothing else of it
//! is used.
#![warn(clippy::disallowed_methods)]

mod reward;
mod rotation;

pub mod adroit;
pub mod ant_maze;
pub mod maze;
pub mod point_maze;

// a browser has no files, and so none of the models that these need
#[cfg(not(target_os = "unknown"))]
pub mod assets;
#[cfg(not(target_os = "unknown"))]
pub mod fetch;
#[cfg(not(target_os = "unknown"))]
mod goals;
#[cfg(not(target_os = "unknown"))]
pub mod kitchen;
#[cfg(not(target_os = "unknown"))]
pub mod shadow_hand;

pub use reward::RewardType;

gym_core::family!(gym_core::registry::Family::new("Robotics", 75).page("robotics.md"));

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
