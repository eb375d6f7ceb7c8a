//! Native vectors: many environments of one kind stepped by one loop, with the vector instructions
//! of the CPU that the program runs on.
//!
//! | an author implements | for |
//! |---|---|
//! | [`Task`] and [`Equations`] | a step that is a formula: one function over [`Real`] numbers steps one environment and as many as a vector register holds |
//! | [`Task`], [`Dynamics`] and [`Native`] | any other step, such as a look-up in a table: a native vector steps [one by one](Many::each), without the cost of erased environments |
//!
//! Each operation rounds alike in both, sines and squares included, so a native
//! vector gives the very numbers of a sync one.
//!
//! ```
//! use gym_core::vector::native::{self, Native};
//! use gym_core::{Configure, Env, Registration};
//!
//! /// What to register for an environment with a native vector.
//! fn registration<E, D>() -> Registration
//! where
//!     E: Env + Configure,
//!     D: Native,
//! {
//!     Registration::new::<E>("CartPole-v1").max_episode_steps(500).vector_entry_point(native::entry_point::<D>)
//! }
//! ```
//!
//! The results of an environment depend on its seed and its actions alone: they are the same bits
//! for each CPU, whatever the number of environments and its place among them.

mod columns;
mod envs;
mod equations;
mod packed;
mod snapshot;
mod step;
mod varied;

use crate::arguments;
use crate::math::Real;
use crate::registry::{ResetOptions, VectorKind, VectorSpec, find};
use crate::rng::Stream;
use crate::vector::VectorEnv;
use crate::{Dynamics, Error, Result, Task};

pub use columns::{ActionColumn, Actions, ObservationColumn};
#[doc(hidden)]
pub use columns::{block_of, indices};
pub use envs::NativeVectorEnv;
pub use equations::{Equations, Next, Of, Row};
pub use packed::{Packed, Whole};
pub use step::Many;

/// How many environments a block holds: those whose states lie together, number by number.
pub const LANES: usize = 32;

/// [`Dynamics`] that can be stepped many at once. [`Equations`] are; others implement it.
pub trait Native:
    Dynamics + Task<State: Copy, Observation: ObservationColumn, Action: ActionColumn> + Sync
{
    /// What is kept of a state between steps: `[f64; K]` for a few numbers, `u32` for one of a table,
    /// [`Whole`] for all of it.
    type Packed: Packed;

    /// What is kept of the generator: [`WordStream`](crate::rng::WordStream), unless 32-bit numbers
    /// are drawn.
    type Stream: Stream;

    /// What follows from the arguments and may differ between environments; `[f64; 0]` for nothing.
    type Constants: Packed;

    /// Whether [`info`](Task::info) has entries.
    const INFO: bool = false;

    /// Refuses arguments that only a scalar environment understands.
    ///
    /// # Errors
    /// What is not there, to go on with "in a native vector".
    fn supports(config: &Self::Config) -> Result<(), &'static str> {
        let _ = config;
        Ok(())
    }

    /// The constants for these arguments.
    fn constants(&self) -> Self::Constants;

    /// Whether [`step_usual_block`](Self::step_usual_block) is for these constants.
    fn is_usual(&self) -> bool {
        false
    }

    /// The same with other values of some arguments that are numbers.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a name or a value that cannot be, and where arguments cannot differ between the
    /// environments of a vector, as by default.
    fn with_numbers(&self, arguments: &[(String, f64)]) -> Result<Self> {
        let _ = arguments;
        Err(Error::argument(Self::NAME, "its arguments are the same for all environments of a native vector"))
    }

    /// Packs a state.
    fn pack(&self, state: &Self::State) -> Self::Packed;

    /// The state that was packed; `fresh` tells whether it is the first of an episode. What
    /// steps, [`observe`](Dynamics::observe) and [`info`](Task::info) do not look at may differ.
    fn unpack(&self, packed: Self::Packed, fresh: bool) -> Self::State;

    /// Steps the environments of a block, [one by one](Many::each). To be marked `#[inline(always)]`, with all
    /// that it calls.
    fn step_block<R: Real>(&self, token: R::Token, block: &mut Many<'_, Self>)
    where
        Self: Sized;

    /// The same where all environments have the constants that it was compiled for.
    #[inline(always)]
    fn step_usual_block<R: Real>(&self, token: R::Token, block: &mut Many<'_, Self>)
    where
        Self: Sized,
    {
        self.step_block::<R>(token, block);
    }
}

/// Makes a native vector of a registered task, for
/// [`Registration::vector_entry_point`](crate::Registration::vector_entry_point).
///
/// # Errors
/// [`Error::InvalidArgument`] for arguments that the task does not take or [does not
/// support](Native::supports) here, and as [`NativeVectorEnv::new`].
pub fn entry_point<D: Native>(spec: &VectorSpec) -> Result<Box<dyn VectorEnv>> {
    let VectorSpec { env, num_envs, autoreset_mode, each, .. } = spec;
    let refuse = |reason: String| Error::argument(format!("`{}`", env.id), reason);
    let registration = find(&env.id)?;
    let whose = format!("`{}`", env.id);
    let config = arguments::read(&D::Config::default(), registration.rules(), &env.kwargs, &whose)?;
    D::supports(&config)
        .map_err(|reason| refuse(format!("{reason} in a native vector: make a sync or async one")))?;
    let envs = NativeVectorEnv::new(D::new(config)?, *num_envs, env.max_episode_steps, *autoreset_mode)?;
    let spec = VectorSpec { vectorization_mode: VectorKind::Native, ..spec.clone() };
    Ok(Box::new(envs.with_each(each)?.registered(spec, ResetOptions(registration.reset_options))))
}
