//! Files that appear under their name only when they are complete.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempPath};

use gym_core::{Error, Result};

/// A file that is written under a temporary name in its folder. Dropping it without
/// [`commit`](Self::commit) removes it.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    file: BufWriter<File>,
    /// Removes the file when it is dropped. After `file`, which is closed first.
    temporary: TempPath,
}

impl AtomicFile {
    /// Starts a file that will replace the one at `path`, if there is one.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder does not exist or cannot be written to.
    pub fn create(path: &Path) -> Result<Self> {
        let (file, temporary) = temporary(path).map_err(|error| Error::io(path, error))?.into_parts();
        Ok(Self { path: path.to_owned(), file: BufWriter::new(file), temporary })
    }

    /// The temporary path, for another program that writes the file.
    pub fn temporary_path(&self) -> &Path {
        &self.temporary
    }

    /// Gives the file its name; one of that name is replaced.
    ///
    /// # Errors
    /// [`Error::Io`] if the rest cannot be written; then no file remains.
    pub fn commit(self) -> Result<()> {
        let Self { path, file, temporary } = self;
        let written = file.into_inner().map_err(io::IntoInnerError::into_error);
        let renamed = written.map(drop).and_then(|()| temporary.persist(&path).map_err(|error| error.error));
        renamed.map_err(|error| Error::io(&path, error))
    }
}

/// A file of a name that no other has, in the folder of `path`.
fn temporary(path: &Path) -> io::Result<NamedTempFile> {
    let no_name = || io::Error::new(io::ErrorKind::InvalidInput, "the path has no file name");
    let mut prefix = std::ffi::OsString::from(".");
    prefix.push(path.file_name().ok_or_else(no_name)?);
    prefix.push(".");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".tmp");
    // with the permissions of ordinary files, not those of temporary ones
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new(".")))
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.file.seek(position)
    }
}

/// Writes a whole file at once.
///
/// # Errors
/// [`Error::Io`] if it cannot be written; the old file is then unchanged.
pub fn write(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let path = path.as_ref();
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes).map_err(|error| Error::io(path, error))?;
    file.commit()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::TempDir;

    use super::*;

    /// The names of the files in a folder, hidden ones too.
    fn names(folder: &TempDir) -> Vec<String> {
        let name = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
        fs::read_dir(folder.path()).unwrap().map(name).collect()
    }

    #[test]
    fn a_file_appears_when_it_is_complete() {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("a.txt"), "old").unwrap();
        let mut file = AtomicFile::create(&folder.path().join("a.txt")).unwrap();
        file.write_all(b"new").unwrap();
        assert_eq!(fs::read(folder.path().join("a.txt")).unwrap(), b"old");
        file.commit().unwrap();
        assert_eq!(fs::read(folder.path().join("a.txt")).unwrap(), b"new");
        assert_eq!(names(&folder), ["a.txt"]);
    }

    #[test]
    fn a_file_that_is_dropped_leaves_nothing() {
        let folder = TempDir::new().unwrap();
        let mut file = AtomicFile::create(&folder.path().join("a.txt")).unwrap();
        file.write_all(b"half").unwrap();
        assert_eq!(names(&folder).len(), 1);
        drop(file);
        assert_eq!(names(&folder), [""; 0]);
    }

    #[test]
    fn two_writers_of_one_file_do_not_disturb_each_other() {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("a.txt");
        let (mut first, mut second) =
            (AtomicFile::create(&path).unwrap(), AtomicFile::create(&path).unwrap());
        first.write_all(b"first").unwrap();
        second.write_all(b"second").unwrap();
        second.commit().unwrap();
        first.commit().unwrap();
        assert_eq!(fs::read(path).unwrap(), b"first");
        assert_eq!(names(&folder), ["a.txt"]);
    }

    /// A process id is not unique: in a container each run has the same.
    #[test]
    fn what_a_killed_run_left_behind_does_not_stop_the_next() {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("a.txt");
        for count in 0..1000 {
            fs::write(folder.path().join(format!(".a.txt.{}-{count}.tmp", std::process::id())), "").unwrap();
        }
        std::mem::forget(AtomicFile::create(&path).unwrap());
        write(&path, b"new").unwrap();
        assert_eq!(fs::read(path).unwrap(), b"new");
    }

    #[cfg(unix)]
    #[test]
    fn a_file_has_the_permissions_of_any_other() {
        use std::os::unix::fs::PermissionsExt;
        let folder = TempDir::new().unwrap();
        let mode = |name: &str| fs::metadata(folder.path().join(name)).unwrap().permissions().mode();
        fs::write(folder.path().join("plain"), "").unwrap();
        write(folder.path().join("atomic"), b"").unwrap();
        assert_eq!(mode("atomic"), mode("plain"));
    }

    #[test]
    fn failures_are_errors_and_leave_nothing() {
        let folder = TempDir::new().unwrap();
        assert!(matches!(write(folder.path().join("no/a.txt"), b""), Err(Error::Io { .. })));
        assert!(matches!(write("/", b""), Err(Error::Io { .. })));
        fs::create_dir_all(folder.path().join("taken/full")).unwrap();
        assert!(matches!(write(folder.path().join("taken"), b"x"), Err(Error::Io { .. })));
        assert_eq!(names(&folder), ["taken"]);
    }
}
