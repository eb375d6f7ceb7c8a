//! The infos of sub-environments as columns: Gymnasium's `_add_info`.

use super::{Columns, VectorEnv};
use crate::Info;

pub(super) fn batch<V: VectorEnv + ?Sized>(_envs: &V, _columns: &Columns) -> Info {
    Info::new()
}
