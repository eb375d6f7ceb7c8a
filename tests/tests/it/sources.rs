//! Checks the rules on files: their length, and that the tests within them run.

use std::path::{Path, PathBuf};

/// The most lines of a file.
const MOST: usize = 600;

/// The files that are longer, and why each is not split.
const EXCEPTIONS: &[(&str, &str)] = &[
    (
        "crates/gym-atari/src/games/table.rs",
        "a table: a row for each game",
    ),
    (
        "crates/gym-bridge/src/worker.py",
        "Python gets the worker as one text",
    ),
    (
        "crates/gym-numerics/src/math/tables.rs",
        "tables that a program wrote",
    ),
];

/// Collects the source files below `folder`, without what Git ignores.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() {
            let is_ignored = name.starts_with('.')
                || matches!(&*name, "target" | "node_modules" | "venv" | "__pycache__");
            if !is_ignored {
                sources(&path, found);
            }
        } else if [".rs", ".py", ".js"].iter().any(|end| name.ends_with(end)) {
            found.push(path);
        }
    }
}

#[test]
fn no_file_is_too_long_but_the_exceptions() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for folder in ["crates", "fuzz", "tests", "xtask"] {
        sources(&root.join(folder), &mut files);
    }
    assert!(files.len() > 600, "{} files", files.len());
    let mut long = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).expect("UTF-8");
        let lines = text.lines().count();
        if lines > MOST {
            let path = file.strip_prefix(&root).expect("below the root");
            long.push((path.display().to_string().replace('\\', "/"), lines));
        }
    }
    for (path, lines) in &long {
        assert!(
            EXCEPTIONS.iter().any(|(exception, _)| exception == path),
            "{path} has {lines} lines, more than {MOST}: look for its second idea, and give that a file \
             of its own"
        );
    }
    for (path, _) in EXCEPTIONS {
        assert!(
            long.iter().any(|(file, _)| file == path),
            "{path} has no more than {MOST} lines, or is not there: take it out of the exceptions"
        );
    }
}

/// A library without a test program has no tests within, which would never run.
#[test]
fn tests_within_a_library_run() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut without = 0;
    for entry in std::fs::read_dir(root.join("crates")).expect("a folder") {
        let folder = entry.expect("an entry").path();
        let Ok(manifest) = std::fs::read_to_string(folder.join("Cargo.toml")) else {
            continue;
        };
        let (_, library) = manifest.split_once("[lib]").unwrap_or_default();
        let library = library.split("\n[").next().unwrap_or_default();
        if !library.lines().any(|line| line.trim() == "test = false") {
            continue;
        }
        without += 1;
        let mut files = Vec::new();
        sources(&folder.join("src"), &mut files);
        for file in files {
            let text = std::fs::read_to_string(&file).expect("UTF-8");
            assert!(
                !text.contains("cfg(test)"),
                "{}: no program runs these tests: put them into `tests`",
                file.display()
            );
        }
    }
    assert!(without > 5, "{without}");
}
