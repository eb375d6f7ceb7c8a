//! The traits of a domain and its tasks.

use std::borrow::Cow;
use std::fmt;

use gym_core::registry::{Clip, Exceptions, build};
use gym_core::vector::{BoxVector, VectorSpec, lockstep};
use gym_core::wrappers::TimeLimit;
use gym_core::{Arguments, EnvSpec, Error, Registration, Result};
use gym_mujoco::tasks::Derived;
use gym_mujoco::{CompiledModel, Data, Model};

use crate::arguments::Common;
use crate::env::{ControlEnv, Of};
use crate::observation::Observation;
use crate::start::Start;

/// A domain: a model, and the constructor of its tasks. `Config` is a struct of
/// [`gym_core::arguments!`] that contains [`Common`].
pub trait Domain: Task + Clone {
    /// The arguments.
    type Config: Arguments + AsRef<Common>;

    /// The name of the domain.
    const NAME: &'static str;

    /// The number of timesteps per step.
    const TIMESTEPS: usize = 1;

    /// The model, in MJCF.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    fn text(config: &Self::Config) -> Result<Cow<'static, str>>;

    /// Builds the task for its model. Look up bodies and joints here, once per environment.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    fn new(config: &Self::Config, model: &Model) -> Result<Self>;
}

/// A task: its initial states, observations and rewards.
pub trait Task: fmt::Debug + Send + Sync + 'static {
    /// Draws positions and velocities: dm_control's `initialize_episode`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if no valid initial state is found.
    fn start(&self, start: &mut Start<'_>) -> Result<()>;

    /// Writes the constants that [`start`](Self::start) drew to the model.
    fn apply(&self, constants: &[f64], model: &mut CompiledModel) {
        let _ = (constants, model);
    }

    /// Whether `constants` has the number of constants that [`start`](Self::start) draws.
    fn has(&self, constants: &[f64]) -> bool {
        constants.is_empty()
    }

    /// The derived arrays that observations, rewards and ends of episodes read, beside time,
    /// positions, velocities and controls. Vectors then step several worlds together, and compute
    /// other arrays only on request. With `None`, worlds step one by one.
    fn reads(&self, model: &Model) -> Option<Vec<Derived>> {
        let _ = model;
        None
    }

    /// Adds the parts of the observation, in dm_control's order.
    fn observe(&self, model: &Model, data: &Data, out: &mut Observation);

    /// The reward of the step that led to this state.
    fn reward(&self, model: &Model, data: &Data) -> f64;

    /// Whether the episode terminates.
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

/// The conformance exceptions of tasks with an argument `stand_height`.
pub(crate) const STANDING: Exceptions = &[
    LIMIT,
    COLOURS,
    (
        "arguments-matter.stand_height",
        "who lies is not rewarded at any height",
    ),
];

/// The conformance exceptions of tasks with an argument `target_size`.
pub(crate) const TARGET: Exceptions = &[
    LIMIT,
    COLOURS,
    (
        "arguments-matter.target_size",
        "a target is at most 0.2 m wide, which is less than what is tried for 0",
    ),
];

/// The conformance exceptions of tasks whose controls have no limits.
pub(crate) const UNLIMITED: Exceptions = &[
    LIMIT,
    COLOURS,
    (
        "reward-finite",
        "the cost of a huge action is infinite, as in dm_control",
    ),
];

/// Returns the clip on a domain's page: one episode, of which every `every`-th state is shown.
pub(crate) const fn clip(every: u32) -> Clip {
    Clip {
        seeds: 0..1,
        every,
        frames: 48,
        size: (160, 120),
    }
}

/// The registration that all tasks share.
pub const fn register<D: Domain>(id: &'static str, description: &'static str) -> Registration {
    Registration::new::<Of<D>>(id)
        .description(description)
        .exceptions(&[LIMIT, COLOURS])
        .lockstep_by::<ControlEnv>(vector::<D>)
}

/// Makes a native vector. Its environments share one model, so that their worlds can step together,
/// unless the start of an episode changes the model.
fn vector<D: Domain>(spec: &VectorSpec) -> Result<BoxVector> {
    vector_of(spec, build::<Of<D>>)
}

fn vector_of(spec: &VectorSpec, make: fn(&EnvSpec) -> Result<ControlEnv>) -> Result<BoxVector> {
    let first = make(&spec.env)?;
    let make = |index| {
        if spec.each.is_empty() {
            return Ok(first.clone());
        }
        make(&spec.env_at(index))
    };
    match spec.env.max_episode_steps {
        Some(limit) => {
            let limited = |index| TimeLimit::new(make(index)?, limit);
            lockstep::native::<ControlEnv, _>(spec, limited)
        }
        None => lockstep::native::<ControlEnv, _>(spec, make),
    }
}

/// Returns the id of the body `name`.
pub(crate) fn body(m: &Model, name: &str) -> Result<usize> {
    named("body", name, m.body_id(name))
}

/// Returns the id of the geom `name`.
pub(crate) fn geom(m: &Model, name: &str) -> Result<usize> {
    named("geom", name, m.geom_id(name))
}

/// Returns the id of the site `name`.
pub(crate) fn site(m: &Model, name: &str) -> Result<usize> {
    named("site", name, m.site_id(name))
}

/// Returns the id of the joint `name`.
pub(crate) fn joint(m: &Model, name: &str) -> Result<usize> {
    named("joint", name, m.joint_id(name))
}

/// Returns the id `id` of the object `name`, or an error if the model has no such object.
///
/// # Errors
/// [`Error::InvalidArgument`] if there is none.
pub(crate) fn named(what: &str, name: &str, id: Option<usize>) -> Result<usize> {
    id.ok_or_else(|| Error::argument("model", format!("the model has no {what} {name:?}")))
}
