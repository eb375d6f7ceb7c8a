//! Environments of Sutton and Barto, "Reinforcement Learning: An Introduction" (2nd edition, 2018).
//!
//! | id | task |
//! |---|---|
//! | `sutton/WindyGridworld-v0` | reach the goal across a wind that blows upwards |
//! | `sutton/WindyGridworldKings-v0` | the same with the moves of a king and a wind that varies |
//!
//! Linking this crate registers them; name it (`use sutton_envs as _;`) if nothing else of it is
//! used.

pub mod windy_gridworld;

pub use windy_gridworld::WindyGridworld;
