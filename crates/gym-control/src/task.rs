//! What a domain has to say.

use std::borrow::Cow;
use std::fmt;

use gym_core::registry::Exceptions;
use gym_core::{Arguments, Error, Registration, Result};
use gym_mujoco::{CompiledModel, Data, Model};

use crate::arguments::Common;
use crate::env::ControlEnv;
use crate::observation::Observation;
use crate::start::Start;

/// A domain of tasks with one model: its starts, observations and rewards.
///
/// It is built once for an environment from arguments, which are a struct of
/// [`gym_core::arguments!`] with [`Common`] in it, and looks up bodies and joints then.
pub trait Task: Clone + fmt::Debug + Send + Sync + Sized + 'static {
    /// The arguments.
    type Config: Arguments + AsRef<Common> + Clone + PartialEq + fmt::Debug + Send + Sync + 'static;

    /// The name of the domain.
    const NAME: &'static str;

    /// The model's timesteps per step.
    const TIMESTEPS: usize = 1;

    /// The model, in MJCF.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    fn text(config: &Self::Config) -> Result<Cow<'static, str>>;

    /// The task on its model.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    fn new(config: &Self::Config, model: &Model) -> Result<Self>;

    /// Draws positions and velocities: dm_control's `initialize_episode`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if no start was found.
    fn start(&self, start: &mut Start<'_>) -> Result<()>;

    /// Puts the constants that a start drew into the figures of the model.
    fn apply(&self, constants: &[f64], model: &mut CompiledModel) {
        let _ = (constants, model);
    }

    /// Whether there are as many constants as a start draws.
    fn has(&self, constants: &[f64]) -> bool {
        constants.is_empty()
    }

    /// Puts the parts of the observation in, in the order of the package.
    fn observe(&self, model: &Model, data: &Data, out: &mut Observation);

    /// The reward of the step to this state.
    fn reward(&self, model: &Model, data: &Data) -> f64;

    /// Whether the episode ends.
    fn is_over(&self, data: &Data) -> bool {
        let _ = data;
        false
    }
}

const LIMIT: (&str, &str) = (
    "arguments-matter.time_limit",
    "it ends episodes of a thousand steps",
);
const COLOURS: (&str, &str) = (
    "arguments-matter.visualize_reward",
    "a reward of 0 changes no colour",
);

/// For tasks with an argument `stand_height`.
pub(crate) const STANDING: Exceptions = &[
    LIMIT,
    COLOURS,
    (
        "arguments-matter.stand_height",
        "who lies is not rewarded at any height",
    ),
];

/// For tasks with an argument `target_size`.
pub(crate) const TARGET: Exceptions = &[
    LIMIT,
    COLOURS,
    (
        "arguments-matter.target_size",
        "a target is at most 0.2 m wide, which is less than what is tried for 0",
    ),
];

/// For tasks whose controls have no limits.
pub(crate) const UNLIMITED: Exceptions = &[
    LIMIT,
    COLOURS,
    (
        "reward-finite",
        "the cost of a huge action is infinite, as in dm_control",
    ),
];

/// The registration that all tasks share.
pub const fn register<T: Task>(id: &'static str, description: &'static str) -> Registration {
    Registration::new::<ControlEnv<T>>(id)
        .description(description)
        .exceptions(&[LIMIT, COLOURS])
        .lockstep::<ControlEnv<T>>()
}

/// An object of the model that the task names.
///
/// # Errors
/// [`Error::InvalidArgument`] if there is none.
pub(crate) fn named(what: &str, name: &str, id: Option<usize>) -> Result<usize> {
    id.ok_or_else(|| Error::argument("model", format!("the model has no {what} {name:?}")))
}
