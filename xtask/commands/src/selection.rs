use std::path::PathBuf;

use crate::output::tell;
use gym::{Registration, Result, registry};

/// The environments of a command that names none.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Selection {
    /// All that are linked.
    All,
    /// The environments that a crate registers, whether it is named `my-envs` or `my_envs`, and its
    /// folder.
    Crate(&'static str, &'static str),
}

impl Selection {
    /// The folder of the workspace, or of the crate.
    pub(crate) fn folder(self) -> PathBuf {
        match self {
            Self::All => crate::root().to_owned(),
            Self::Crate(_, folder) => folder.into(),
        }
    }

    /// The environments of these ids; without ids, all of the selection except those with external
    /// requirements, which it reports.
    ///
    /// # Errors
    /// An id that is not registered; a crate that registers nothing.
    pub(crate) fn of(self, ids: &[String]) -> Result<Vec<Registration>> {
        if !ids.is_empty() {
            return ids.iter().map(|id| registry::find(id)).collect();
        }
        let mut all = registry::all();
        if let Self::Crate(name, _) = self {
            let underscored = |name: &str| name.replace('-', "_");
            all.retain(|registration| {
                underscored(registration.source.package) == underscored(name)
            });
            if all.is_empty() {
                return Err(gym::Error::custom(format!(
                    "`{name}` registers no environment: put `gym_core::register!(...)` at the top level of a module, and \
                     let there be one gym-core in `cargo tree --duplicates`"
                )));
            }
        }
        let (mut needy, all): (Vec<_>, Vec<_>) = all
            .into_iter()
            .partition(|registration| registration.needs.is_some());
        needy.sort_by(|a, b| a.source.package.cmp(b.source.package));
        for group in needy.chunk_by(|a, b| a.source.package == b.source.package) {
            tell!("{}", left_out(group));
        }
        Ok(all)
    }
}

/// Reports the environments of one crate that are left out because of external requirements.
fn left_out(group: &[Registration]) -> String {
    let needed = group[0].needs.map_or("", |need| need.what);
    let there = if group[0].needs.is_some_and(|need| !need.is_met()) {
        " (none here)"
    } else {
        ""
    };
    match group {
        [one] => format!(
            "left out {}: it needs {needed}{there}; name the id to use it",
            one.id()
        ),
        _ => {
            let (n, name) = (group.len(), group[0].source.package);
            format!("left out {n} ids of {name}: they need {needed}{there}; name an id to use it")
        }
    }
}
