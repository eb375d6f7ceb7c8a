//! Inputs of several commands: seeds, JSON, files.

use std::fs;
use std::path::{Path, PathBuf};

use gym::{Error, Kwargs, Result, unique};
use serde_json::Value as Json;

/// The arguments of a command, from its words after the name.
#[cfg(test)]
pub(crate) fn parsed<A: clap::Args>(words: &str) -> A {
    #[derive(clap::Parser)]
    struct Line<A: clap::Args> {
        #[command(flatten)]
        arguments: A,
    }
    let words = std::iter::once("command").chain(words.split_whitespace());
    <Line<A> as clap::Parser>::try_parse_from(words)
        .unwrap()
        .arguments
}

/// Parses a seed on the command line.
pub(crate) fn parse_seed(text: &str) -> Result<u64, String> {
    text.parse()
        .map_err(|_| format!("a seed is a whole number from 0 to {}", u64::MAX))
}

/// Parses a number of episodes, frames or steps on the command line.
pub(crate) fn parse_count(text: &str) -> Result<u64, String> {
    let count = text.parse().ok().filter(|count| *count > 0);
    count.ok_or_else(|| format!("a whole number from 1 to {} is needed", u64::MAX))
}

/// Parses an environment's arguments, as JSON on the command line.
pub(crate) fn parse_kwargs(text: &str) -> Result<Kwargs, String> {
    match parse_json(text) {
        Ok(Json::Object(kwargs)) => Ok(kwargs),
        Ok(other) => Err(format!("not a JSON object: {other}")),
        Err(error) => Err(format!("not a JSON object: {error}")),
    }
}

/// Parses JSON on the command line. A duplicate key in an object is an error.
pub(crate) fn parse_json(text: &str) -> Result<Json, String> {
    unique::from_str(text).map_err(|error| error.to_string())
}

/// Returns an error, before the work starts, if the file `path` cannot be written.
pub(crate) fn check_writable(path: &Path) -> Result<()> {
    gym::render::file::AtomicFile::create(path).map(drop)
}

/// Returns an error, before the work starts, if two options name the same file, because the second
/// result would replace the first.
pub(crate) fn check_distinct<const N: usize>(files: [(&str, &Option<PathBuf>); N]) -> Result<()> {
    for (i, (second, path)) in files.iter().enumerate() {
        for (first, other) in &files[..i] {
            if let (Some(path), Some(other)) = (path, other)
                && is_one_file(path, other)
            {
                return Err(Error::custom(format!(
                    "`{first}` and `{second}` name one file: the second would replace the first"
                )));
            }
        }
    }
    Ok(())
}

/// Whether both paths lead to the same file, which need not exist yet. False for devices and pipes,
/// to which two results can be written.
pub(crate) fn is_one_file(a: &Path, b: &Path) -> bool {
    let is_device = |path: &Path| fs::metadata(path).is_ok_and(|found| !found.is_file());
    !is_device(a) && (a == b || written(a).is_some_and(|a| written(b) == Some(a)))
}

/// Returns the file that a result written to `path` replaces. Follows links, even to a file that
/// does not exist yet.
fn written(path: &Path) -> Option<PathBuf> {
    const MAX_LINKS: usize = 40; // as Linux
    let mut path = path.to_owned();
    for _ in 0..=MAX_LINKS {
        let folder = path
            .parent()
            .filter(|folder| *folder != Path::new(""))
            .unwrap_or(Path::new("."));
        let Ok(target) = fs::read_link(&path) else {
            return Some(folder.canonicalize().ok()?.join(path.file_name()?));
        };
        path = folder.join(target);
    }
    None
}

/// Returns an id as part of a file name.
pub(crate) fn file_stem(id: &str) -> String {
    id.replace('/', "_")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_file_may_have_several_paths() {
        let is_one = |a: &str, b: &str| is_one_file(Path::new(a), Path::new(b));
        assert!(
            is_one("src/../x.svg", "src/../src/../x.svg")
                && is_one("/nonexistent/a", "/nonexistent/a")
        );
        assert!(!is_one("x.svg", "src/x.svg") && !is_one("/nonexistent/a", "/nonexistent/b"));
    }

    #[test]
    fn an_id_with_a_namespace_names_one_file() {
        assert_eq!(file_stem("CartPole-v1"), "CartPole-v1");
        assert_eq!(
            file_stem("dm_control/fish-swim-v0"),
            "dm_control_fish-swim-v0"
        );
        assert_eq!(Path::new(&file_stem("a/b/c-v0")).components().count(), 1);
    }

    /// Covers links to existing and missing files, links to links, absolute and relative paths, in
    /// both orders.
    #[cfg(unix)]
    #[test]
    fn a_link_and_its_target_are_one_file() {
        use std::os::unix::fs::symlink;

        let folder = std::env::temp_dir().join(format!("gym-cli-links-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(folder.join("inner")).unwrap();
        let path = |name: &str| folder.join(name);
        fs::write(path("old"), "").unwrap();
        symlink("old", path("to-old")).unwrap();
        symlink(path("new"), path("to-new")).unwrap();
        symlink("../to-new", path("inner/twice")).unwrap();
        symlink("inner", path("outer")).unwrap();
        symlink("round", path("round")).unwrap();
        for (a, b) in [
            ("old", "to-old"),
            ("new", "to-new"),
            ("new", "inner/twice"),
            ("to-new", "outer/twice"),
            ("inner/x", "outer/x"),
        ] {
            assert!(is_one_file(&path(a), &path(b)), "{a} {b}");
            assert!(is_one_file(&path(b), &path(a)), "{b} {a}");
        }
        for (a, b) in [("old", "new"), ("to-old", "to-new"), ("round", "old")] {
            assert!(!is_one_file(&path(a), &path(b)), "{a} {b}");
        }
        fs::remove_dir_all(&folder).unwrap();
        assert!(!is_one_file(Path::new("/dev/null"), Path::new("/dev/null")));
    }

    #[test]
    fn a_key_stands_once() {
        for twice in [
            r#"{"a": 1, "a": 2}"#,
            r#"{"a": 1, "\u0061": 1}"#,
            r#"{"b": [{"a": {"c": 1, "c": 1}}]}"#,
        ] {
            let error = parse_kwargs(twice).unwrap_err();
            assert!(error.contains("stands twice"), "{error}");
        }
        let text =
            r#"{"a": [1, -2, 0.1, 1e300, 18446744073709551615, true, null, "x"], "b": {"a": {}}}"#;
        let expected: Kwargs = serde_json::from_str(text).unwrap();
        assert_eq!(parse_kwargs(text).unwrap(), expected);
        for wrong in ["[]", "1", "{", "{} {}", ""] {
            assert!(parse_kwargs(wrong).is_err(), "{wrong}");
        }
    }
}
