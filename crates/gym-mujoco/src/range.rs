//! Arguments that are ranges, possibly unbounded.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The numbers between two bounds, which may be infinite.
///
/// In JSON it is a list of two numbers. JSON has no infinity, so `null` stands for no bound: `[0.7,
/// null]` has no upper bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The lower bound; `-inf` if there is none.
    pub low: f64,
    /// The upper bound; `inf` if there is none.
    pub high: f64,
}

impl Range {
    /// The range from `low` to `high`.
    pub const fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// Whether `x` lies strictly between the bounds.
    pub(crate) fn contains_strictly(self, x: f64) -> bool {
        self.low < x && x < self.high
    }

    /// The number in the range that is nearest to `x`: numpy's `clip`.
    pub(crate) fn clip(self, x: f64) -> f64 {
        x.max(self.low).min(self.high)
    }
}

impl gym_core::ArgumentType for Range {
    fn kind() -> String {
        "list of 2 numbers, each or null".to_owned()
    }
}

impl Serialize for Range {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let finite = |x: f64| x.is_finite().then_some(x);
        [finite(self.low), finite(self.high)].serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Range {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let [low, high]: [Option<f64>; 2] = Deserialize::deserialize(deserializer)?;
        let (low, high) = (
            low.unwrap_or(f64::NEG_INFINITY),
            high.unwrap_or(f64::INFINITY),
        );
        let range = Self::new(low, high);
        if range.low > range.high {
            let reason = format!("the range {low} to {high} is empty");
            return Err(serde::de::Error::custom(reason));
        }
        Ok(range)
    }
}
