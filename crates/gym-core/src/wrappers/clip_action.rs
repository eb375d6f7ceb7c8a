use crate::spaces::BoxSpace;
use crate::transform::clip::clip;
use crate::{Env, EnvSpec, Outcome, Result, Space, Value, WrapperSpec};

/// Clips actions to the bounds of the environment's `Box`, and so takes any numbers: its own action
/// space is unbounded.
#[derive(Clone, Debug)]
pub struct ClipAction<E> {
    env: E,
    space: Space,
    bounds: BoxSpace,
    inner: Value,
}

impl<E: Env> ClipAction<E> {
    /// Clips the actions for `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) if they are not in a `Box`;
    /// [`Error::InvalidSpace`](crate::Error::InvalidSpace) if they are unsigned integers, whose space
    /// cannot be unbounded.
    pub fn new(env: E) -> Result<Self> {
        let bounds = super::expect_box("ClipAction", "action", &env.action_space())?.clone();
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        let space = BoxSpace::uniform(low, high, bounds.shape(), bounds.dtype())?.into();
        Ok(Self { env, space, bounds, inner: Value::Null })
    }

    /// The environment within.
    pub fn into_inner(self) -> E {
        self.env
    }
}

impl<E: Env> Env for ClipAction<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    fn action_space(&self) -> Space {
        self.space.clone()
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let Self { env, space, bounds, inner } = self;
        super::expect_action(space, action, inner)?;
        if let Value::Array(array) = inner {
            clip(array, bounds);
        }
        super::act(env, inner, observation)
    }

    fn spec(&self) -> Option<EnvSpec> {
        self.env.spec().map(|spec| spec.wrapped(WrapperSpec::new("ClipAction")))
    }

    crate::forward!(
        env: reset_into, observation_space, snapshot, restore, info, metadata, draw, ansi, render, base, generator, close,
        describe
    );
}
