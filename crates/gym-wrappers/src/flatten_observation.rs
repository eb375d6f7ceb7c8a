//! Flattened observations.

use gym_core::{BoxEnv, Error, Result, Space, Value};

use crate::map::{MapObservation, ObservationMap};

/// Flattens observations to one row of numbers: [`Space::flatten`].
pub type FlattenObservation<T = BoxEnv> = MapObservation<T, Flatten>;

gym_core::arguments! {
    /// [`FlattenObservation`] has no arguments.
    pub struct Config {}
}

/// The map of [`FlattenObservation`], with the space that it flattens.
#[derive(Clone, Debug)]
pub struct Flatten(Space);

impl ObservationMap for Flatten {
    type Config = Config;

    fn new(_: &Config, inner: &Space) -> Result<(Self, Space)> {
        Ok((Self(inner.clone()), inner.flatten_space()?))
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        match out {
            Value::Array(array) => {
                let broken = |error: Error| Error::Contract(error.to_string());
                self.0.flatten_into(inner, array).map_err(broken)
            }
            // the length of the row is not fixed
            out => {
                *out = self.0.flatten(inner)?;
                Ok(())
            }
        }
    }
}

gym_core::register_wrapper!(
    "FlattenObservation", "flattens observations to one row of numbers", Config,
    env: FlattenObservation::new, vector: FlattenObservation::new
);
