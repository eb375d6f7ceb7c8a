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
        let (mut needy, all): (Vec<_>, Vec<_>) =
            all.into_iter().partition(|registration| registration.requirement().is_some());
        needy.sort_by(|a, b| a.crate_name().cmp(b.crate_name()));
        for group in needy.chunk_by(|a, b| a.crate_name() == b.crate_name()) {
            eprintln!("{}", left_out(group));
        }
        Ok(all)
    }
}

/// Says that environments of one crate are left out, because they need what no crate brings.
fn left_out(group: &[Registration]) -> String {
    let needed = group[0].requirement().unwrap_or_default();
    let there = if group[0].missing().is_some() { " (not found here)" } else { "" };
    match group {
        [one] => format!("left out {}: it needs {needed}{there}; name the id to use it", one.id()),
        _ => {
            let (n, name) = (group.len(), group[0].crate_name());
            format!("left out {n} ids of {name}: they need {needed}{there}; name an id to use it")
        }
    }
}
