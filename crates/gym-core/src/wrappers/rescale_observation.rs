use crate::spaces::array_of;
use crate::transform::not_an_array;
use crate::{BoxEnv, Env, Error, Result, Space, Value, WrapperSpec};

use super::observation_wrapper;
use crate::transform::affine::{Affine, Bound};

/// Maps observations linearly from the bounds of their `Box` to others.
#[derive(Clone, Debug)]
pub struct RescaleObservation<E = BoxEnv> {
    env: E,
    space: Space,
    min_obs: Bound,
    max_obs: Bound,
    map: Affine,
    inner: Value,
}

impl<E: Env> RescaleObservation<E> {
    /// Rescales the observations of `env`, as in `RescaleObservation::new(env, -1.0, 1.0)`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless the observations are real numbers in a `Box`, the lower bounds
    /// are not above the upper ones, and exactly the bounds that were infinite are so again.
    pub fn new(env: E, min_obs: impl Into<Bound>, max_obs: impl Into<Bound>) -> Result<Self> {
        let inner = env.observation_space();
        let [min_obs, max_obs] = [min_obs.into(), max_obs.into()].map(|bound| bound.in_type_of(&inner));
        let inner = super::expect_box("RescaleObservation", "observation", &inner)?;
        let (map, space) = Affine::new(inner, &min_obs, &max_obs)
            .map_err(|error| Error::argument("RescaleObservation", error.to_string()))?;
        Ok(Self { env, space: space.into(), min_obs, max_obs, map, inner: Value::Null })
    }

    fn observe(&self, out: &mut Value) -> Result<()> {
        let (Some(inner), Space::Box(space)) = (self.inner.as_array(), &self.space) else {
            return Err(not_an_array(&self.inner));
        };
        let array = array_of(out, space.dtype(), space.shape());
        array.assign_cast(inner)?;
        self.map.forward(array);
        Ok(())
    }

    fn stored(&self) -> WrapperSpec {
        WrapperSpec::new("RescaleObservation")
            .arg("min_obs", self.min_obs.to_json())
            .arg("max_obs", self.max_obs.to_json())
    }
}

observation_wrapper!(RescaleObservation);
