//! Native vectors: many environments of one kind stepped by one loop, with the SIMD instructions of
//! the CPU at run time.
//!
//! | an author implements | for |
//! |---|---|
//! | [`Task`] and [`Equations`] | a step that is a formula: one function over [`Real`] numbers steps one environment, or as many as a vector register holds |
//! | [`Task`], [`Dynamics`] and [`Native`] | any other step, such as a look-up in a table: a native vector steps [one by one](Many::each), without the cost of erased environments |
//!
//! Each operation rounds equally in both, including sines and squares, so a native vector has the
//! results of a sync vector.
//!
//! ```
//! use gym_core::{Configure, Env, Registration};
//! use gym_native::Native;
//!
//! /// The registration of an environment with a native vector.
//! fn registration<E, D>() -> Registration
//! where
//!     E: Env + Configure,
//!     D: Native,
//! {
//!     Registration::new::<E>("CartPole-v1").max_episode_steps(500).vector_entry_point(gym_native::entry_point::<D>)
//! }
//! ```
//!
//! The results of an environment depend only on its seed and actions: they have the same bits on
//! every CPU, for any number of environments.
//!
//! A vector steps blocks of environments: states are columns of numbers, with a generator per
//! environment next to them (32 bytes, if it draws only whole words). One driver handles time
//! limit, autoreset and seeds; a task supplies the step and the packing of its state. Constants of
//! the equations are columns too, with one block for all environments unless their arguments
//! differ. A second copy of the loop is compiled for the default constants. The loop is compiled
//! for each SIMD level, which is chosen at run time. Random draws have no branches, because the CPU
//! could not predict them.

#![warn(clippy::disallowed_methods)]

mod envs;
mod equations;
mod observations;
mod packed;
mod snapshot;
mod step;
mod varied;

use gym_core::math::Real;
use gym_core::registry::{VectorKind, VectorSpec, find};
use gym_core::rng::Stream;
use gym_core::vector::VectorEnv;
use gym_core::{Dynamics, Error, Result, Task, arguments};

pub use envs::NativeVectorEnv;
pub use gym_core::equations::{Compared, Equations, FixedArray, Next, Of};
pub use gym_core::vector::{ActionColumn, Actions};
pub use observations::ObservationColumn;
pub use packed::{Packed, Unpacked};
pub use step::Many;

/// The number of environments in a block. Their states are stored together, number by number.
pub const LANES: usize = 32;

/// [`Dynamics`] of which many environments can be stepped at once. Tasks with [`Equations`]
/// implement it.
pub trait Native:
    Dynamics + Task<State: Copy, Observation: ObservationColumn, Action: ActionColumn> + Sync
{
    /// The stored form of a state between steps: `[f64; K]` for a few numbers, `u32` for the index
    /// of a table's row, [`Unpacked`] for the state itself.
    type Packed: Packed;

    /// The stored form of the generator: [`WordStream`](gym_core::rng::WordStream), unless the task
    /// draws 32-bit numbers.
    type Stream: Stream;

    /// The constants that may differ between environments; `[f64; 0]` for none.
    type Constants: Packed;

    /// Refuses arguments that only scalar environments support.
    ///
    /// # Errors
    /// The missing feature, as text before "in a native vector".
    fn supports(config: &Self::Config) -> Result<(), &'static str> {
        let _ = config;
        Ok(())
    }

    /// The constants for the task's arguments.
    fn constants(&self) -> Self::Constants;

    /// Whether the task has the constants for which
    /// [`step_default_block`](Self::step_default_block) is compiled.
    fn has_defaults(&self) -> bool {
        false
    }

    /// The same task with other values of some numeric arguments.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an unknown name or invalid value, or if arguments cannot
    /// differ between environments (the default).
    fn with_numbers(&self, arguments: &[(String, f64)]) -> Result<Self> {
        let _ = arguments;
        Err(Error::argument(
            Self::NAME,
            "all environments of its native vector share one set of arguments: use a sync or async vector",
        ))
    }

    /// Packs a state.
    fn pack(&self, state: &Self::State) -> Self::Packed;

    /// Unpacks a state; `fresh` tells whether it is the first of an episode. Parts that steps,
    /// [`observe`](Dynamics::observe) and [`info`](Task::info) do not read may differ from the
    /// packed state.
    fn unpack(&self, packed: Self::Packed, fresh: bool) -> Self::State;

    /// Steps the environments of a block, [one by one](Many::each). Mark it and all functions that
    /// it calls `#[inline(always)]`.
    fn step_block<R: Real>(&self, token: R::Token, block: &mut Many<'_, Self>)
    where
        Self: Sized;

    /// [`step_block`](Self::step_block), compiled for the default constants.
    #[inline(always)]
    fn step_default_block<R: Real>(&self, token: R::Token, block: &mut Many<'_, Self>)
    where
        Self: Sized,
    {
        self.step_block::<R>(token, block);
    }
}

/// Makes a native vector of a registered task, for
/// [`Registration::vector_entry_point`](gym_core::Registration::vector_entry_point).
///
/// # Errors
/// [`Error::InvalidArgument`] for arguments that the task refuses or [does not
/// support](Native::supports) here, and as [`NativeVectorEnv::new`].
pub fn entry_point<D: Native>(spec: &VectorSpec) -> Result<Box<dyn VectorEnv>> {
    let VectorSpec {
        env,
        num_envs,
        autoreset_mode,
        ..
    } = spec;
    let refuse = |reason: String| Error::argument(format!("`{}`", env.id), reason);
    let registration = find(&env.id)?;
    let whose = format!("`{}`", env.id);
    let config = arguments::read(
        &D::Config::default(),
        registration.rules(),
        &env.kwargs,
        &whose,
    )?;
    D::supports(&config).map_err(|reason| {
        refuse(format!(
            "{reason} in a native vector: make a sync or async one"
        ))
    })?;
    let task = D::new(config)?;
    task.check_start()?;
    let envs = NativeVectorEnv::new(task, *num_envs, env.max_episode_steps, *autoreset_mode)?;
    let mut spec = spec.clone();
    spec.vectorization_mode = VectorKind::Native;
    Ok(Box::new(
        envs.with_each(&spec.each)?
            .registered(spec, registration.reset_options),
    ))
}

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
