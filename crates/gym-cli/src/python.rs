//! `cargo xtask python`: the Python package rustgym, with the environments of this workspace beside
//! its own.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use gym::{Error, Result};
use serde_json::Value as Json;

use crate::dependency::{Source, list, metadata};
use crate::output::say;
use crate::workspace::Workspace;

/// The files and folders that are copied from gym-python, because maturin packs only modules inside
/// the package's folder.
const COPIED: [&str; 6] = [
    "README.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "NOTICE.md",
    "pyproject.toml",
    "python",
];

/// Writes the package to the folder `python` of the workspace. An existing manifest is not
/// replaced.
pub(crate) fn python(workspace: &Workspace) -> Result<()> {
    let source = Source::of(workspace)?;
    if matches!(&source, Source::Folder(crates) if crates.starts_with(workspace.folder())) {
        return Err(Error::custom(
            "the environments of this workspace are in rustgym: `pip install ./crates/gym-python`",
        ));
    }
    let folder = workspace.folder().join("python");
    let manifest = folder.join("Cargo.toml");
    if !manifest.exists() {
        write_crate(&folder, &source, workspace)?;
        say(format_args!("wrote {}", manifest.display()))?;
    }
    let lock = folder.join("Cargo.lock");
    if !lock.exists() {
        // keep the versions of the existing lock file
        copy(&workspace.folder().join("Cargo.lock"), &lock)?;
    }
    let all = metadata(&manifest, &[])?;
    let ours = folder_of(&all, "gym-python").ok_or_else(|| {
        Error::custom(format!(
            "{}: it has no dependency gym-python",
            manifest.display()
        ))
    })?;
    // remove the files of an earlier version (if this fails, a later write reports the error)
    let _ = fs::remove_dir_all(folder.join("python"));
    for name in COPIED {
        copy(&ours.join(name), &folder.join(name))?;
    }
    say(format_args!("pip install {}", folder.display()))
}

/// Writes a crate that links gym-python and those crates of the workspace that register
/// environments.
fn write_crate(folder: &Path, source: &Source, workspace: &Workspace) -> Result<()> {
    let own = workspace.own()?;
    let packages: BTreeSet<_> = own
        .iter()
        .map(|registration| {
            let module = registration.source.module;
            let library = module.split("::").next().unwrap_or(module);
            (registration.source.package, library)
        })
        .collect();
    let all = metadata(&workspace.manifest(), &["--no-deps"])?;
    let name = packages.first().map_or("envs", |(package, _)| package);
    let mut manifest = include_str!("../templates/python/manifest.toml")
        .replace("NAME", name)
        .replace(
            "VERSION",
            &format!("{}+{}", env!("CARGO_PKG_VERSION"), name.replace('_', "-")),
        )
        .replace("GYM_PYTHON", &source.dependency("gym-python"));
    let mut library = String::from("//! Links the environments into Python's module.\n\n");
    library += "use gym_python as _;\n";
    for (package, krate) in packages {
        let path = folder_of(&all, package).ok_or_else(|| {
            Error::custom(format!("`{package}` is not a package of this workspace"))
        })?;
        let path = path
            .strip_prefix(workspace.folder())
            .map_or(path.clone(), |path| Path::new("..").join(path));
        manifest += &format!("{package} = {{ path = {path:?} }}\n");
        library += &format!("use {krate} as _;\n");
    }
    for (file, text) in [
        ("Cargo.toml", &*manifest),
        ("src/lib.rs", &library),
        (".gitignore", include_str!("../templates/python/gitignore")),
    ] {
        let path = folder.join(file);
        let parent = path.parent().unwrap_or(folder);
        fs::create_dir_all(parent).map_err(|error| Error::io(parent, error))?;
        gym::render::file::write(&path, text.as_bytes())?;
    }
    Ok(())
}

/// Returns the folder of the package `name` in the output of `cargo metadata`.
fn folder_of(metadata: &Json, name: &str) -> Option<PathBuf> {
    let package = list(&metadata["packages"])
        .iter()
        .find(|package| package["name"] == name)?;
    let manifest = Path::new(package["manifest_path"].as_str()?);
    manifest.parent().map(Path::to_owned)
}

/// Copies a file, or a folder without the caches of Python's interpreter.
fn copy(from: &Path, to: &Path) -> Result<()> {
    if from.is_file() {
        return fs::copy(from, to)
            .map(drop)
            .map_err(|error| Error::io(from, error));
    }
    fs::create_dir_all(to).map_err(|error| Error::io(to, error))?;
    for entry in fs::read_dir(from).map_err(|error| Error::io(from, error))? {
        let name = entry.map_err(|error| Error::io(from, error))?.file_name();
        if name != "__pycache__" {
            copy(&from.join(&name), &to.join(&name))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_folder_is_copied_without_compiled_modules() {
        let folder = std::env::temp_dir().join(format!("gym-cli-copy-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        let write = |path: &str| {
            let path = folder.join("from").join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, path.to_str().unwrap()).unwrap();
        };
        for path in [
            "a.py",
            "in/b.py",
            "in/__pycache__/b.pyc",
            "__pycache__/a.pyc",
        ] {
            write(path);
        }
        let [from, to] = ["from", "to/there"].map(|name| folder.join(name));
        copy(&from, &to).unwrap();
        for path in ["a.py", "in/b.py"] {
            let [from, to] = [&from, &to].map(|folder| fs::read(folder.join(path)).unwrap());
            assert_eq!(from, to, "{path}");
        }
        assert!(!to.join("__pycache__").exists() && !to.join("in/__pycache__").exists());
        let error = copy(&folder.join("nowhere"), &to).unwrap_err().to_string();
        assert!(error.contains("nowhere"), "{error}");
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_package_is_in_the_folder_of_its_manifest() {
        let packages = json!({"packages": [
            {"name": "a", "manifest_path": "/x/a/Cargo.toml"},
            {"name": "b", "manifest_path": "/y/Cargo.toml"},
        ]});
        let folder = |name| folder_of(&packages, name);
        assert_eq!(folder("a"), Some("/x/a".into()));
        assert_eq!(folder("b"), Some("/y".into()));
        assert_eq!(folder("c"), None);
    }
}
