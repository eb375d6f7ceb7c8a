//! Clipped rewards.

use gym_core::registry::WrapperConfig;
use gym_core::{BoxEnv, Result};

use crate::Bound;
use crate::map::{MapReward, RewardMap};

/// Clips rewards to one or two bounds.
pub type ClipReward<T = BoxEnv> = MapReward<T, Clip>;

gym_core::arguments! {
    /// The arguments of [`ClipReward`]; at least one bound is given.
    pub struct Config {
        /// The lower bound.
        pub min_reward: Option<Bound>,
        /// The upper bound.
        pub max_reward: Option<Bound>,
    }
}

impl<A: Into<Option<f64>>, B: Into<Option<f64>>> From<(A, B)> for Config {
    fn from((min, max): (A, B)) -> Self {
        Self {
            min_reward: min.into().map(Bound::Scalar),
            max_reward: max.into().map(Bound::Scalar),
        }
    }
}

/// The bounds of [`ClipReward`].
#[derive(Clone, Copy, Debug)]
pub struct Clip {
    min: f64,
    max: f64,
}

impl RewardMap for Clip {
    type Config = Config;

    fn new(config: &Config) -> Result<Self> {
        let bound = |bound: &Option<Bound>, unbounded: f64| match bound {
            None => Ok(unbounded),
            Some(Bound::Scalar(x)) => Ok(*x),
            Some(Bound::Array(_)) => Err(Config::refuse(
                "a reward has one bound, not an array of them",
            )),
        };
        let (min, max) = (
            bound(&config.min_reward, f64::NEG_INFINITY)?,
            bound(&config.max_reward, f64::INFINITY)?,
        );
        if config.min_reward.is_none() && config.max_reward.is_none() {
            return Err(Config::refuse(
                "neither min_reward nor max_reward is given: give at least one",
            ));
        }
        match min <= max {
            true => Ok(Self { min, max }),
            false => Err(Config::refuse(format!(
                "min_reward {min} must not be above max_reward {max}"
            ))),
        }
    }

    /// NaN stays NaN, as with numpy's `clip`.
    fn map(&self, reward: f64) -> f64 {
        if reward < self.min {
            self.min
        } else if reward > self.max {
            self.max
        } else {
            reward
        }
    }
}

gym_core::register_wrapper!(
    "ClipReward", "clips rewards to bounds", Config, env: ClipReward::new, vector: ClipReward::new
);
