//! A learner's reports of its training.

use serde::Serialize;

/// An episode of training.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Episode {
    #[serde(rename = "return")]
    pub(crate) episode_return: f64,
    pub(crate) length: u32,
}
