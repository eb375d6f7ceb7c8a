//! The sample of environments that `conform --sample` checks.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use gym::{Error, Registration, Result};

use crate::workspace::Workspace;

/// Returns the files of the workspace that differ from a commit.
pub(crate) fn changed_files(workspace: &Workspace, commit: &str) -> Result<Vec<String>> {
    let output = Command::new("git")
        .args(["diff", "--name-only", "--relative", commit, "--"])
        .current_dir(workspace.folder())
        .output()
        .map_err(|error| {
            Error::argument("--changed-since", format!("git cannot be run: {error}"))
        })?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(Error::argument("--changed-since", said.trim().to_owned()));
    }
    let files = String::from_utf8_lossy(&output.stdout);
    Ok(files.lines().map(str::to_owned).collect())
}

/// Returns one environment of each class, and all of crates that a changed file belongs to.
pub(crate) fn sample(all: Vec<Registration>, changed: &[String]) -> Result<Vec<Registration>> {
    let mut last = BTreeMap::new();
    for (i, one) in all.iter().enumerate() {
        let arguments = one.arguments()?;
        let names: Vec<_> = arguments.iter().map(|argument| argument.name).collect();
        last.insert((one.source.module, names), i);
    }
    let last: BTreeSet<usize> = last.into_values().collect();
    let is_kept = |(i, one): &(usize, Registration)| {
        last.contains(i)
            || changed
                .iter()
                .any(|file| is_of_the_crate(file, one.source.file))
    };
    let kept = all.into_iter().enumerate().filter(is_kept);
    Ok(kept.map(|(_, one)| one).collect())
}

/// Whether `file` is in the folder of the crate whose source is `source`.
fn is_of_the_crate(file: &str, source: &str) -> bool {
    let source = source.replace('\\', "/");
    let folder = source.rsplit_once("src/").map_or("", |(folder, _)| folder);
    file.starts_with(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_changed_file_belongs_to_the_crate_of_its_folder() {
        let source = "crates/my-envs/src/corridor.rs";
        for (file, belongs) in [
            ("crates/my-envs/src/rocket.rs", true),
            ("crates/my-envs/Cargo.toml", true),
            ("crates/my-envs-2/src/corridor.rs", false),
            ("docs/README.md", false),
        ] {
            assert_eq!(is_of_the_crate(file, source), belongs, "{file}");
        }
        assert!(
            is_of_the_crate("src/main.rs", "src/main.rs"),
            "a package at the root"
        );
    }
}
