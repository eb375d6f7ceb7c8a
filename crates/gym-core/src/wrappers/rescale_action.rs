use crate::spaces::BoxSpace;
use crate::{BoxEnv, Env, Error, Outcome, Reset, Result, Space, Value, WrapperSpec};

use crate::transform::affine::{Affine, Bound};

/// Maps actions linearly from other bounds to those of the environment's `Box`.
#[derive(Clone, Debug)]
pub struct RescaleAction<E = BoxEnv> {
    env: E,
    space: Space,
    min_action: Bound,
    max_action: Bound,
    map: Affine,
    inner: Value,
}

super::reach!(RescaleAction<E>);

impl<E: Env> RescaleAction<E> {
    /// Takes actions between the new bounds, as in `RescaleAction::new(env, -1.0, 1.0)`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless the actions are real numbers in a `Box`, the lower bounds are
    /// below the upper ones, and exactly the bounds that were infinite are so again.
    pub fn new(env: E, min_action: impl Into<Bound>, max_action: impl Into<Bound>) -> Result<Self> {
        let inner = env.action_space();
        let [min_action, max_action] =
            [min_action.into(), max_action.into()].map(|bound| bound.in_type_of(&inner));
        let (map, space) = affine_map(&inner, &min_action, &max_action)?;
        Ok(Self { env, space: space.into(), min_action, max_action, map, inner: Value::Null })
    }
}

impl<E: Env> crate::Wrapper for RescaleAction<E> {
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
        let Self { env, space, map, inner, .. } = self;
        super::expect_action(space, action, inner)?;
        if let Value::Array(array) = inner {
            map.backward(array);
        }
        super::act(env, inner, observation)
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(
            WrapperSpec::new("RescaleAction")
                .arg("min_action", self.min_action.to_json())
                .arg("max_action", self.max_action.to_json()),
        )
    }
}

/// The map from an action space to the box between new bounds, and that box.
pub(crate) fn affine_map(inner: &Space, min: &Bound, max: &Bound) -> Result<(Affine, BoxSpace)> {
    let inner = super::expect_box("RescaleAction", "action", inner)?;
    let refuse = |reason: String| Error::argument("RescaleAction", reason);
    let (map, space) = Affine::new(inner, min, max).map_err(|error| refuse(error.to_string()))?;
    let mut bounds = space.low().iter_f64().zip(space.high().iter_f64());
    if let Some((bound, _)) = bounds.find(|(low, high)| low == high) {
        return Err(refuse(format!("the bounds of an element are both {bound}: they must differ")));
    }
    drop(bounds);
    Ok((map, space))
}
