//! Gymnasium's eleven tasks: one file for each, in all its versions.
//!
//! A task says how an episode starts, what a step is worth, what is seen, and what `info` tells. [`MujocoEnv`] makes an
//! environment of it. Where versions differ the differences are data: default values, names of arguments and of entries of
//! `info`, and flags that a task reads when it is built.
//!
//! Versions 4 and 5 are those of Gymnasium 1.4.0. Versions 2 and 3, which Gymnasium itself no longer runs, follow
//! Gymnasium 0.29.1 on the same engine.

mod arguments;
mod cost;
mod env;
mod numpy;
mod range;
mod runner;
mod simulation;

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

use gym_core::{Env, EnvExt, Result};

pub use arguments::{Arguments, Common, TaskArguments};
pub use env::{MujocoEnv, Task};
pub use range::Range;
pub use simulation::{Simulation, load, models};

use crate::Data;

/// What can be asked of an environment of any task and version: see [`simulated`].
pub trait Simulated {
    /// The model, and how it is stepped.
    fn simulation(&self) -> &Simulation;

    /// The state of the model, once there was a reset.
    fn data(&self) -> Option<&Data>;

    /// Goes on from other positions and velocities (nq and nv numbers), in the same episode: Gymnasium's
    /// `MujocoEnv.set_state`.
    ///
    /// # Errors
    /// [`Error::ResetNeeded`](gym_core::Error::ResetNeeded) before the first reset;
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) for another number of positions or velocities than the
    /// model has, and for one that is not within ±1e10, where MuJoCo resets a simulation. Nothing is changed then.
    fn set_state(&mut self, qpos: &[f64], qvel: &[f64]) -> Result<()>;
}

/// Registers the versions of a task: `register!(Ant, "Walk.", steps 1000, threshold 6000.0, versions [2 3 4 5])`. After `idle` may
/// come a version some of whose arguments have no effect, as in Gymnasium, and why.
macro_rules! register {
    (
        $task:ident, $about:literal, steps $steps:literal $(, threshold $threshold:literal)?,
        versions [$($version:tt)+] $(, idle $idle:literal $reason:literal)?
    ) => {
        $crate::tasks::register!(
            @each $task, $about, $steps, [$($threshold)?], [$($idle $reason)?], $($version)+
        );
    };
    (@each $task:ident, $about:literal, $steps:literal, $threshold:tt, $idle:tt, $($version:tt)+) => {
        $($crate::tasks::register!(@one $task, $about, $steps, $threshold, $idle, $version);)+
    };
    (@one $task:ident, $about:literal, $steps:literal, [$($threshold:literal)?], [], 2) => {
        gym_core::register!(
            gym_core::Registration::new::<$task<2>>(concat!(stringify!($task), "-v2"))
                .description($about)
                .without_arguments()
                .max_episode_steps($steps)
                $(.reward_threshold($threshold))?
        );
    };
    (@one $task:ident, $about:literal, $steps:literal, $threshold:tt, [$idle:literal $reason:literal], 2) => {
        $crate::tasks::register!(@one $task, $about, $steps, $threshold, [], 2);
    };
    (
        @one $task:ident, $about:literal, $steps:literal, [$($threshold:literal)?], [$($idle:literal $reason:literal)?],
        $version:literal
    ) => {
        gym_core::register!(
            gym_core::Registration::new::<$task<$version>>(concat!(stringify!($task), "-v", $version))
                .description($about)
                .max_episode_steps($steps)
                $(.reward_threshold($threshold))?
                $(.exceptions(if $version == $idle { &[("arguments-matter", $reason)] } else { &[] }))?
        );
    };
}
use register;

macro_rules! tasks {
    ($($module:ident $name:ident $doc:literal [$($version:literal)+];)+) => {
        $(
            #[doc = $doc]
            pub type $name<const VERSION: u8 = 5> = MujocoEnv<$module::Task, VERSION>;
        )+

        /// An environment of this crate, of any task and version, under any wrappers.
        #[must_use]
        pub fn simulated<E: Env>(env: &E) -> Option<&dyn Simulated> {
            $($(
                if let Some(env) = env.unwrapped::<$name<$version>>() {
                    return Some(env);
                }
            )+)+
            None
        }

        /// As [`simulated`], to change it.
        #[must_use]
        pub fn simulated_mut<E: Env>(env: &mut E) -> Option<&mut dyn Simulated> {
            $($(
                if env.unwrapped::<$name<$version>>().is_some() {
                    return env.unwrapped_mut::<$name<$version>>().map(|env| env as &mut dyn Simulated);
                }
            )+)+
            None
        }
    };
}

tasks!(
    ant Ant "Walk on four legs. See [`ant`]." [2 3 4 5];
    half_cheetah HalfCheetah "Run on two legs in a plane. See [`half_cheetah`]." [2 3 4 5];
    hopper Hopper "Hop on one leg. See [`hopper`]." [2 3 4 5];
    humanoid Humanoid "Walk upright. See [`humanoid`]." [2 3 4 5];
    humanoid_standup HumanoidStandup "Stand up. See [`humanoid_standup`]." [2 4 5];
    inverted_double_pendulum InvertedDoublePendulum "Balance two poles on a cart. See [`inverted_double_pendulum`]." [2 4 5];
    inverted_pendulum InvertedPendulum "Balance a pole on a cart. See [`inverted_pendulum`]." [2 4 5];
    pusher Pusher "Push an object to a goal. See [`pusher`]." [2 4 5];
    reacher Reacher "Reach a target with an arm. See [`reacher`]." [2 4 5];
    swimmer Swimmer "Swim with three links. See [`swimmer`]." [2 3 4 5];
    walker2d Walker2d "Walk on two legs in a plane. See [`walker2d`]." [2 3 4 5];
);
