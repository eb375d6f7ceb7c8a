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

    /// A sample has the last of the environments that a class makes with the same arguments, and every
    /// environment of a crate that was changed.
    #[cfg(feature = "families")]
    #[test]
    fn a_sample_has_each_class_and_what_was_changed() {
        let module = |one: &Registration| one.source.module;
        let crate_of = |one: &Registration| module(one).split("::").next().unwrap_or_default();
        let of = |id: &str| gym::registry::find(id).unwrap();
        let all = || {
            let crates = ["CartPole-v1", "Taxi-v4", "LunarLander-v3"].map(|id| crate_of(&of(id)));
            let mut all = gym::registry::all();
            all.retain(|one| crates.contains(&crate_of(one)));
            all
        };
        let ids = |changed: &[&str]| -> BTreeSet<String> {
            let changed: Vec<_> = changed.iter().map(|file| (*file).to_owned()).collect();
            let kept = sample(all(), &changed).unwrap();
            kept.iter().map(|one| one.id().to_owned()).collect()
        };
        let plain = ids(&[]);
        for (id, is_kept) in [
            ("CartPole-v0", false),
            ("CartPole-v1", true),
            ("FrozenLake-v1", false), // FrozenLake8x8-v1 comes later
            ("FrozenLake8x8-v1", true),
            ("Taxi-v3", false),
            ("Taxi-v4", true),
            ("LunarLander-v3", false),
            ("LunarLanderContinuous-v3", true),
            ("rapier/LunarLanderContinuous-v3", true), // another namespace
        ] {
            assert_eq!(plain.contains(id), is_kept, "{id}");
        }
        let modules = |kept: &dyn Fn(&str) -> bool| -> BTreeSet<_> {
            let all = all().into_iter().filter(|one| kept(one.id()));
            all.map(|one| module(&one)).collect()
        };
        assert_eq!(modules(&|id| plain.contains(id)), modules(&|_| true));
        for one in ["CartPole-v1", "Taxi-v4"].map(of) {
            let file = one.source.file;
            let added = &ids(&[file, "README.md"]) - &plain;
            let left_out = all()
                .into_iter()
                .filter(|other| crate_of(other) == crate_of(&one) && !plain.contains(other.id()));
            let left_out: BTreeSet<String> = left_out.map(|one| one.id().to_owned()).collect();
            assert!(!left_out.is_empty());
            assert_eq!(added, left_out, "{file}");
        }
    }

    #[test]
    fn changed_files_are_gits() {
        let folder = std::env::temp_dir().join(format!("gym-cli-git-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("src")).unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
        for name in ["Cargo.lock", "a.rs", "src/b.rs"] {
            write(name, "one");
        }
        for arguments in [
            &["init", "--quiet"][..],
            &["add", "."],
            &[
                "-c",
                "user.name=a",
                "-c",
                "user.email=a",
                "commit",
                "--quiet",
                "--message",
                "one",
            ],
        ] {
            let git = Command::new("git")
                .args(arguments)
                .current_dir(&folder)
                .status();
            assert!(git.unwrap().success());
        }
        let workspace = Workspace::of(&folder);
        let changed = |commit| changed_files(&workspace, commit);
        assert_eq!(changed("HEAD").unwrap(), [""; 0]);
        write("src/b.rs", "two");
        assert_eq!(changed("HEAD").unwrap(), ["src/b.rs"]);
        let error = changed("nowhere").unwrap_err().to_string();
        assert!(
            error.contains("--changed-since") && error.contains("nowhere"),
            "{error}"
        );
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
