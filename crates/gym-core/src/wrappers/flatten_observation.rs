use crate::spaces::array_of;
use crate::{BoxEnv, Env, Error, Result, Space, Value, WrapperSpec};

use super::observation_wrapper;

/// Flattens observations to one row of numbers: [`Space::flatten`].
#[derive(Clone, Debug)]
pub struct FlattenObservation<E = BoxEnv> {
    env: E,
    space: Space,
    inner_space: Space,
    inner: Value,
}

impl<E: Env> FlattenObservation<E> {
    /// Flattens the observations of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] as [`Space::flatten_space`].
    pub fn new(env: E) -> Result<Self> {
        let inner_space = env.observation_space();
        Ok(Self { space: inner_space.flatten_space()?, inner_space, inner: Value::Null, env })
    }

    fn observe(&self, out: &mut Value) -> Result<()> {
        let Space::Box(space) = &self.space else {
            *out = self.inner_space.flatten(&self.inner)?;
            return Ok(());
        };
        let array = array_of(out, space.dtype(), space.shape());
        self.inner_space.flatten_into(&self.inner, array).map_err(|error| Error::Contract(error.to_string()))
    }

    fn stored(&self) -> WrapperSpec {
        WrapperSpec::new("FlattenObservation")
    }
}

observation_wrapper!(FlattenObservation);
