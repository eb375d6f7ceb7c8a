//! The Box2D environments, bit for bit as Gymnasium's: the same seed gives the same episode.
//!
//! | id | task |
//! |---|---|
//! | `LunarLander-v2`, `-v3`, `LunarLanderContinuous-v2`, `-v3` | land a craft between two flags |
//! | `BipedalWalker-v3`, `BipedalWalkerHardcore-v3` | walk on two legs |
//! | `CarRacing-v2`, `CarRacing-v3` | drive around a track, from pictures |
//!
//! With the feature `rapier` (on by default), `physics: "rapier"` and the ids
//! `rapier/LunarLander-v3`, `rapier/LunarLanderContinuous-v3`, `rapier/BipedalWalker-v3`,
//! `rapier/BipedalWalkerHardcore-v3` and `rapier/CarRacing-v3` are the same environments moved by
//! rapier2d: alike, not identical.
//!
//! They use a [physics engine](physics) of this crate, which also works on its own.
//!
//! Linking this crate registers them. If your code uses nothing else of this crate, name it once:
//! `use gym_box2d as _;`.
#![warn(clippy::disallowed_methods)]
// Unit tests register no environment, so that unused code is not compiled into them.
#![cfg_attr(test, allow(dead_code, unused_imports))]

pub mod bipedal_walker;
pub mod car_racing;
pub mod lunar_lander;
pub mod physics;
mod rapier;
mod settings;
mod shapes;
mod worlds;

pub use bipedal_walker::BipedalWalker;
pub use car_racing::{CarRacing, ScoreGlyphs};
pub use lunar_lander::LunarLander;
pub use worlds::Worlds;

gym_core::family!(gym_core::registry::Family::new("Box2D", 30));

/// Compiles and runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
