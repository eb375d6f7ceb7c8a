//! Models and meshes, which the user provides: they are files of the Python package. This crate
//! contains none.

use std::fs;
use std::path::{Path, PathBuf};

use gym_core::{Error, Result, file};
use mujoco_engine::{Model, Revision};

/// The environment variable that names the folder of models.
pub const VARIABLE: &str = "GYMNASIUM_ROBOTICS_ASSETS";

/// What environments need.
pub(crate) const NEED: &str = "the models of gymnasium-robotics";

/// The folder within the site-packages of a Python installation.
const INSTALLED: &str = "gymnasium_robotics/envs/assets";

/// The largest size of a file in bytes, and the largest number of files of a robot.
const LARGEST: usize = 64 << 20;
const MOST: usize = 1000;

/// The files of a robot.
#[derive(Debug)]
pub(crate) struct Files {
    /// The folders that have them.
    folders: &'static [&'static str],
    /// The CRC-32 of all models, meshes and textures, in the order of their names: of the package's
    /// files, and of the small ones in `tests/own`, which let the tests run everywhere.
    checksums: [u32; 2],
}

/// The Fetch robot.
pub(crate) const FETCH: Files = Files {
    folders: &["fetch", "stls/fetch", "textures"],
    checksums: [0xbe1c_2b54, 0x5074_1ed1],
};

/// The Shadow hand.
pub(crate) const HAND: Files = Files {
    folders: &["hand", "stls/hand", "textures"],
    checksums: [0xaba9_909d, 0xb610_9bcb],
};

/// The kitchen, with a Franka arm.
pub(crate) const KITCHEN: Files = Files {
    folders: &["kitchen_franka"],
    checksums: [0xecd8_d336, 0x7d38_7616],
};

/// Finds the folder of models: the one in `GYMNASIUM_ROBOTICS_ASSETS`; otherwise that of an
/// installed gymnasium-robotics, in the active virtual environment, in `.venv` in the current
/// folder, or next to a `python3` in the `PATH`.
#[must_use]
pub fn find() -> Option<PathBuf> {
    match std::env::var_os(VARIABLE).filter(|path| !path.is_empty()) {
        Some(path) => Some(path.into()),
        None => file::of_python(INSTALLED),
    }
}

/// Whether [`find`] finds models.
#[must_use]
pub fn available() -> bool {
    find().is_some_and(|folder| folder.join("fetch/reach.xml").is_file())
}

/// Loads a model of a robot from `folder`, or else from the one that [`find`] finds.
///
/// # Errors
/// [`Error::InvalidArgument`] without a folder, and for files that are missing, damaged or of
/// another version.
pub(crate) fn load(
    files: &Files,
    model: &str,
    folder: Option<&Path>,
    revision: Revision,
) -> Result<Model> {
    let refuse = |reason: String| Error::argument("assets", format!("{reason}. {}", advice()));
    let Some(folder) = folder.map(Path::to_owned).or_else(find) else {
        return Err(refuse("no models of robots were found".to_owned()));
    };
    let path = folder.join(model);
    if !path.is_file() {
        return Err(refuse(format!("there is no file {}", path.display())));
    }
    let model = Model::from_path_with(path, revision).map_err(|error| refuse(error.to_string()))?;
    let checksum = files.checksum(&folder).map_err(refuse)?;
    if !files.checksums.contains(&checksum) {
        let reason = format!(
            "the files in {} are not those of gymnasium-robotics 1.4.2 (in {}: checksum {checksum:08x}, not {:08x})",
            folder.display(),
            files.folders.join(", "),
            files.checksums[0]
        );
        return Err(refuse(reason));
    }
    Ok(model)
}

fn advice() -> String {
    format!(
        "Models of robots are not included: `pip install gymnasium-robotics==1.4.2` brings them, in the active virtual \
         environment or in `.venv`; or set {VARIABLE} to its folder `envs/assets`, or give the argument `assets`"
    )
}

impl Files {
    /// The checksum of the files in `assets`.
    fn checksum(&self, assets: &Path) -> std::result::Result<u32, String> {
        let mut paths = Vec::new();
        for folder in self.folders {
            collect(&assets.join(folder), &mut paths)
                .map_err(|error| format!("{}: {error}", assets.join(folder).display()))?;
        }
        paths.sort();
        let mut crc = crc32fast::Hasher::new();
        for path in paths {
            let bytes = file::read(&path, LARGEST)
                .map_err(|error| format!("{}: {error}", path.display()))?;
            crc.update(&bytes);
        }
        Ok(crc.finalize())
    }
}

/// Adds the models, meshes and textures of a folder and the folders within.
fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> std::io::Result<()> {
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let path = entry.path();
            // (links to folders could lead back)
            if entry.file_type()?.is_dir() {
                folders.push(path);
            } else if path
                .extension()
                .is_some_and(|kind| kind == "xml" || kind == "stl" || kind == "png")
            {
                paths.push(path);
            }
            if paths.len() + folders.len() > MOST {
                return Err(std::io::Error::other(format!("more than {MOST} files")));
            }
        }
    }
    Ok(())
}
