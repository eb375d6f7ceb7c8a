//! Files that appear under their name only when they are complete.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use gym_core::{Error, Result};

/// A file being written under a temporary name in the folder where it belongs. Dropped without
/// [`commit`](AtomicFile::commit), it is removed.
#[derive(Debug)]
pub(crate) struct AtomicFile {
    path: PathBuf,
    temporary: PathBuf,
    file: Option<BufWriter<File>>,
}

impl AtomicFile {
    pub(crate) fn create(path: &Path) -> Result<Self> {
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

    /// Gives the file its name; one of that name is replaced.
    pub(crate) fn commit(mut self) -> Result<()> {
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
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes).map_err(|error| Error::io(path, error))?;
    file.commit()
}

/// Folders for tests.
#[cfg(test)]
pub(crate) mod testing {
    use super::*;

    /// A new empty folder, removed when dropped.
    pub(crate) struct Folder(pub(crate) PathBuf);

    impl Folder {
        pub(crate) fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("gym-render-{name}-{}", process::id()));
            let _ = fs::remove_dir_all(&path);
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        pub(crate) fn join(&self, name: &str) -> PathBuf {
            self.0.join(name)
        }

        /// The names of the files in it, hidden ones too.
        pub(crate) fn names(&self) -> Vec<String> {
            let name = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
            let mut names: Vec<String> = fs::read_dir(&self.0).unwrap().map(name).collect();
            names.sort();
            names
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::testing::Folder;
    use super::*;

    #[test]
    fn a_file_appears_when_it_is_complete() {
        let folder = Folder::new("commit");
        fs::write(folder.join("a.txt"), "old").unwrap();
        let mut file = AtomicFile::create(&folder.join("a.txt")).unwrap();
        file.write_all(b"new").unwrap();
        assert_eq!(fs::read(folder.join("a.txt")).unwrap(), b"old");
        file.commit().unwrap();
        assert_eq!(fs::read(folder.join("a.txt")).unwrap(), b"new");
        assert_eq!(folder.names(), ["a.txt"]);
    }

    #[test]
    fn a_file_that_is_dropped_leaves_nothing() {
        let folder = Folder::new("drop");
        let mut file = AtomicFile::create(&folder.join("a.txt")).unwrap();
        file.write_all(b"half").unwrap();
        assert_eq!(folder.names().len(), 1);
        drop(file);
        assert_eq!(folder.names(), [""; 0]);
    }

    #[test]
    fn two_writers_of_one_file_do_not_disturb_each_other() {
        let folder = Folder::new("two");
        let path = folder.join("a.txt");
        let (mut first, mut second) =
            (AtomicFile::create(&path).unwrap(), AtomicFile::create(&path).unwrap());
        first.write_all(b"first").unwrap();
        second.write_all(b"second").unwrap();
        second.commit().unwrap();
        first.commit().unwrap();
        assert_eq!(fs::read(path).unwrap(), b"first");
        assert_eq!(folder.names(), ["a.txt"]);
    }

    #[test]
    fn failures_are_errors_and_leave_nothing() {
        let folder = Folder::new("fail");
        assert!(matches!(write(&folder.join("no/a.txt"), b""), Err(Error::Io { .. })));
        assert!(matches!(write(Path::new("/"), b""), Err(Error::Io { .. })));
        fs::create_dir_all(folder.join("taken/full")).unwrap();
        assert!(matches!(write(&folder.join("taken"), b"x"), Err(Error::Io { .. })));
        assert_eq!(folder.names(), ["taken"]);
    }
}
