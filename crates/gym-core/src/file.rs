//! Files that appear under their name only when they are complete.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::{Error, Result};

/// A file being written under a temporary name in the folder where it belongs. Dropped without
/// [`commit`](Self::commit), it is removed.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    temporary: PathBuf,
    file: Option<BufWriter<File>>,
}

impl AtomicFile {
    /// Starts a file that will replace the one at `path`, if there is one.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder does not exist or cannot be written to.
    pub fn create(path: &Path) -> Result<Self> {
        /// Tells apart the files that one process writes at the same time.
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let name = path.file_name().ok_or_else(|| {
            Error::io(path, io::Error::new(io::ErrorKind::InvalidInput, "the path ends without a file name"))
        })?;
        let unique = format!(".{}-{}.tmp", process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(unique);
        let temporary = path.with_file_name(hidden);
        let file = File::create_new(&temporary).map_err(|error| Error::io(path, error))?;
        Ok(Self { path: path.to_owned(), temporary, file: Some(BufWriter::new(file)) })
    }

    /// Where the file lies until it has its name, for a program that writes it in our place.
    pub fn temporary_path(&self) -> &Path {
        &self.temporary
    }

    /// Gives the file its name; one of that name is replaced.
    ///
    /// # Errors
    /// [`Error::Io`] if the rest cannot be written; nothing is left behind then.
    pub fn commit(mut self) -> Result<()> {
        let renamed = self.file.take().map_or(Ok(()), |file| {
            let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
            drop(file);
            fs::rename(&self.temporary, &self.path)
        });
        renamed.map_err(|error| {
            // Nothing more can be done if this fails too.
            let _ = fs::remove_file(&self.temporary);
            Error::io(&self.path, error)
        })
    }

    fn open(&mut self) -> io::Result<&mut BufWriter<File>> {
        self.file.as_mut().ok_or_else(|| io::Error::other("the file is closed"))
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            // Without writing what is still in the buffer.
            drop(file.into_parts());
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.open()?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.open()?.flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.open()?.seek(position)
    }
}

/// Writes a whole file at once.
///
/// # Errors
/// [`Error::Io`] if it cannot be written; what was at `path` is then still there.
pub fn write(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let path = path.as_ref();
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes).map_err(|error| Error::io(path, error))?;
    file.commit()
}

#[cfg(test)]
mod tests {
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
