//! Crates with environments of their own, outside of this workspace.

use std::env;
use std::ffi::OsString;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use gym::{Error, Result};
use serde_json::Value as Json;

/// A profile that builds fast: a first build of gym-core takes a fifth of the time that an optimised one takes.
pub(crate) const PROFILE: &str = "[profile.dev.package.\"*\"]\ndebug = false\n";

/// The folder of this workspace.
pub(crate) fn root() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.parent().unwrap_or(own).to_owned()
}

/// The cargo that runs this.
pub(crate) fn cargo() -> OsString {
    env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// Where this workspace is built, and plugins with it.
pub(crate) fn target_dir() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// A crate on disk.
#[derive(Debug)]
pub(crate) struct Plugin {
    /// The name of the package.
    pub(crate) name: String,
    /// The name of its library.
    pub(crate) krate: String,
    /// Its folder.
    pub(crate) folder: PathBuf,
    /// Where it has gym-core from.
    pub(crate) gym_core: Source,
}

/// Where a crate of this project comes from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Source {
    /// A folder.
    Path(PathBuf),
    /// The registry, with the version that is asked for.
    Registry(String),
    /// A repository: `url` and, where given, `key = "value"`.
    Git(String, Option<(String, String)>),
}

impl Plugin {
    /// Reads the manifest in a folder.
    pub(crate) fn read(folder: &Path) -> Result<Self> {
        let manifest = folder.join("Cargo.toml");
        let folder = folder.canonicalize().map_err(|error| Error::io(&manifest, error))?;
        let wrong = |reason: String| Error::custom(format!("{}: {reason}", manifest.display()));
        let output = Command::new(cargo())
            .args(["metadata", "--no-deps", "--format-version", "1", "--manifest-path"])
            .arg(folder.join("Cargo.toml"))
            .output()
            .map_err(|error| wrong(format!("cargo cannot be run: {error}")))?;
        if !output.status.success() {
            return Err(wrong(String::from_utf8_lossy(&output.stderr).trim().to_owned()));
        }
        let metadata: Json =
            serde_json::from_slice(&output.stdout).map_err(|error| wrong(error.to_string()))?;
        let packages = metadata["packages"].as_array().map(Vec::as_slice).unwrap_or_default();
        let is_it = |package: &&Json| {
            package["manifest_path"].as_str().map(Path::new) == Some(&folder.join("Cargo.toml"))
        };
        let package = packages.iter().find(is_it).ok_or_else(|| wrong("it is no package".into()))?;
        let text = |json: &Json| json.as_str().unwrap_or_default().to_owned();
        let targets = package["targets"].as_array().map(Vec::as_slice).unwrap_or_default();
        let is_library = |target: &&Json| {
            target["kind"]
                .as_array()
                .is_some_and(|kinds| kinds.iter().any(|kind| kind == "lib" || kind == "rlib"))
        };
        let library = targets
            .iter()
            .find(is_library)
            .ok_or_else(|| wrong("it has no library: add src/lib.rs".into()))?;
        let dependencies = package["dependencies"].as_array().map(Vec::as_slice).unwrap_or_default();
        let on = |name: &str| {
            let dependency = dependencies.iter().find(|dependency| dependency["name"] == name)?;
            Source::of(dependency)
        };
        let gym_core = on("gym-core").or_else(|| on("gym").map(|gym| gym.sibling("gym-core")));
        let gym_core = gym_core.ok_or_else(|| wrong("it depends on neither gym-core nor gym".into()))?;
        Ok(Self {
            name: text(&package["name"]),
            krate: text(&library["name"]).replace('-', "_"),
            folder,
            gym_core,
        })
    }
}

impl Source {
    /// From an entry of `dependencies` in the output of `cargo metadata`.
    fn of(dependency: &Json) -> Option<Self> {
        if let Some(path) = dependency["path"].as_str() {
            return Some(Self::Path(path.into()));
        }
        let source = dependency["source"].as_str()?;
        let Some(url) = source.strip_prefix("git+") else {
            return Some(Self::Registry(dependency["req"].as_str()?.to_owned()));
        };
        let url = url.split('#').next()?;
        Some(match url.split_once('?') {
            Some((url, query)) => {
                let pair = query.split_once('=').map(|(key, value)| (key.to_owned(), value.to_owned()));
                Self::Git(url.to_owned(), pair)
            }
            None => Self::Git(url.to_owned(), None),
        })
    }

    /// Another crate of this project, from the same place.
    pub(crate) fn sibling(&self, name: &str) -> Self {
        match self {
            Self::Path(path) => Self::Path(path.with_file_name(name)),
            other => other.clone(),
        }
    }

    /// As the value of a dependency in a manifest.
    pub(crate) fn with_features(&self, features: &[&str]) -> String {
        let mut text = match self {
            Self::Path(path) => format!("{{ path = {path:?}"),
            Self::Registry(version) => format!("{{ version = {version:?}"),
            Self::Git(url, None) => format!("{{ git = {url:?}"),
            Self::Git(url, Some((key, value))) => format!("{{ git = {url:?}, {key} = {value:?}"),
        };
        if !features.is_empty() {
            // Writing to a string does not fail.
            let _ = write!(text, ", features = {features:?}");
        }
        text + " }"
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn sources_are_those_of_the_plugin() {
        let of = |json: Json| Source::of(&json).unwrap().sibling("gym-render").with_features(&["a"]);
        let path = json!({"name": "gym-core", "path": "/x/crates/gym-core", "source": null, "req": "*"});
        assert_eq!(of(path), r#"{ path = "/x/crates/gym-render", features = ["a"] }"#);
        let registry = "registry+https://github.com/rust-lang/crates.io-index";
        assert_eq!(
            of(json!({"source": registry, "req": "^0.1.2"})),
            r#"{ version = "^0.1.2", features = ["a"] }"#
        );
        let git = "git+https://example.org/gym?branch=main#abc";
        let expected = r#"{ git = "https://example.org/gym", branch = "main", features = ["a"] }"#;
        assert_eq!(of(json!({"source": git, "req": "*"})), expected);
    }

    #[test]
    fn a_folder_without_a_plugin_is_told() {
        let error = Plugin::read(Path::new("/nonexistent")).unwrap_err().to_string();
        assert!(error.contains("/nonexistent/Cargo.toml"), "{error}");
        let error = Plugin::read(&root().join("crates/gym-core")).unwrap_err().to_string();
        assert!(error.contains("depends on neither gym-core nor gym"), "{error}");
    }
}
