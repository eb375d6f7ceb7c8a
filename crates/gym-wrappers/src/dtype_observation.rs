//! Observations cast to another type of number.

use gym_core::registry::WrapperConfig;
use gym_core::spaces::{BoxSpace, MultiDiscrete};
use gym_core::{Array, BoxEnv, DType, Data, Result, Space, Value};

use crate::map::{MapObservation, ObservationMap};
use crate::within::not_an_array;

/// Casts array and integer observations to another type of number, as numpy's `astype`.
pub type DtypeObservation<T = BoxEnv> = MapObservation<T, Cast>;

gym_core::arguments! {
    /// The arguments of [`DtypeObservation`].
    #[derive(Copy)]
    pub struct Config {
        /// The type, such as `float64`; the bounds of the observations must fit it.
        pub dtype: DType,
    }
}

impl From<DType> for Config {
    fn from(dtype: DType) -> Self {
        Self { dtype }
    }
}

/// The map of [`DtypeObservation`].
#[derive(Clone, Copy, Debug)]
pub struct Cast;

impl ObservationMap for Cast {
    type Config = Config;
    const TAKES_BATCHES: bool = true;

    fn new(&Config { dtype }: &Config, inner: &Space) -> Result<(Self, Space)> {
        let space = match inner {
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
                    Array::new(
                        space.shape(),
                        Data::from_i64(DType::I64, numbers.iter().copied()),
                    )
                };
                let nvec = MultiDiscrete::new(array(space.nvec())?)?;
                nvec.with_start(array(space.start())?)?
                    .with_dtype(dtype)?
                    .into()
            }
            Space::MultiBinary(space) => BoxSpace::uniform(0.0, 1.0, space.shape(), dtype)?.into(),
            space => {
                return Err(Config::refuse(format!(
                    "it needs a Box, Discrete, MultiDiscrete or MultiBinary observation space, and this one is {space}"
                )));
            }
        };
        Ok((Self, space))
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        match (inner, out) {
            (Value::Array(inner), Value::Array(out)) => out.assign_cast(inner),
            (Value::Int(i), Value::Array(out)) => {
                out.fill_int(*i);
                Ok(())
            }
            _ => Err(not_an_array(inner)),
        }
    }
}

/// A bound cast like the observations: real bounds of integer observations are truncated.
fn cast_bound(bound: &Array, dtype: DType) -> Result<Array> {
    if dtype.is_float() || !bound.dtype().is_float() {
        return Ok(bound.clone());
    }
    Array::new(
        bound.shape(),
        Data::from_f64(DType::F64, bound.iter_f64().map(f64::trunc)),
    )
}

gym_core::register_wrapper!(
    "DtypeObservation", "casts observations to another type of number", Config,
    env: DtypeObservation::new, vector: DtypeObservation::new
);
