use crate::spaces::{BoxSpace, array_of};
use crate::transform::not_an_array;
use crate::{Array, BoxEnv, Env, Error, Result, Space, Value, WrapperSpec};

use super::observation_wrapper;

/// Gives array observations another shape of as many elements.
#[derive(Clone, Debug)]
pub struct ReshapeObservation<E = BoxEnv> {
    env: E,
    space: Space,
    inner: Value,
}

impl<E: Env> ReshapeObservation<E> {
    /// Reshapes the observations of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if they are not in a `Box`, or have another number of elements.
    pub fn new(env: E, shape: impl Into<Vec<usize>>) -> Result<Self> {
        let (inner, shape) = (env.observation_space(), shape.into());
        let inner = super::expect_box("ReshapeObservation", "observation", &inner)?;
        let reshape = |bound: &Array| {
            bound.clone().reshape(shape.clone()).map_err(|_| {
                let reason = format!("shape {shape:?} does not hold the elements of {inner}");
                Error::argument("ReshapeObservation", reason)
            })
        };
        let space = BoxSpace::new(reshape(inner.low())?, reshape(inner.high())?)?.into();
        Ok(Self { env, space, inner: Value::Null })
    }

    fn observe(&self, out: &mut Value) -> Result<()> {
        let (Some(inner), Space::Box(space)) = (self.inner.as_array(), &self.space) else {
            return Err(not_an_array(&self.inner));
        };
        array_of(out, space.dtype(), space.shape()).assign_cast(inner)
    }

    fn stored(&self) -> WrapperSpec {
        WrapperSpec::new("ReshapeObservation").arg("shape", self.space.shape().unwrap_or_default())
    }
}

observation_wrapper!(ReshapeObservation);
