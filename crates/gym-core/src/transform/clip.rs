//! Clipping of actions and rewards.

use crate::spaces::BoxSpace;
use crate::spaces::number::with_type;
use crate::{Array, Error, Result};

/// Bounds of a reward.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RewardBounds {
    pub(crate) min: Option<f64>,
    pub(crate) max: Option<f64>,
}

impl RewardBounds {
    pub(crate) fn new(min_reward: Option<f64>, max_reward: Option<f64>) -> Result<Self> {
        let refuse = |reason: String| Err(Error::argument("ClipReward", reason));
        match (min_reward, max_reward) {
            (None, None) => refuse("neither min_reward nor max_reward is given: give at least one".into()),
            (Some(bound), None) | (None, Some(bound)) if bound.is_nan() => refuse("a bound is NaN".into()),
            (Some(min), Some(max)) if min > max || min.is_nan() || max.is_nan() => {
                refuse(format!("min_reward {min} must not be above max_reward {max}"))
            }
            (min, max) => Ok(Self { min, max }),
        }
    }

    /// The reward within the bounds. NaN stays, as numpy's `clip` leaves it.
    pub(crate) fn clip(self, reward: f64) -> f64 {
        let reward = self.min.filter(|min| reward < *min).unwrap_or(reward);
        self.max.filter(|max| reward > *max).unwrap_or(reward)
    }
}

/// Clips an array, or each row of a batch, to the bounds of a box.
pub(crate) fn clip(array: &mut Array, bounds: &BoxSpace) {
    with_type!(bounds.dtype(), T => {
        let numbers = array.as_mut_slice::<T>().unwrap_or_default();
        let low = bounds.low().as_slice::<T>().unwrap_or_default();
        let high = bounds.high().as_slice::<T>().unwrap_or_default();
        for row in numbers.chunks_exact_mut(low.len().max(1)) {
            for (x, (low, high)) in row.iter_mut().zip(low.iter().zip(high)) {
                // comparisons that NaN fails, so that it stays
                if *x < *low {
                    *x = *low;
                } else if *x > *high {
                    *x = *high;
                }
            }
        }
    });
}
