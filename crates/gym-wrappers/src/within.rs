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

/// An environment or a vector, as a wrapper of either sees it when it is made. The marker,
/// [`Single`] or [`Batch`], follows from the type.
pub trait Within<Kind> {
    /// The argument of a function of observations: one, or a batch.
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

/// The accessors of a `Wrapper` whose inner environment is its field `inner`.
macro_rules! env_within {
    ($inner:ident) => {
        type Inner = $inner;

        fn inner(&self) -> &$inner {
            &self.inner
        }

        fn inner_mut(&mut self) -> &mut $inner {
            &mut self.inner
        }
    };
}

/// The accessors of a `VectorWrapper` whose inner vector is its field `inner`.
macro_rules! vector_within {
    () => {
        fn inner(&self) -> &dyn gym_core::VectorEnv {
            &self.inner
        }

        fn inner_mut(&mut self) -> &mut dyn gym_core::VectorEnv {
            &mut self.inner
        }
    };
}

/// `reset_into` of a `Wrapper` that changes no observations and has no state of an episode.
macro_rules! reset_within {
    ($inner:ident) => {
        fn reset_into(
            &mut self,
            reset: &gym_core::Reset,
            observation: &mut $inner::Observation,
        ) -> gym_core::Result<()> {
            self.inner.reset_into(reset, observation)
        }
    };
}

/// The part of a `Wrapper` that returns its own `Value`s: with the fields `inner`, `space` and
/// `seen` (the inner observation), and the method `observe(&mut self, is_reset: bool, out: &mut
/// Value)`.
macro_rules! observes {
    ($inner:ident, $seen:ident $(. $part:ident)?) => {
        type Observation = gym_core::Value;
        type Action = $inner::Action;

        env_within!($inner);

        fn observation_space(&self) -> gym_core::Space {
            self.space.clone()
        }

        fn reset_into(
            &mut self,
            reset: &gym_core::Reset,
            observation: &mut gym_core::Value,
        ) -> gym_core::Result<()> {
            let inner = &mut self.inner;
            $inner::Observation::fill(&mut self.$seen$(.$part)?, |seen| inner.reset_into(reset, seen))?;
            self.observe(true, observation)
        }

        fn step_into(
            &mut self,
            action: &$inner::Action,
            observation: &mut gym_core::Value,
        ) -> gym_core::Result<gym_core::Outcome> {
            let inner = &mut self.inner;
            let outcome =
                $inner::Observation::fill(&mut self.$seen$(.$part)?, |seen| inner.step_into(action, seen))?;
            self.observe(false, observation)?;
            Ok(outcome)
        }
    };
}

/// The same of a `VectorWrapper`: with the method `observe_columns(&mut self, n: usize, columns:
/// &mut Columns)`.
macro_rules! observes_columns {
    () => {
        vector_within!();

        fn reset_into(
            &mut self,
            reset: &gym_core::vector::VectorReset,
            columns: &mut gym_core::vector::Columns,
        ) -> gym_core::Result<()> {
            let Self { inner, seen, .. } = self;
            let (result, goes_on) = seen.fill(columns, |columns| inner.reset_into(reset, columns));
            let n = self.inner.num_envs();
            if goes_on {
                result.and(self.observe_columns(n, columns))
            } else {
                result
            }
        }

        fn step_into(
            &mut self,
            actions: &gym_core::Value,
            columns: &mut gym_core::vector::Columns,
        ) -> gym_core::Result<()> {
            let Self { inner, seen, .. } = self;
            let (result, goes_on) = seen.fill(columns, |columns| inner.step_into(actions, columns));
            let n = self.inner.num_envs();
            if goes_on {
                result.and(self.observe_columns(n, columns))
            } else {
                result
            }
        }
    };
}

/// Name and spec of a wrapper, from its field with the arguments.
macro_rules! named_by {
    ($config:ident: $type:ty) => {
        fn name(&self) -> &'static str {
            <$type>::NAME
        }

        fn wrapper_spec(&self) -> Option<gym_core::WrapperSpec> {
            Some(self.$config.spec())
        }
    };
}

/// `get_ref`, `get_mut` and `into_inner` of a wrapper with a field `inner`.
macro_rules! reach {
    ($name:ident<$inner:ident $(: $bound:path)? $(, $parameter:ident $(: $limit:path)?)*>) => {
        impl<$inner $(: $bound)? $(, $parameter $(: $limit)?)*> $name<$inner $(, $parameter)*> {
            /// The inner environment or vector.
            pub fn get_ref(&self) -> &$inner {
                &self.inner
            }

            /// The inner environment or vector, mutable. The wrapper does not see resets and steps
            /// made through it.
            pub fn get_mut(&mut self) -> &mut $inner {
                &mut self.inner
            }

            /// The inner environment or vector, without the wrapper.
            pub fn into_inner(self) -> $inner {
                self.inner
            }
        }
    };
}

/// The positional arguments, instead of a whole `Config`.
macro_rules! positional {
    ($field:ident: $type:ty) => {
        impl From<$type> for Config {
            fn from($field: $type) -> Self {
                #[allow(clippy::needless_update, reason = "there may be one argument alone")]
                Self { $field, ..Self::default() }
            }
        }
    };
    ($($field:ident: $type:ty),+) => {
        impl From<($($type),+)> for Config {
            fn from(($($field),+): ($($type),+)) -> Self {
                #[allow(clippy::needless_update, reason = "these may be all arguments")]
                Self { $($field,)+ ..Self::default() }
            }
        }
    };
}

/// The box that a wrapper needs for a space.
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

/// The image space `Box(0, 255, ..., uint8)` that a wrapper needs.
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

/// The error of an observation that is none of the space's type.
pub(crate) fn not_an_array(value: &Value) -> Error {
    Error::Contract(format!("{value} should be an array of the space's type"))
}

/// The generator of the inner environment.
pub(crate) fn lend<C: WrapperConfig>(env: &mut impl Env) -> Result<&mut Generator> {
    env.generator().ok_or_else(|| {
        let name = C::NAME;
        Error::Contract(format!(
            "{name} draws from the environment's own generator: reset it first, and implement \
             `Env::generator` where it is not"
        ))
    })
}

/// The typed element of a space that was stored as JSON.
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
