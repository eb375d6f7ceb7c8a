//! Gymnasium's environments in Rust: the same seed gives the same episode.
//!
//! ```
//! use gym::prelude::*;
//!
//! # fn main() -> gym::Result<()> {
//! let mut env = gym::make("CartPole-v1")?;
//! let mut actions = env.action_sampler(42)?;
//! env.reset(42)?;
//! let mut episode_return = 0.0;
//! loop {
//!     let step = env.step(&actions.sample())?;
//!     episode_return += step.reward;
//!     if step.done() {
//!         break;
//!     }
//! }
//! assert_eq!(episode_return, 30.0);
//! # Ok(())
//! # }
//! ```
//!
//! This crate links the families of environments that its features name, and re-exports
//! [`gym_core`]. Start with [`Env`].

#[cfg(feature = "atari")]
pub use gym_atari as atari;
#[cfg(feature = "box2d")]
pub use gym_box2d as box2d;
#[cfg(all(feature = "bridge", unix))]
pub use gym_bridge as bridge;
#[cfg(feature = "classic")]
pub use gym_classic as classic;
#[cfg(feature = "conform")]
pub use gym_conform as conform;
#[cfg(feature = "control")]
pub use gym_control as control;
pub use gym_core::*;
#[cfg(feature = "minigrid")]
pub use gym_minigrid as minigrid;
#[cfg(feature = "mujoco")]
pub use gym_mujoco as mujoco;
#[cfg(feature = "policies")]
pub use gym_policies as policies;
#[cfg(feature = "robotics")]
pub use gym_robotics as robotics;
#[cfg(any(feature = "control", feature = "mujoco", feature = "robotics"))]
pub use gym_sim as sim;
#[cfg(feature = "toytext")]
pub use gym_toytext as toytext;
#[cfg(feature = "trace")]
pub use gym_trace as trace;
pub use gym_wrappers as wrappers;
pub use gym_wrappers::{VectorWrap, Wrap};

/// Many environments stepped as one: Gymnasium's `VectorEnv`.
pub mod vector {
    pub use gym_core::vector::*;
    pub use gym_native as native;
}

/// Render modes and frames and, with the feature `render`, drawing and recording of environments.
pub mod render {
    pub use gym_core::render::*;
    #[cfg(feature = "render")]
    pub use gym_render::*;
}

/// The imports for using environments: `use gym::prelude::*`.
pub mod prelude {
    #[doc(no_inline)]
    pub use gym_core::prelude::*;
    #[doc(no_inline)]
    pub use gym_wrappers::{VectorWrap, Wrap};
}

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
