//! The kind of reward.

use serde::{Deserialize, Serialize};

/// The kind of reward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RewardType {
    /// One number at the goal, and another elsewhere.
    #[default]
    Sparse,
    /// A number that tells the way to the goal.
    Dense,
}

impl gym_core::ArgumentType for RewardType {
    fn kind() -> String {
        "\"sparse\" or \"dense\"".to_owned()
    }
}
