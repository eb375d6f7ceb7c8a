//! Crates with environments of their own, outside of this workspace.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value as Json;

use crate::{cargo, files, root};

/// A crate on disk.
#[derive(Debug)]
pub(crate) struct Plugin {
    /// The name of the package.
    pub(crate) name: String,
    /// The name of its library.
    krate: String,
    /// Its folder.
    folder: PathBuf,
    /// Where it has this project's crates from, if not from folders: the name of a source, as
    /// `[patch]` takes it.
    source: Option<String>,
}

impl Plugin {
    /// Reads the manifest in a folder.
    pub(crate) fn read(folder: &Path) -> Result<Self, String> {
        let manifest = folder.join("Cargo.toml");
        let wrong = |reason: String| format!("{}: {reason}", manifest.display());
        let folder = folder
            .canonicalize()
            .map_err(|error| wrong(error.to_string()))?;
        let output = Command::new(cargo())
            .args([
                "metadata",
                "--no-deps",
                "--format-version",
                "1",
                "--manifest-path",
            ])
            .arg(folder.join("Cargo.toml"))
            .output()
            .map_err(|error| wrong(format!("cargo cannot be run: {error}")))?;
        if !output.status.success() {
            return Err(wrong(
                String::from_utf8_lossy(&output.stderr).trim().to_owned(),
            ));
        }
        let metadata: Json =
            serde_json::from_slice(&output.stdout).map_err(|error| wrong(error.to_string()))?;
        let is_it = |package: &&Json| {
            package["manifest_path"].as_str().map(Path::new) == Some(&folder.join("Cargo.toml"))
        };
        let package = list(&metadata["packages"])
            .iter()
            .find(is_it)
            .ok_or_else(|| wrong("it is not a package".into()))?;
        let is_library = |target: &&Json| {
            list(&target["kind"])
                .iter()
                .any(|kind| kind == "lib" || kind == "rlib")
        };
        let library = list(&package["targets"]).iter().find(is_library);
        let library = library.ok_or_else(|| wrong("it has no library: add src/lib.rs".into()))?;
        let dependencies = list(&package["dependencies"]);
        let is_ours =
            |dependency: &&Json| dependency["name"] == "gym-core" || dependency["name"] == "gym";
        let ours = dependencies.iter().find(is_ours);
        let ours = ours.ok_or_else(|| wrong("it depends on neither gym-core nor gym".into()))?;
        let text = |json: &Json| json.as_str().unwrap_or_default().to_owned();
        Ok(Self {
            name: text(&package["name"]),
            krate: text(&library["name"]).replace('-', "_"),
            source: source(ours),
            folder,
        })
    }

    /// Writes a program that links the plugin and runs the commands over its environments.
    pub(crate) fn write_program(&self, folder: &Path) -> Result<(), String> {
        let main = format!(
            "use std::process::ExitCode;\n\nuse {} as _;\n\n\
             fn main() -> ExitCode {{\n    xtask_commands::main_of({:?}, {:?})\n}}\n",
            self.krate, self.name, self.folder
        );
        let commands = root().join("xtask").join("commands");
        let parts = format!(
            "[features]\n\
             conform = [\"xtask-commands/conform\"]\n\
             human = [\"xtask-commands/human\"]\n\
             \n\
             [dependencies]\n\
             xtask-commands = {{ path = {commands:?}, default-features = false }}\n"
        );
        self.write(
            folder,
            ("main.rs", &main),
            ("commands-of", "xtask-commands"),
            &parts,
        )
    }

    /// Writes a library that links the plugin and the gallery.
    pub(crate) fn write_gallery(&self, folder: &Path) -> Result<(), String> {
        let library = format!("use gym_web as _;\nuse {} as _;\n", self.krate);
        let web = root().join("crates").join("gym-web");
        let parts = format!(
            "[dependencies]\n\
             gym-web = {{ path = {web:?}, default-features = false }}\n"
        );
        self.write(
            folder,
            ("lib.rs", &library),
            ("gallery-of", "gym-web"),
            &parts,
        )
    }

    /// Writes a Python package whose library links the plugin.
    pub(crate) fn write_python(&self, folder: &Path) -> Result<(), String> {
        let library = format!("use gym_python as _;\nuse {} as _;\n", self.krate);
        let ours = root().join("crates").join("gym-python");
        let parts = format!(
            "[lib]\n\
             crate-type = [\"cdylib\"]\n\
             \n\
             [dependencies]\n\
             gym-python = {{ path = {ours:?} }}\n"
        );
        self.write(
            folder,
            ("lib.rs", &library),
            ("python-of", "gym-python"),
            &parts,
        )?;
        // nothing stays of an earlier version; a folder that cannot be removed fails to be written
        let _ = fs::remove_dir_all(folder.join("python"));
        // maturin packs no module from outside of the folder
        for name in [
            "README.md",
            "LICENSE-APACHE",
            "LICENSE-MIT",
            "NOTICE.md",
            "pyproject.toml",
            "python",
        ] {
            files::copy(&ours.join(name), &folder.join(name))?;
        }
        Ok(())
    }

    /// Writes a package of one source file, around a package of this workspace.
    fn write(
        &self,
        folder: &Path,
        (name, text): (&str, &str),
        (prefix, around): (&str, &str),
        parts: &str,
    ) -> Result<(), String> {
        let source = folder.join("src");
        files::create(&source)?;
        let manifest = self.manifest(prefix, parts, &our_crates()?, &profiles_for(around)?);
        for (path, text) in [
            (folder.join("Cargo.toml"), &*manifest),
            (source.join(name), text),
        ] {
            // an unchanged file is not built again
            if files::text(&path).ok().as_deref() != Some(text) {
                files::write(&path, text.as_bytes())?;
            }
        }
        let lock = folder.join("Cargo.lock");
        if !lock.exists() {
            // the versions that are there already
            files::copy(&root().join("Cargo.lock"), &lock)?;
        }
        Ok(())
    }

    /// The manifest of such a package, whose `parts` end with its other dependencies: with this
    /// workspace's crates instead of published ones, and its profiles, so that their common
    /// dependencies are built once.
    fn manifest(&self, prefix: &str, parts: &str, crates: &[PathBuf], profiles: &str) -> String {
        let Self {
            name,
            folder,
            source,
            ..
        } = self;
        // a plugin that takes gym-core from elsewhere shares the one of this workspace
        let patch = source.as_ref().map_or_else(String::new, |source| {
            let entry = |path: &PathBuf| {
                let name = path
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned();
                format!("{name} = {{ path = {path:?} }}\n")
            };
            format!(
                "\n[patch.{source:?}]\n{}",
                crates.iter().map(entry).collect::<String>()
            )
        });
        let version = concat!(env!("CARGO_PKG_VERSION"), "+").to_owned() + &name.replace('_', "-");
        format!(
            "[package]\n\
             name = \"{prefix}-{name}\"\n\
             version = \"{version}\"\n\
             edition = \"2024\"\n\
             publish = false\n\
             \n\
             [workspace]\n\
             \n\
             {parts}\
             {name} = {{ path = {folder:?} }}\n\
             \n\
             {profiles}{patch}"
        )
    }
}

/// The folders of this workspace's crates, by name.
fn our_crates() -> Result<Vec<PathBuf>, String> {
    let mut crates = files::list(&root().join("crates"))?;
    crates.retain(|folder| folder.join("Cargo.toml").exists());
    Ok(crates)
}

/// The profiles of this workspace's manifest, with settings of packages that this one may be built
/// with: Cargo warns of others.
fn profiles_for(package: &str) -> Result<String, String> {
    let [lock, text] = ["Cargo.lock", "Cargo.toml"].map(|name| files::text(&root().join(name)));
    let (lock, text) = (lock?, text?);
    let packages = packages_of(&lock, package);
    let mut table = "";
    let lines = text.lines().filter(|line| {
        if line.starts_with('[') {
            table = line;
        }
        // the only one with settings of an environment's crate, which a plugin's program lacks
        if table.starts_with("[profile.gallery") && package != "gym-web" {
            return false;
        }
        let is_of_packages = table.ends_with(".package]") && !line.starts_with('[');
        let is_there = || {
            line.split_once(" = ")
                .is_some_and(|(name, _)| packages.contains(name))
        };
        table.starts_with("[profile.") && !line.starts_with('#') && (!is_of_packages || is_there())
    });
    Ok(lines.flat_map(|line| [line, "\n"]).collect())
}

/// The names of a package and of all that it may depend on, from a lock file.
fn packages_of<'a>(lock: &'a str, package: &'a str) -> BTreeSet<&'a str> {
    let mut dependencies = BTreeMap::<&str, Vec<&str>>::new();
    let mut name = "";
    for line in lock.lines() {
        if let Some(rest) = line.strip_prefix("name = \"") {
            name = rest.trim_end_matches('"');
        } else if let Some(rest) = line.strip_prefix(" \"") {
            // ` "name",` or ` "name version",`
            dependencies
                .entry(name)
                .or_default()
                .extend(rest.split([' ', '"']).next());
        }
    }
    let mut packages = BTreeSet::new();
    let mut left = vec![package];
    while let Some(package) = left.pop() {
        if packages.insert(package) {
            left.extend(dependencies.get(package).into_iter().flatten());
        }
    }
    packages
}

/// The name of a dependency's source in `[patch]`; `None` for a folder.
fn source(dependency: &Json) -> Option<String> {
    let source = dependency["source"].as_str()?;
    let Some(git) = source.strip_prefix("git+") else {
        return Some("crates-io".into());
    };
    git.split(['?', '#']).next().map(str::to_owned)
}

fn list(json: &Json) -> &[Json] {
    json.as_array().map(Vec::as_slice).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn places_are_called_as_patches_call_them() {
        assert_eq!(
            source(&json!({"name": "gym-core", "path": "/x/crates/gym-core", "source": null})),
            None
        );
        let registry = json!({"source": "registry+https://example.org/index", "req": "^0.1.2"});
        assert_eq!(source(&registry).as_deref(), Some("crates-io"));
        let git = json!({"source": "git+https://example.org/gym?branch=main#abc", "req": "*"});
        assert_eq!(source(&git).as_deref(), Some("https://example.org/gym"));
    }

    #[test]
    fn a_plugins_program_is_built_as_this_workspace() {
        let plugin = Plugin {
            name: "x".into(),
            krate: "x".into(),
            folder: "/x".into(),
            source: Some("crates-io".into()),
        };
        let profiles = profiles_for("xtask-commands").unwrap();
        let manifest = plugin.manifest("x", "[dependencies]\n", &our_crates().unwrap(), &profiles);
        for line in [
            "[profile.release]",
            "lto = \"thin\"",
            "[profile.dev.package.\"*\"]",
            "[profile.quick]",
        ] {
            assert!(
                manifest.lines().any(|other| other == line),
                "{line} is missing:\n{manifest}"
            );
        }
        for name in ["gym", "gym-core", "gym-conform", "gym-box2d"] {
            assert!(
                manifest.contains(&format!("\n{name} = {{ path = ")),
                "{name} is missing:\n{manifest}"
            );
        }
        assert!(
            manifest.contains("\ngym-render = { opt-level"),
            "{manifest}"
        );
        assert!(
            !manifest.contains("gym-tests"),
            "a package that it is not built with:\n{manifest}"
        );
    }

    #[test]
    fn a_folder_without_a_plugin_is_told() {
        let error = Plugin::read(Path::new("/nonexistent")).unwrap_err();
        assert!(error.contains("/nonexistent/Cargo.toml"), "{error}");
        let error = Plugin::read(&root().join("crates/gym-core")).unwrap_err();
        assert!(
            error.contains("depends on neither gym-core nor gym"),
            "{error}"
        );
    }
}
