//! Environments for reinforcement learning.
//!
//! | id | task |
//! |---|---|
//! | `plugin_name/Rocket-v0` | touch down softly, with as little fuel as possible |
//!
//! Linking this crate registers them; name it (`use plugin_name as _;`) if nothing else of it is
//! used.

pub mod rocket;

pub use rocket::Rocket;
