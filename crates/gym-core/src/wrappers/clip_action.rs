use crate::spaces::BoxSpace;
use crate::transform::clip::clip;
use crate::{BoxEnv, Env, Outcome, Reset, Result, Space, Value, WrapperSpec};

/// Clips actions to the bounds of the environment's `Box`, and so takes any numbers: its own action
/// space is unbounded.
#[derive(Clone, Debug)]
pub struct ClipAction<E = BoxEnv> {
    env: E,
    space: Space,
    bounds: BoxSpace,
    inner: Value,
}

super::reach!(ClipAction<E>);

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
}

impl<E: Env> crate::Wrapper for ClipAction<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)
    }

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

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(WrapperSpec::new("ClipAction"))
    }
}
