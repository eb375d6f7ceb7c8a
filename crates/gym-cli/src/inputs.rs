//! What several commands take: seeds, arguments of environments, files.

use std::path::{Path, PathBuf};

use gym::{Kwargs, Result};

/// A seed on the command line.
pub(crate) fn parse_seed(text: &str) -> Result<u64, String> {
    text.parse()
        .map_err(|_| format!("a seed is a whole number from 0 to {}", u64::MAX))
}

/// Arguments of an environment, as JSON on the command line.
pub(crate) fn parse_kwargs(json: &str) -> Result<Kwargs, String> {
    serde_json::from_str(json).map_err(|error| format!("not a JSON object: {error}"))
}

/// Fails early if a file cannot be written.
pub(crate) fn check_writable(path: &Path) -> Result<()> {
    gym::render::file::AtomicFile::create(path).map(drop)
}

/// Whether two paths name one file, which need not exist yet.
pub(crate) fn is_one_file(a: &Path, b: &Path) -> bool {
    let resolved = |path: &Path| -> std::io::Result<PathBuf> {
        let folder = path
            .parent()
            .filter(|folder| *folder != Path::new(""))
            .unwrap_or(Path::new("."));
        path.canonicalize().or_else(|_| {
            Ok(folder
                .canonicalize()?
                .join(path.file_name().unwrap_or_default()))
        })
    };
    a == b || resolved(a).is_ok_and(|a| resolved(b).is_ok_and(|b| a == b))
}

/// An id as part of a file name.
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
}
