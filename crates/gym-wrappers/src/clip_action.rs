//! Clipped actions.

use gym_core::spaces::BoxSpace;
use gym_core::{Array, BoxEnv, DType, Element, Result, Space, Value};

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
pub struct Clip {
    bounds: BoxSpace,
    /// The bounds for `float64` actions.
    wide: [Array; 2],
}

impl ActionMap for Clip {
    type Config = Config;
    type Action<A: Element> = A;
    const TAKES_BATCHES: bool = true;

    /// Refuses boxes of unsigned integers, which cannot be unbounded.
    fn new(_: &Config, inner: &Space) -> Result<(Self, Space)> {
        let bounds = expect_box::<Config>("action", inner)?;
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        let space = BoxSpace::uniform(low, high, bounds.shape(), bounds.dtype())?;
        let wide = |bound: &Array| {
            let mut wide = Array::zeros(DType::F64, bound.shape())?;
            wide.assign_cast(bound).map(|()| wide)
        };
        let wide = [wide(bounds.low())?, wide(bounds.high())?];
        Ok((
            Self {
                bounds: bounds.clone(),
                wide,
            },
            space.into(),
        ))
    }

    fn map<'a>(&self, action: &'a mut Value, _: &'a mut Value) -> &'a Value {
        if let Value::Array(array) = action {
            let [low, high] = match array.dtype() {
                DType::F64 => self.wide.each_ref(),
                _ => [self.bounds.low(), self.bounds.high()],
            };
            array.clip(low, high);
        }
        action
    }
}

gym_core::register_wrapper!(
    "ClipAction", "clips actions to the bounds of their space", Config,
    env: ClipAction::new, vector: ClipAction::new
);
