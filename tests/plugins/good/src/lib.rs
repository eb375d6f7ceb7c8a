//! Environments of Sutton and Barto, "Reinforcement Learning: An Introduction" (2nd edition, 2018).
//!
//! | id | task |
//! |---|---|
//! | `sutton/WindyGridworld-v0` | reach the goal across a wind that blows upwards |
//! | `sutton/WindyGridworldKings-v0` | the same with the moves of a king and a wind that varies |
//!
//! Linking this crate registers them. If your code uses nothing else of this crate, name it once:
//! `use sutton_envs as _;`.

pub mod windy_gridworld;

pub use windy_gridworld::WindyGridworld;
