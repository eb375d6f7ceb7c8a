//! Parts for vectors of other kinds than those of this crate.

pub use super::size::check as check_size;
pub use super::slot::{describe, episode_over};
pub use crate::stored::{row, words};
