//! Checks the rule of CONTRIBUTING.md on the length of files.

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
