//! Actions clipped.

use gym_core::spaces::BoxSpace;
use gym_core::{BoxEnv, Element, Result, Space, Value};

use crate::map::{ActionMap, MapAction};
use crate::within::expect_box;

/// Clips actions to the bounds of the environment's `Box`. Its own action space is unbounded.
pub type ClipAction<T = BoxEnv> = MapAction<T, Clip>;

gym_core::arguments! {
    /// [`ClipAction`] has no arguments.
    pub struct Config {}
}

/// The bounds of [`ClipAction`].
#[derive(Clone, Debug)]
pub struct Clip(BoxSpace);

impl ActionMap for Clip {
    type Config = Config;
    type Action<A: Element> = A;
    const TAKES_BATCHES: bool = true;

    /// Unsigned integers are refused, as their space cannot be unbounded.
    fn new(_: &Config, inner: &Space) -> Result<(Self, Space)> {
        let bounds = expect_box::<Config>("action", inner)?;
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        let space = BoxSpace::uniform(low, high, bounds.shape(), bounds.dtype())?;
        Ok((Self(bounds.clone()), space.into()))
    }

    fn map<'a>(&self, action: &'a mut Value, _: &'a mut Value) -> &'a Value {
        if let Value::Array(array) = action {
            array.clip(self.0.low(), self.0.high());
        }
        action
    }
}

gym_core::register_wrapper!(
    "ClipAction", "clips actions to the bounds of their space", Config,
    env: ClipAction::new, vector: ClipAction::new
);
