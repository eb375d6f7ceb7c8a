//! `cargo xtask new NAME`

use std::fs;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, MutexGuard, PoisonError};

use gym::{Error, Result};

use crate::dependency::Source;
use crate::output::say;
use crate::workspace::Workspace;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The name of the crate, and the namespace of its environments: lower-case letters, digits and
    /// `_`.
    name: String,
    /// The folder to make; by default a folder of that name in the current one.
    #[arg(long, value_name = "DIR")]
    path: Option<PathBuf>,
    /// The environment has a native vector: its step is one formula, for one environment and for
    /// many.
    #[arg(long)]
    native: bool,
}

/// The files of a new crate, except its environment, and their texts. The crate's name replaces
/// `plugin_name`.
const FILES: [(&str, &str); 8] = [
    (
        "Cargo.toml",
        include_str!("../templates/plugin/manifest.toml"),
    ),
    (
        ".cargo/config.toml",
        include_str!("../templates/plugin/config.toml"),
    ),
    (
        "xtask/Cargo.toml",
        include_str!("../templates/plugin/xtask/manifest.toml"),
    ),
    (
        "xtask/src/main.rs",
        include_str!("../templates/plugin/xtask/main.rs"),
    ),
    (".gitignore", include_str!("../templates/plugin/gitignore")),
    ("README.md", include_str!("../templates/plugin/README.md")),
    (
        "tests/conform.rs",
        include_str!("../templates/plugin/tests/conform.rs"),
    ),
    (
        "examples/gif.rs",
        include_str!("../templates/plugin/examples/gif.rs"),
    ),
];

/// The files of the environment.
const CORRIDOR: [(&str, &str); 2] = [
    ("src/lib.rs", include_str!("../templates/plugin/src/lib.rs")),
    (
        "src/corridor.rs",
        include_str!("../templates/plugin/src/corridor.rs"),
    ),
];

/// The files of the environment with a native vector.
const ROCKET: [(&str, &str); 2] = [
    ("src/lib.rs", include_str!("../templates/native/src/lib.rs")),
    (
        "src/rocket.rs",
        include_str!("../templates/native/src/rocket.rs"),
    ),
];

pub(crate) fn new(arguments: &Arguments, workspace: &Workspace) -> Result<()> {
    let Arguments { name, path, native } = arguments;
    let lock = workspace.folder().join("Cargo.lock");
    let lock = gym::file::read_text(&lock, usize::MAX).map_err(|error| Error::io(&lock, error))?;
    check_name(name, &lock)?;
    let folder = path.clone().unwrap_or_else(|| name.into());
    if folder.file_name().is_none() && folder.symlink_metadata().is_err() {
        let reason = format!("`{}` ends without the name of a folder", folder.display());
        return Err(Error::argument("--path", reason));
    }
    if folder.symlink_metadata().is_ok() {
        return Err(Error::custom(format!(
            "{}: it exists already, choose another --path",
            folder.display()
        )));
    }
    let source = Source::of(workspace)?;
    // write to a temporary folder, and rename the folder when everything is written
    let _unfinished = wait();
    let unfinished = folder.with_file_name(format!(".{name}-{}.tmp", process::id()));
    let written = match write_all(&unfinished, arguments, &source, &lock) {
        // name the final folder in the error, not the temporary one
        Err(Error::Io { source, .. }) => Err(Error::Io {
            path: folder.display().to_string(),
            source,
        }),
        written => written,
    };
    let written = written
        .and_then(|()| fs::rename(&unfinished, &folder).map_err(|error| Error::io(&folder, error)));
    if written.is_err() {
        // (if this fails too, the first error is the one to report)
        let _ = fs::remove_dir_all(&unfinished);
        return written;
    }
    say(format_args!(
        "{} has the environment `{name}/{}-v0`. In that folder:",
        folder.display(),
        task(*native).0
    ))?;
    say(format_args!(
        "  cargo test               checks that it keeps the rules"
    ))?;
    say(format_args!("  cargo run --example gif  draws an episode"))?;
    say(format_args!(
        "  cargo xtask help         lists the commands: list, play, gif, bench, docs, python"
    ))?;
    Ok(())
}

/// Waits while a temporary folder exists, and prevents another one. Call it in a signal handler.
pub(crate) fn wait() -> MutexGuard<'static, ()> {
    static EXISTS: Mutex<()> = Mutex::new(());
    EXISTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Checks that `name` is a valid name of a package, a crate and a namespace. `lock` is the lock
/// file with all dependencies of the new package.
fn check_name(name: &str, lock: &str) -> Result<()> {
    /// Reserved words, and names of crates that every program links.
    const TAKEN: &str = "abstract as async await become box break const continue crate do dyn else enum extern false \
                         final fn for gen if impl in let loop macro match mod move mut override \
                         priv pub ref return self serde static std struct super test trait true try type typeof \
                         unsafe unsized use virtual where while yield alloc core proc_macro xtask";
    let refuse = |reason: &str| {
        let name: String = name.chars().take(80).collect();
        Err(Error::argument("NAME", format!("`{name}` {reason}")))
    };
    let is_word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if !name.starts_with(|c: char| c.is_ascii_lowercase())
        || !name.chars().all(is_word)
        || name.len() > 64
    {
        return refuse(
            "must be lower-case letters, digits and `_`, with a letter first, at most 64 of them",
        );
    }
    if TAKEN.split_whitespace().any(|taken| taken == name) {
        return refuse("is taken: choose another name");
    }
    let is_there = |name: &str| lock.contains(&format!("\nname = \"{name}\"\n"));
    if name == "gym"
        || name.starts_with("gym_")
        || is_there(name)
        || is_there(&name.replace('_', "-"))
    {
        return refuse("is a crate that the new one may be built with: choose another name");
    }
    Ok(())
}

/// Returns the task's name, and its description in the README.
fn task(native: bool) -> (&'static str, &'static str) {
    if native {
        (
            "Rocket",
            "touch down softly, with as little fuel as possible",
        )
    } else {
        (
            "Corridor",
            "find the way out of a dark corridor, on a slippery floor",
        )
    }
}

fn write_all(folder: &Path, arguments: &Arguments, source: &Source, lock: &str) -> Result<()> {
    let Arguments { name, native, .. } = arguments;
    let (task, what) = task(*native);
    for (file, text) in FILES
        .into_iter()
        .chain(if *native { ROCKET } else { CORRIDOR })
    {
        let path = folder.join(file);
        let parent = path.parent().unwrap_or(folder);
        fs::create_dir_all(parent).map_err(|error| Error::io(parent, error))?;
        // only the native environment depends on gym-native
        let text = if *native {
            text.into()
        } else {
            text.replace("gym-native = GYM_NATIVE\n", "")
        };
        let text = text
            .replace("plugin_name", name)
            .replace("TASK_FILE", &task.to_lowercase())
            .replace("TASK_NAME", task)
            .replace("TASK_SENTENCE", what)
            .replace("GYM_CLI", &source.dependency("gym-cli"))
            .replace("GYM_CONFORM", &source.dependency("gym-conform"))
            .replace("GYM_CORE", &source.dependency("gym-core"))
            .replace("GYM_NATIVE", &source.dependency("gym-native"))
            .replace("GYM_RENDER", &source.dependency("gym-render"));
        gym::render::file::write(&path, text.as_bytes())?;
    }
    // use the versions of the dependencies that this workspace uses
    gym::render::file::write(folder.join("Cargo.lock"), lock.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_packages_that_are_there_are_taken() {
        let lock = "version = 4\n\n[[package]]\nname = \"serde_json\"\nversion = \"1.0.0\"\n\n\
                    [[package]]\nname = \"x11-dl\"\nversion = \"1.0.0\"\n";
        for name in [
            "serde_json",
            "x11_dl",
            "gym",
            "gym_toytext",
            "gym_new",
            "xtask",
            "fn",
        ] {
            let error = check_name(name, lock).unwrap_err().to_string();
            assert!(error.contains("choose another name"), "{error}");
        }
        for name in ["my_envs", "json", "x11", "gymnast", "serde_jso"] {
            check_name(name, lock).unwrap();
        }
    }
}
