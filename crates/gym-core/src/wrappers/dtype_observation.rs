use crate::spaces::{BoxSpace, MultiDiscrete, array_of};
use crate::transform::not_an_array;
use crate::{Array, BoxEnv, DType, Data, Env, Error, Result, Space, Value, WrapperSpec};

use super::observation_wrapper;

/// Casts array and integer observations to another type of number, as numpy's `astype`.
#[derive(Clone, Debug)]
pub struct DtypeObservation<E = BoxEnv> {
    env: E,
    space: Space,
    dtype: DType,
    inner: Value,
}

impl<E: Env> DtypeObservation<E> {
    /// Casts the observations of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless they are in a `Box`, `Discrete`, `MultiDiscrete` or
    /// `MultiBinary`; [`Error::InvalidSpace`] if the type does not hold their bounds.
    pub fn new(env: E, dtype: DType) -> Result<Self> {
        let space = match env.observation_space() {
            Space::Box(space) => {
                let cast = |bound: &Array| cast_bound(bound, dtype);
                BoxSpace::with_dtype(cast(space.low())?, cast(space.high())?, dtype)?.into()
            }
            Space::Discrete(space) => {
                let bound = |x| Array::new([], Data::from_i64(DType::I64, [x]));
                BoxSpace::with_dtype(bound(space.start())?, bound(space.last())?, dtype)?.into()
            }
            Space::MultiDiscrete(space) => {
                let array = |numbers: &[i64]| {
                    Array::new(space.shape(), Data::from_i64(DType::I64, numbers.iter().copied()))
                };
                MultiDiscrete::new(array(space.nvec())?)?
                    .with_start(array(space.start())?)?
                    .with_dtype(dtype)?
                    .into()
            }
            Space::MultiBinary(space) => BoxSpace::uniform(0.0, 1.0, space.shape(), dtype)?.into(),
            space => {
                let reason = format!(
                    "it needs a Box, Discrete, MultiDiscrete or MultiBinary observation space, and this one is {space}"
                );
                return Err(Error::argument("DtypeObservation", reason));
            }
        };
        Ok(Self { env, space, dtype, inner: Value::Null })
    }

    fn observe(&self, out: &mut Value) -> Result<()> {
        let array = array_of(out, self.dtype, self.space.shape().unwrap_or_default());
        match &self.inner {
            Value::Array(inner) => array.assign_cast(inner),
            Value::Int(i) => {
                array.fill_int(*i);
                Ok(())
            }
            other => Err(not_an_array(other)),
        }
    }

    fn stored(&self) -> WrapperSpec {
        WrapperSpec::new("DtypeObservation").arg("dtype", self.dtype.name())
    }
}

/// The bounds, cut off as the observations are where integers are to come of real numbers.
fn cast_bound(bound: &Array, dtype: DType) -> Result<Array> {
    if dtype.is_float() || !bound.dtype().is_float() {
        return Ok(bound.clone());
    }
    Array::new(bound.shape(), Data::from_f64(DType::F64, bound.iter_f64().map(f64::trunc)))
}

observation_wrapper!(DtypeObservation);
