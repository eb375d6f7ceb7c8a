//! Regular files, read whole.
//!
//! A pipe that nobody writes is never opened, and a device such as `/dev/zero` never ends: whoever
//! reads a file that a user names reads it here.

use std::env;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read as _};
use std::path::{Path, PathBuf};

/// Reads a regular file of at most `max` bytes.
///
/// # Errors
/// Those of the operating system; [`ErrorKind::InvalidInput`] for a folder, a pipe or a device, and
/// [`ErrorKind::FileTooLarge`].
pub fn read(path: &Path, max: usize) -> io::Result<Vec<u8>> {
    // check first, because opening a pipe waits for a writer
    let about = fs::metadata(path)?;
    if !about.is_file() {
        let reason = "not a regular file: a folder, a pipe or a device cannot be read";
        return Err(io::Error::new(ErrorKind::InvalidInput, reason));
    }
    let max_len = max as u64;
    let mut bytes = Vec::new();
    if about.len() <= max_len {
        // one byte more: the file may have grown
        let limit = max_len.saturating_add(1);
        File::open(path)?.take(limit).read_to_end(&mut bytes)?;
    }
    if about.len().max(bytes.len() as u64) > max_len {
        let reason = format!("longer than {max} bytes");
        return Err(io::Error::new(ErrorKind::FileTooLarge, reason));
    }
    Ok(bytes)
}

/// Reads a regular file of at most `max` bytes as text.
///
/// # Errors
/// Those of [`read`], and [`ErrorKind::InvalidData`] if the file is not text in UTF-8.
pub fn read_text(path: &Path, max: usize) -> io::Result<String> {
    String::from_utf8(read(path, max)?)
        .map_err(|_| io::Error::new(ErrorKind::InvalidData, "not text in UTF-8"))
}

/// Finds a folder of an installed Python package, such as `ale_py/roms`: in the active virtual
/// environment, in `.venv` in the current folder, or next to a `python3` in the `PATH`.
#[must_use]
pub fn of_python(folder: &str) -> Option<PathBuf> {
    let active = env::var_os("VIRTUAL_ENV").map(PathBuf::from);
    let path = env::var_os("PATH").unwrap_or_default();
    prefixes(active, &path).find_map(|prefix| installed(&prefix, folder))
}

/// The Python installations to look into, in their order: `active`, `.venv` in the current folder, and
/// the parent of each folder in `path` that has a `python3`.
fn prefixes(active: Option<PathBuf>, path: &OsStr) -> impl Iterator<Item = PathBuf> {
    let of_path = env::split_paths(path).filter(|folder| folder.join("python3").exists());
    active
        .into_iter()
        .chain([PathBuf::from(".venv")])
        .chain(of_path.filter_map(|folder| folder.parent().map(Path::to_owned)))
}

/// A folder of a package in a Python installation or virtual environment.
fn installed(prefix: &Path, folder: &str) -> Option<PathBuf> {
    let site_packages = ["lib", "lib64"].iter().flat_map(|lib| {
        let mut pythons: Vec<_> = fs::read_dir(prefix.join(lib))
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path())
            .filter(|path| {
                path.file_name()
                    .is_some_and(|name| name.to_string_lossy().starts_with("python3"))
            })
            .collect();
        pythons.sort();
        pythons
            .into_iter()
            .map(|python| python.join("site-packages"))
    });
    site_packages
        .chain([prefix.join("Lib").join("site-packages")])
        .map(|packages| packages.join(folder))
        .find(|folder| folder.is_dir())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_active_environment_comes_first_and_a_folder_without_python_counts_not() {
        let root = std::env::temp_dir().join(format!("gym-numerics-path-{}", std::process::id()));
        let bins = ["a", "b"].map(|name| root.join(name).join("bin"));
        bins.iter().for_each(|bin| fs::create_dir_all(bin).unwrap());
        fs::write(bins[1].join("python3"), "").unwrap();
        let path = env::join_paths(&bins).unwrap();
        let found = |active: Option<PathBuf>| prefixes(active, &path).collect::<Vec<_>>();
        let (local, of_path) = (PathBuf::from(".venv"), root.join("b"));
        assert_eq!(found(None), [local.clone(), of_path.clone()]);
        let active = PathBuf::from("active");
        assert_eq!(found(Some(active.clone())), [active, local, of_path]);
        fs::remove_dir_all(&root).unwrap();
    }

    #[test]
    fn a_package_is_found_in_the_layouts_of_an_installation() {
        let name = format!("gym-numerics-python-{}", std::process::id());
        let prefix = std::env::temp_dir().join(name);
        for layout in [
            "lib/python3.12/site-packages",
            "lib64/python3.12/site-packages",
            "Lib/site-packages",
        ] {
            assert_eq!(installed(&prefix, "package/data"), None, "{layout}");
            let folder = prefix.join(layout).join("package").join("data");
            fs::create_dir_all(&folder).unwrap();
            assert_eq!(installed(&prefix, "package/data"), Some(folder));
            fs::remove_dir_all(&prefix).unwrap();
        }
    }

    #[test]
    fn files_are_read_up_to_a_limit() {
        let path = std::env::temp_dir().join(format!("gym-numerics-file-{}", std::process::id()));
        fs::write(&path, "four").unwrap();
        assert_eq!(read(&path, 4).unwrap(), b"four");
        assert_eq!(read_text(&path, usize::MAX).unwrap(), "four");
        assert_eq!(read(&path, 3).unwrap_err().kind(), ErrorKind::FileTooLarge);
        fs::write(&path, [0xff]).unwrap();
        let error = read_text(&path, 4).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidData);
        fs::remove_file(&path).unwrap();
        assert_eq!(read(&path, 4).unwrap_err().kind(), ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn what_is_not_a_regular_file_is_refused_at_once() {
        let folder = std::env::temp_dir().join(format!("gym-numerics-pipe-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let pipe = folder.join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        let link = folder.join("link");
        std::os::unix::fs::symlink(&pipe, &link).unwrap();
        for path in [pipe, link, "/dev/zero".into(), folder.clone()] {
            let error = read(&path, 4).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::InvalidInput, "{}", path.display());
        }
        fs::remove_dir_all(&folder).unwrap();
    }
}
