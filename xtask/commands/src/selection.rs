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
    /// The environments of these ids; without any, all of the selection.
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
        Ok(all)
    }
}
