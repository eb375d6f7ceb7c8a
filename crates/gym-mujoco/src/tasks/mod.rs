//! Gymnasium's eleven tasks: one file for each, in all its versions.
//!
//! A task defines initial states, rewards, observations and `info`; [`MujocoEnv`] is the
//! environment of a task. Versions differ in data: the tables of arguments, the names of entries of
//! `info`, and flags that a task reads when it is built.
//!
//! Versions 4 and 5 are those of Gymnasium 1.4.0. Versions 2 and 3, which Gymnasium itself no
//! longer runs, follow Gymnasium 0.29.1 on the same engine.

mod arguments;
mod cost;
mod env;
mod models;
mod motion;
pub mod numpy;
mod range;
mod runner;
mod simulation;
mod together;
mod version;

pub mod ant;
pub mod half_cheetah;
pub mod hopper;
pub mod humanoid;
pub mod humanoid_standup;
pub mod inverted_double_pendulum;
pub mod inverted_pendulum;
pub mod pusher;
pub mod reacher;
pub mod swimmer;
pub mod walker2d;

use gym_core::registry::Clip;
use gym_core::{Env, EnvExt, Result};

pub use crate::lanes::{Derived, Stride};
pub use arguments::{Common, TaskArguments};
pub use env::{MujocoEnv, Task, Visit};
pub use models::{load, models};
pub use range::Range;
pub use simulation::Simulation;
pub use together::{Place, Worlds};
pub use version::Version;

use crate::Data;

/// The interface to an environment of any task and version: see [`simulated`].
pub trait Simulated {
    /// The model, and the settings of a step.
    fn simulation(&self) -> &Simulation;

    /// The state of the model; `None` before the first reset.
    fn data(&self) -> Option<&Data>;

    /// Continues the episode from other positions and velocities (nq and nv numbers): Gymnasium's
    /// `MujocoEnv.set_state`.
    ///
    /// # Errors
    /// [`Error::ResetNeeded`](gym_core::Error::ResetNeeded) before the first reset;
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) for another number of positions
    /// or velocities than the model has, and for one outside ±1e10, where MuJoCo resets a
    /// simulation. On error, nothing changes.
    fn set_state(&mut self, qpos: &[f64], qvel: &[f64]) -> Result<()>;

    /// Turns the free camera around the point that it looks at, by degrees, and multiplies its
    /// distance by `zoom`, within bounds. Only frames change. Cameras of the model are unchanged.
    fn turn_camera(&mut self, azimuth: f64, elevation: f64, zoom: f64);
}

macro_rules! tasks {
    ($($module:ident $name:ident $doc:literal;)+) => {
        $(
            #[doc = $doc]
            pub type $name = MujocoEnv<$module::Task>;
        )+

        /// The [`Simulated`] interface of an environment of this crate, under any wrappers; `None`
        /// for other environments.
        #[must_use]
        pub fn simulated<E: Env>(env: &E) -> Option<&dyn Simulated> {
            $(
                if let Some(env) = env.layer::<$name>() {
                    return Some(env);
                }
            )+
            None
        }

        /// [`simulated`] with mutable access.
        #[must_use]
        pub fn simulated_mut<E: Env>(env: &mut E) -> Option<&mut dyn Simulated> {
            $(
                if env.layer::<$name>().is_some() {
                    return env.layer_mut::<$name>().map(|env| env as &mut dyn Simulated);
                }
            )+
            None
        }
    };
}

tasks!(
    ant Ant "Walk on four legs. See [`ant`].";
    half_cheetah HalfCheetah "Run on two legs in a plane. See [`half_cheetah`].";
    hopper Hopper "Hop on one leg. See [`hopper`].";
    humanoid Humanoid "Walk upright. See [`humanoid`].";
    humanoid_standup HumanoidStandup "Stand up. See [`humanoid_standup`].";
    inverted_double_pendulum InvertedDoublePendulum "Balance two poles on a cart. See [`inverted_double_pendulum`].";
    inverted_pendulum InvertedPendulum "Balance a pole on a cart. See [`inverted_pendulum`].";
    pusher Pusher "Push an object to a goal. See [`pusher`].";
    reacher Reacher "Reach a target with an arm. See [`reacher`].";
    swimmer Swimmer "Swim with three links. See [`swimmer`].";
    walker2d Walker2d "Walk on two legs in a plane. See [`walker2d`].";
);

/// The clip of two episodes on a task's page, which shows every `every`-th state. `side` is the
/// width and height of its pictures.
const fn clip(every: u32, frames: u32, side: u32) -> Clip {
    Clip {
        seeds: 0..2,
        every,
        frames,
        size: (side, side),
    }
}
