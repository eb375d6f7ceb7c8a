//! The environments that slow tests play: conformance plays all of them each week.

use std::collections::BTreeMap;

use gym::Registration;
use gym::registry;

/// Returns one registration of each module that registers environments: the last, which is the
/// newest version of a task.
pub(crate) fn one_per_module() -> Vec<Registration> {
    let all = registry::self_contained().into_iter();
    let of_modules: BTreeMap<_, _> = all.map(|one| (one.source.module, one)).collect();
    of_modules.into_values().collect()
}
