use gym::{Registration, Result, registry};

/// The environments of a command that names none.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Selection {
    /// All that are linked.
    All,
    /// Those that a crate registers, whether it is named `my-envs` or `my_envs`.
    Crate(&'static str),
}

impl Selection {
    /// The environments of these ids; without any, all of the selection but those that need what no crate brings, of which
    /// it says so.
    ///
    /// # Errors
    /// An id that is not registered; a crate that registers nothing.
    pub(crate) fn of(self, ids: &[String]) -> Result<Vec<Registration>> {
        if !ids.is_empty() {
            return ids.iter().map(|id| registry::find(id)).collect();
        }
        let mut all = registry::all();
        if let Self::Crate(name) = self {
            let underscored = |name: &str| name.replace('-', "_");
            all.retain(|registration| underscored(registration.crate_name()) == underscored(name));
            if all.is_empty() {
                return Err(gym::Error::custom(format!(
                    "`{name}` registers no environment: put `gym_core::register!(...)` at the top level of a module, and \
                     let there be one gym-core in `cargo tree --duplicates`"
                )));
            }
        }
        let (needy, all): (Vec<_>, Vec<_>) =
            all.into_iter().partition(|registration| registration.requirement().is_some());
        for group in needy.chunk_by(|a, b| a.crate_name() == b.crate_name()) {
            let what = group[0].requirement().unwrap_or_default();
            let there = if group[0].missing().is_none() { "they are there" } else { "they are missing" };
            eprintln!(
                "{}: {} ids need {what}, and {there}; name an id to use it",
                group[0].crate_name(),
                group.len()
            );
        }
        Ok(all)
    }
}
