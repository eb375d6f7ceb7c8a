//! Reshaped observations.

use gym_core::registry::WrapperConfig;
use gym_core::spaces::BoxSpace;
use gym_core::{Array, BoxEnv, Result, Space, Value};

use crate::map::{MapObservation, ObservationMap};
use crate::within::{expect_box, not_an_array};

/// Gives array observations another shape with the same number of elements.
pub type ReshapeObservation<T = BoxEnv> = MapObservation<T, Reshape>;

gym_core::arguments! {
    /// The arguments of [`ReshapeObservation`].
    pub struct Config {
        /// The shape of one observation.
        pub shape: Vec<usize>,
    }
}

impl<const N: usize> From<[usize; N]> for Config {
    fn from(shape: [usize; N]) -> Self {
        Self {
            shape: shape.into(),
        }
    }
}

/// The map of [`ReshapeObservation`].
#[derive(Clone, Copy, Debug)]
pub struct Reshape;

impl ObservationMap for Reshape {
    type Config = Config;
    const TAKES_BATCHES: bool = true;

    fn new(Config { shape }: &Config, inner: &Space) -> Result<(Self, Space)> {
        let inner = expect_box::<Config>("observation", inner)?;
        let reshape = |bound: &Array| {
            let misfit = |_| {
                Config::refuse(format!(
                    "shape {shape:?} does not hold the elements of {inner}"
                ))
            };
            bound.clone().reshape(shape.clone()).map_err(misfit)
        };
        Ok((
            Self,
            BoxSpace::new(reshape(inner.low())?, reshape(inner.high())?)?.into(),
        ))
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        match (inner, out) {
            (Value::Array(inner), Value::Array(out)) => out.assign_cast(inner),
            _ => Err(not_an_array(inner)),
        }
    }
}

gym_core::register_wrapper!(
    "ReshapeObservation", "reshapes observations", Config,
    env: ReshapeObservation::new, vector: ReshapeObservation::new
);
