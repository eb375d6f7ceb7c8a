//! Shared parts of wrappers: the inner environment or vector, and typed actions.

use gym_core::registry::WrapperConfig;
use gym_core::spaces::BoxSpace;
use gym_core::{Element, Env, Error, Generator, Outcome, Result, Space, Value, VectorEnv};
use serde_json::Value as Json;

use crate::map::Seen;

/// Marks [`Within`] for an environment.
#[derive(Debug)]
pub struct Single;

/// Marks [`Within`] for a vector.
#[derive(Debug)]
pub struct Batch;

/// The interface of an inner environment or vector for the constructors of wrappers. The type
/// determines the marker `Kind`: [`Single`] or [`Batch`].
pub trait Within<Kind> {
    /// One observation, or a batch.
    type Observation: Element;
    /// A buffer for the inner observation.
    type Buffer;

    /// An empty buffer.
    fn buffer() -> Self::Buffer;

    /// The space of each observation.
    fn observations(&self) -> Space;

    /// The space of each action.
    fn actions(&self) -> Space;

    /// The number of environments.
    fn count(&self) -> usize;
}

impl<E: Env> Within<Single> for E {
    type Observation = E::Observation;
    type Buffer = E::Observation;

    fn buffer() -> E::Observation {
        E::Observation::empty()
    }

    fn observations(&self) -> Space {
        self.observation_space()
    }

    fn actions(&self) -> Space {
        self.action_space()
    }

    fn count(&self) -> usize {
        1
    }
}

impl<V: VectorEnv> Within<Batch> for V {
    type Observation = Value;
    type Buffer = Seen;

    fn buffer() -> Seen {
        Seen::default()
    }

    fn observations(&self) -> Space {
        self.single_observation_space()
    }

    fn actions(&self) -> Space {
        self.single_action_space()
    }

    fn count(&self) -> usize {
        self.num_envs()
    }
}

/// The box space that a wrapper needs, or an error.
pub(crate) fn expect_box<'a, C: WrapperConfig>(
    kind: &str,
    space: &'a Space,
) -> Result<&'a BoxSpace> {
    match space {
        Space::Box(space) => Ok(space),
        _ => Err(C::refuse(format!(
            "it needs a Box {kind} space, and this one is {space}"
        ))),
    }
}

/// The image space `Box(0, 255, ..., uint8)` that a wrapper needs, or an error.
pub(crate) fn expect_picture<C: WrapperConfig>(space: &Space) -> Result<&BoxSpace> {
    let space = expect_box::<C>("observation", space)?;
    let is_picture = space.dtype() == gym_core::DType::U8
        && space.low().iter_f64().all(|x| x == 0.0)
        && space.high().iter_f64().all(|x| x == 255.0);
    if is_picture {
        return Ok(space);
    }
    Err(C::refuse(format!(
        "it needs uint8 observations from 0 to 255, and the space is {space}"
    )))
}

/// The error of an observation that is not an array of the space's type.
pub(crate) fn not_an_array(value: &Value) -> Error {
    Error::Contract(format!("{value} should be an array of the space's type"))
}

/// Returns the generator of the inner environment; an error if the inner environment has no
/// generator.
pub(crate) fn lend<C: WrapperConfig>(env: &mut impl Env) -> Result<&mut Generator> {
    env.generator().ok_or_else(|| {
        let name = C::NAME;
        Error::Contract(format!(
            "{name} draws from the environment's own generator: reset it first, and implement \
             `Env::generator` where it is not"
        ))
    })
}

/// Reads a typed element of a space from JSON.
pub(crate) fn element<T: Element>(space: &Space, json: &Json) -> Result<T> {
    let value = space
        .from_json(json)
        .map_err(|error| Error::Snapshot(error.to_string()))?;
    T::from_value(&value).ok_or_else(|| Error::Snapshot(format!("{value} has the wrong type")))
}

/// Takes a step with the typed form of an action.
pub(crate) fn act<E: Env>(
    env: &mut E,
    action: &Value,
    observation: &mut E::Observation,
) -> Result<Outcome> {
    E::Action::with(action, |action| env.step_into(action, observation))
        .unwrap_or_else(|| Err(env.action_space().refuse_action(action)))
}
