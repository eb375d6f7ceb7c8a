//! Wrappers without state: maps of observations, actions or rewards, with one adapter each that
//! serves environments and vectors.
//!
//! A map consists of its arguments, its effect on a space, and its effect on a value:
//!
//! ```
//! use gym_core::{Env, Result};
//! use gym_wrappers::map::{MapReward, RewardMap};
//!
//! gym_core::arguments! {
//!     /// The arguments.
//!     pub struct Config {
//!         /// The factor of the rewards.
//!         pub factor: f64,
//!     }
//! }
//!
//! /// Scales rewards.
//! #[derive(Clone, Debug)]
//! struct Scale(f64);
//!
//! impl RewardMap for Scale {
//!     type Config = Config;
//!
//!     fn new(config: &Config) -> Result<Self> {
//!         Ok(Self(config.factor))
//!     }
//!
//!     fn map(&self, reward: f64) -> f64 {
//!         self.0 * reward
//!     }
//! }
//!
//! type ScaleReward<T> = MapReward<T, Scale>;
//!
//! gym_core::register_wrapper!(
//!     "my_envs/ScaleReward", "scales rewards", Config, env: ScaleReward::new, vector: ScaleReward::new
//! );
//! ```

mod action;
mod observation;
mod reward;

pub use crate::observing::Seen;
pub use crate::within::{Batch, Single, Within};
pub use action::{ActionMap, MapAction};
pub use observation::{MapObservation, Mapped, ObservationMap};
pub(crate) use reward::step_rewards;
pub use reward::{MapReward, RewardMap};
