//! The source from which a workspace's manifests take this project's crates: a version, a git
//! repository or a folder.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use gym::{Error, Result};
use serde_json::Value as Json;

use crate::collision;
use crate::workspace::Workspace;

/// The source from which a workspace takes this project's crates.
#[derive(Debug, PartialEq)]
pub(crate) enum Source {
    /// A checkout: the folder with all crates.
    Folder(PathBuf),
    /// A repository, as Cargo writes it: the address, and perhaps a branch, tag or revision.
    Git(String, Option<(String, String)>),
    /// Published crates of this version.
    Version(&'static str),
}

impl Source {
    /// Returns the source that the manifest of the workspace's program names.
    ///
    /// # Errors
    /// If the manifest does not name this crate.
    pub(crate) fn of(workspace: &Workspace) -> Result<Self> {
        let manifest = workspace.manifest();
        let metadata = metadata(&manifest, &["--no-deps"])?;
        let is_it =
            |package: &&Json| package["manifest_path"].as_str().map(Path::new) == Some(&manifest);
        let package = list(&metadata["packages"]).iter().find(is_it);
        let dependencies = package.map_or(&[][..], |package| list(&package["dependencies"]));
        let named = dependencies
            .iter()
            .find(|dependency| dependency["name"] == env!("CARGO_PKG_NAME"));
        named.and_then(Self::read).ok_or_else(|| {
            Error::custom(format!(
                "{}: it has no dependency {}",
                manifest.display(),
                env!("CARGO_PKG_NAME")
            ))
        })
    }

    /// Reads the source of a dependency in the output of `cargo metadata`.
    fn read(dependency: &Json) -> Option<Self> {
        let Some(source) = dependency["source"].as_str() else {
            let path = Path::new(dependency["path"].as_str()?);
            return Some(Self::Folder(path.parent()?.to_owned()));
        };
        let Some(git) = source.strip_prefix("git+") else {
            return Some(Self::Version(env!("CARGO_PKG_VERSION")));
        };
        let git = git.split('#').next()?;
        let (address, reference) = git.split_once('?').unwrap_or((git, ""));
        let reference = reference.split_once('=');
        Some(Self::Git(
            address.to_owned(),
            reference.map(|(kind, name)| (kind.to_owned(), name.to_owned())),
        ))
    }

    /// Returns the dependency on the crate `name`, as a value for a manifest.
    pub(crate) fn dependency(&self, name: &str) -> String {
        let package = match name {
            "gym" | "gym-core" => format!("package = \"rust-{name}\", "),
            _ => String::new(),
        };
        match self {
            Self::Folder(folder) => format!("{{ {package}path = {:?} }}", folder.join(name)),
            Self::Git(address, None) => format!("{{ {package}git = {address:?} }}"),
            Self::Git(address, Some((kind, name))) => {
                format!("{{ {package}git = {address:?}, {kind} = {name:?} }}")
            }
            Self::Version(version) if package.is_empty() => format!("{version:?}"),
            Self::Version(version) => format!("{{ {package}version = {version:?} }}"),
        }
    }
}

/// Returns the output of `cargo metadata` for a manifest.
pub(crate) fn metadata(manifest: &Path, options: &[&str]) -> Result<Json> {
    let wrong = |reason: String| Error::custom(format!("{}: {reason}", manifest.display()));
    let output = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["metadata", "--format-version", "1", "--manifest-path"])
        .arg(manifest)
        .args(options)
        .output()
        .map_err(|error| wrong(format!("cargo cannot be run: {error}")))?;
    if !output.status.success() {
        let error = String::from_utf8_lossy(&output.stderr);
        return Err(wrong(
            collision::explain(&error).unwrap_or_else(|| error.trim().to_owned()),
        ));
    }
    serde_json::from_slice(&output.stdout).map_err(|error| wrong(error.to_string()))
}

/// Returns the elements of a JSON array; no elements for other JSON.
pub(crate) fn list(json: &Json) -> &[Json] {
    json.as_array().map(Vec::as_slice).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn crates_are_named_as_the_workspace_names_them() {
        let named = |dependency: &Json, name: &str| {
            let source = Source::read(dependency).unwrap();
            source.dependency(name)
        };
        let folder = json!({"name": "gym-cli", "path": "/x/crates/gym-cli", "source": null});
        assert_eq!(
            named(&folder, "gym-render"),
            "{ path = \"/x/crates/gym-render\" }"
        );
        // another project has the name `gym-core` in the registry
        assert_eq!(
            named(&folder, "gym-core"),
            "{ package = \"rust-gym-core\", path = \"/x/crates/gym-core\" }"
        );
        let version = env!("CARGO_PKG_VERSION");
        let registry = json!({"source": "registry+https://example.org/index", "req": "^0.1.0"});
        assert_eq!(named(&registry, "gym-render"), format!("{version:?}"));
        assert_eq!(
            named(&registry, "gym-core"),
            format!("{{ package = \"rust-gym-core\", version = {version:?} }}")
        );
        for (query, expected) in [
            ("", "{ git = \"https://example.org/gym\" }"),
            (
                "?branch=main#abc",
                "{ git = \"https://example.org/gym\", branch = \"main\" }",
            ),
            (
                "?rev=abc",
                "{ git = \"https://example.org/gym\", rev = \"abc\" }",
            ),
        ] {
            let git = json!({"source": format!("git+https://example.org/gym{query}"), "req": "*"});
            assert_eq!(named(&git, "gym-render"), expected);
        }
    }
}
