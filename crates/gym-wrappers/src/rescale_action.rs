//! Rescaled actions.

use gym_core::registry::WrapperConfig;
use gym_core::{BoxEnv, Element, Result, Space, Value};

use crate::Bound;
use crate::affine::Affine;
use crate::map::{ActionMap, MapAction};
use crate::within::expect_box;

/// Maps actions linearly from other bounds to those of the environment's `Box`.
pub type RescaleAction<T = BoxEnv> = MapAction<T, Rescale>;

gym_core::arguments! {
    /// The arguments of [`RescaleAction`]: the new bounds of one action, infinite exactly where the
    /// old ones are, the lower below the upper.
    pub struct Config {
        /// The lower bound.
        pub min_action: Bound,
        /// The upper bound.
        pub max_action: Bound,
    }
}

impl<A: Into<Bound>, B: Into<Bound>> From<(A, B)> for Config {
    fn from((min, max): (A, B)) -> Self {
        Self {
            min_action: min.into(),
            max_action: max.into(),
        }
    }
}

/// The map of [`RescaleAction`].
#[derive(Clone, Debug)]
pub struct Rescale(Affine);

impl ActionMap for Rescale {
    type Config = Config;
    type Action<A: Element> = A;
    const TAKES_BATCHES: bool = true;

    fn new(config: &Config, inner: &Space) -> Result<(Self, Space)> {
        let inner = expect_box::<Config>("action", inner)?;
        let (map, space) = Affine::new(inner, &config.min_action, &config.max_action)
            .map_err(|error| Config::refuse(error.to_string()))?;
        let equal = space
            .low()
            .iter_f64()
            .zip(space.high().iter_f64())
            .find(|(low, high)| low == high);
        if let Some((bound, _)) = equal {
            let reason = format!("the bounds of an element are both {bound}: they must differ");
            return Err(Config::refuse(reason));
        }
        Ok((Self(map), space.into()))
    }

    fn map<'a>(&self, action: &'a mut Value, _: &'a mut Value) -> &'a Value {
        if let Value::Array(array) = action {
            self.0.backward(array);
        }
        action
    }
}

gym_core::register_wrapper!(
    "RescaleAction", "maps actions linearly from other bounds", Config,
    env: RescaleAction::new, vector: RescaleAction::new
);
