//! Gymnasium's environments in Rust: the same seed gives the same episode.
//!
//! ```
//! use gym::Env;
//!
//! # fn main() -> gym::Result<()> {
//! let mut env = gym::make("CartPole-v1")?;
//! let mut actions = env.action_sampler(42)?;
//! let mut observation = env.reset(42)?;
//! loop {
//!     let step = env.step(&actions.sample())?;
//!     observation = step.observation;
//!     if step.done() {
//!         break;
//!     }
//! }
//! # let _ = observation;
//! # Ok(())
//! # }
//! ```
//!
//! This crate links the families of environments that its features name and re-exports
//! [`gym_core`], where everything is explained; [`Env`] is the place to start.

#[cfg(feature = "classic")]
pub use gym_classic as classic;
pub use gym_core::*;
#[cfg(feature = "render")]
pub use gym_render as rendering;
#[cfg(feature = "toytext")]
pub use gym_toytext as toytext;
