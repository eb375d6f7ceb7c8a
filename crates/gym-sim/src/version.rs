//! The argument that selects a version of MuJoCo.

use gym_core::ArgumentType;
use serde::{Deserialize, Serialize};

use mujoco_engine::Revision;

/// The version of MuJoCo whose numbers the episodes have, as an argument: a string such as `"4.0"`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Version(pub Revision);

impl From<Revision> for Version {
    fn from(revision: Revision) -> Self {
        Self(revision)
    }
}

impl ArgumentType for Version {
    fn kind() -> String {
        "string".to_owned()
    }
}
