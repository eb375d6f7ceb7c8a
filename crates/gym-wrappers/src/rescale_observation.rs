//! Rescaled observations.

use gym_core::registry::WrapperConfig;
use gym_core::{BoxEnv, Result, Space, Value};

use crate::Bound;
use crate::affine::Affine;
use crate::map::{MapObservation, ObservationMap};
use crate::within::{expect_box, not_an_array};

/// Maps observations linearly from the bounds of their `Box` to others.
pub type RescaleObservation<T = BoxEnv> = MapObservation<T, Rescale>;

gym_core::arguments! {
    /// The arguments of [`RescaleObservation`]: the new bounds of one observation, infinite exactly
    /// where the old ones are, the lower not above the upper.
    pub struct Config {
        /// The lower bound.
        pub min_obs: Bound,
        /// The upper bound.
        pub max_obs: Bound,
    }
}

impl<A: Into<Bound>, B: Into<Bound>> From<(A, B)> for Config {
    fn from((min, max): (A, B)) -> Self {
        Self {
            min_obs: min.into(),
            max_obs: max.into(),
        }
    }
}

/// The map of [`RescaleObservation`].
#[derive(Clone, Debug)]
pub struct Rescale(Affine);

impl ObservationMap for Rescale {
    type Config = Config;
    const TAKES_BATCHES: bool = true;

    fn new(config: &Config, inner: &Space) -> Result<(Self, Space)> {
        let inner = expect_box::<Config>("observation", inner)?;
        let (map, space) = Affine::new(inner, &config.min_obs, &config.max_obs)
            .map_err(|error| Config::refuse(error.to_string()))?;
        Ok((Self(map), space.into()))
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        let (Value::Array(inner), Value::Array(out)) = (inner, out) else {
            return Err(not_an_array(inner));
        };
        out.assign_cast(inner)?;
        self.0.forward(out);
        Ok(())
    }
}

gym_core::register_wrapper!(
    "RescaleObservation", "maps observations linearly to other bounds", Config,
    env: RescaleObservation::new, vector: RescaleObservation::new
);
