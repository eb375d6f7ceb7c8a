//! Goals that are reached within a distance.

use gym_core::Goals;

use crate::RewardType;

/// Goals that are places: one point, or several.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    /// The number of numbers of a goal.
    pub(crate) length: usize,
    /// The distance within which a goal is reached, in m.
    pub(crate) threshold: f64,
    pub(crate) reward_type: RewardType,
}

impl Near {
    /// Whether a goal is reached, as `info` tells.
    pub(crate) fn is_success(&self, achieved: &[f64], desired: &[f64]) -> bool {
        distance(achieved, desired) < self.threshold
    }
}

impl Goals for Near {
    fn goal_len(&self) -> usize {
        self.length
    }

    fn compute_reward(&self, achieved: &[f64], desired: &[f64]) -> f64 {
        let distance = distance(achieved, desired);
        match self.reward_type {
            RewardType::Sparse => -f64::from(distance > self.threshold),
            RewardType::Dense => -distance,
        }
    }
}

/// The distance of two goals, `np.linalg.norm` along an axis, which sums as `np.sum`.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    gym_sim::numpy::sum_of_squares(length, |i| a[i] - b[i]).sqrt()
}
