//! Gymnasium's eleven MuJoCo tasks: one file for each, in all its versions.
//!
//! ```
//! use gym_core::{EnvExt, Result, make};
//! use gym_mujoco as _;
//!
//! # fn main() -> Result<()> {
//! let mut env = make("HalfCheetah-v5")?;
//! env.reset(1)?;
//! # Ok(())
//! # }
//! ```
//!
//! A task defines initial states, rewards, observations and `info`; [`SimEnv`](gym_sim::SimEnv) is
//! its environment, and [`mujoco_engine`] its physics. Versions differ in data: the tables of
//! arguments, the names of entries of `info`, and flags that a task reads when it is built.
//!
//! Versions 4 and 5 are those of Gymnasium 1.4.0. Versions 2 and 3, which Gymnasium itself no
//! longer runs, follow Gymnasium 0.29.1 on the same engine.
//!
//! Linking this crate registers the tasks; name it (`use gym_mujoco as _;`) if nothing else of it
//! is used.

#![warn(clippy::disallowed_methods)]

mod bodies;
mod cost;
mod models;
mod motion;
mod noise;
mod range;
pub mod recording;
mod runner;

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
use gym_core::{Error, Result};
use gym_sim::{Common, Entry, Family, Simulation, Stepper};

pub use models::{load, models};
pub use range::Range;

/// The family of Gymnasium's MuJoCo tasks.
#[derive(Clone, Copy, Debug)]
pub struct Gymnasium;

impl Family for Gymnasium {
    const NAME: &'static str = "MujocoEnv";

    const NEWEST: u32 = 5;

    fn simulation(arguments: &Common, version: u32) -> Result<Simulation> {
        if version < 2 {
            let newest = Self::NEWEST;
            let reason = format!(
                "version {version} does not exist: set 2 to {newest} with `Registration::version`"
            );
            return Err(Error::argument("version", reason));
        }
        let load = || load(&arguments.xml_file, arguments.mujoco.0);
        // MuJoCo 2.0's Python interface computed no contact forces
        let stepper = Stepper::Behind {
            contact_forces: version >= 4,
        };
        Simulation::new(load, arguments, stepper)
    }
}

/// Walk on four legs. See [`ant`].
pub type Ant = Entry<ant::Task, Gymnasium>;
/// Run on two legs in a plane. See [`half_cheetah`].
pub type HalfCheetah = Entry<half_cheetah::Task, Gymnasium>;
/// Hop on one leg. See [`hopper`].
pub type Hopper = Entry<hopper::Task, Gymnasium>;
/// Walk upright. See [`humanoid`].
pub type Humanoid = Entry<humanoid::Task, Gymnasium>;
/// Stand up. See [`humanoid_standup`].
pub type HumanoidStandup = Entry<humanoid_standup::Task, Gymnasium>;
/// Balance two poles on a cart. See [`inverted_double_pendulum`].
pub type InvertedDoublePendulum = Entry<inverted_double_pendulum::Task, Gymnasium>;
/// Balance a pole on a cart. See [`inverted_pendulum`].
pub type InvertedPendulum = Entry<inverted_pendulum::Task, Gymnasium>;
/// Push an object to a goal. See [`pusher`].
pub type Pusher = Entry<pusher::Task, Gymnasium>;
/// Reach a target with an arm. See [`reacher`].
pub type Reacher = Entry<reacher::Task, Gymnasium>;
/// Swim with three links. See [`swimmer`].
pub type Swimmer = Entry<swimmer::Task, Gymnasium>;
/// Walk on two legs in a plane. See [`walker2d`].
pub type Walker2d = Entry<walker2d::Task, Gymnasium>;

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

gym_core::family!(gym_core::registry::Family::new("MuJoCo", 40));

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
