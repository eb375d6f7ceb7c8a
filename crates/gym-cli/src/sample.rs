//! The sample of environments that `conform --sample` checks.

use std::collections::BTreeSet;
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
///
/// An environment is left out if a later one of its module and namespace has all of its arguments.
pub(crate) fn sample(all: Vec<Registration>, changed: &[String]) -> Result<Vec<Registration>> {
    let names_of = |one: &Registration| {
        let arguments = one.arguments()?.into_iter();
        Ok(arguments.map(|argument| argument.name).collect())
    };
    let names: Vec<BTreeSet<_>> = all.iter().map(names_of).collect::<Result<_>>()?;
    let class = |i: usize| {
        let namespace = all[i].id().rsplit_once('/').map(|(namespace, _)| namespace);
        (all[i].source.module, namespace)
    };
    let is_last = |i: usize| {
        let mut later = i + 1..all.len();
        !later.any(|j| class(j) == class(i) && names[j].is_superset(&names[i]))
    };
    let is_kept = |i: usize| {
        is_last(i)
            || changed
                .iter()
                .any(|file| is_of_the_crate(file, all[i].source.file))
    };
    let kept: BTreeSet<usize> = (0..all.len()).filter(|i| is_kept(*i)).collect();
    let all = all.into_iter().enumerate();
    Ok(all
        .filter(|(i, _)| kept.contains(i))
        .map(|(_, one)| one)
        .collect())
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
