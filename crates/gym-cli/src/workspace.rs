//! The workspace that the commands serve, and its environments.

use std::path::{Path, PathBuf};

use gym::{Error, Registration, Result, registry};

use crate::output::tell;

/// The workspace of the program that calls the commands.
#[derive(Clone, Debug)]
pub(crate) struct Workspace {
    /// The folder of the program's package.
    package: PathBuf,
    /// The folder of the workspace.
    folder: PathBuf,
}

impl Workspace {
    /// Returns the workspace of the package in the folder `package`.
    pub(crate) fn of(package: &Path) -> Self {
        // Cargo writes the lock file to the folder of the workspace
        let mut folders = package.ancestors();
        let folder = folders.find(|folder| folder.join("Cargo.lock").exists());
        Self {
            package: package.to_owned(),
            folder: folder.or(package.parent()).unwrap_or(package).to_owned(),
        }
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the path of the manifest of the program's package.
    pub(crate) fn manifest(&self) -> PathBuf {
        self.package.join("Cargo.toml")
    }

    /// Returns the environments that this workspace registers.
    ///
    /// # Errors
    /// If it registers none.
    pub(crate) fn own(&self) -> Result<Vec<Registration>> {
        let mut own = registry::all();
        own.retain(is_own);
        if own.is_empty() {
            return Err(Error::custom(format!(
                "no environment is registered in {}: put `gym_core::register!(...)` at the top level of a module, make its \
                 crate a member of that workspace, name it in the program of `cargo xtask` (`use my_envs as _;`), and let \
                 there be one gym-core in `cargo tree --duplicates`",
                self.folder.display()
            )));
        }
        Ok(own)
    }

    /// Returns the environments with the ids `ids`. Without ids, returns [all](Self::all);
    /// environments with external requirements are then skipped and reported.
    ///
    /// # Errors
    /// An id that is not registered; without ids, if nothing is registered.
    pub(crate) fn select(&self, ids: &[String]) -> Result<Vec<Registration>> {
        if !ids.is_empty() {
            return ids.iter().map(|id| registry::find(id)).collect();
        }
        Ok(without_needy(self.all()?))
    }

    /// Returns the environments that this workspace registers or, if it registers none, all linked
    /// environments.
    ///
    /// # Errors
    /// If nothing is registered.
    pub(crate) fn all(&self) -> Result<Vec<Registration>> {
        match self.own() {
            Err(error) if registry::all().is_empty() => Err(error),
            Err(_) => Ok(registry::all()),
            Ok(own) => Ok(own),
        }
    }
}

/// Whether a crate of this workspace registers an environment.
fn is_own(registration: &Registration) -> bool {
    is_in_workspace(registration.source.file)
}

/// Whether the source file of a registration belongs to this workspace. Cargo calls the compiler
/// with relative paths for members of the workspace, and with absolute paths for other crates.
fn is_in_workspace(file: &str) -> bool {
    let file = file.replace('\\', "/");
    // Cargo's folder of downloaded crates may lie in the workspace
    let is_downloaded = |folder: &str| file.contains(folder);
    Path::new(&file).is_relative()
        && !["registry/src/", "git/checkouts/"]
            .into_iter()
            .any(is_downloaded)
}

/// Returns the environments without external requirements. Reports the others.
pub(crate) fn without_needy(mut all: Vec<Registration>) -> Vec<Registration> {
    tell_needy(&all);
    all.retain(|registration| registration.needs.is_none());
    all
}

/// Reports the environments with external requirements, which the command skips.
pub(crate) fn tell_needy(all: &[Registration]) {
    let needy = all
        .iter()
        .filter(|registration| registration.needs.is_some());
    for (_, group) in registry::by_family(needy.cloned()) {
        tell(format_args!("{}", left_out(&group)));
    }
}

/// Returns a line about the environments of one crate that are skipped because of external
/// requirements.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn environments_of_the_workspace_are_told_from_others() {
        for own in [
            "src/lib.rs",
            "crates/my-envs/src/corridor.rs",
            "crates\\my\\src\\a.rs",
        ] {
            assert!(is_in_workspace(own), "{own}");
        }
        for other in [
            "/home/me/gym/crates/gym-classic/src/cartpole.rs",
            ".cargo/registry/src/index-1/gym-classic-0.1.0/src/cartpole.rs",
            ".cargo/git/checkouts/gym-1/abc/crates/gym-classic/src/cartpole.rs",
        ] {
            assert!(!is_in_workspace(other), "{other}");
        }
    }

    #[test]
    fn the_folder_of_the_workspace_has_the_lock_file() {
        let package = Path::new(env!("CARGO_MANIFEST_DIR"));
        let workspace = Workspace::of(package);
        assert_eq!(workspace.manifest(), package.join("Cargo.toml"));
        assert!(workspace.folder().join("Cargo.lock").exists());
        assert!(package.starts_with(workspace.folder()));
    }
}
