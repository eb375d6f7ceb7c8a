//! Helpers for tests.

use std::io::{self, Cursor, Seek, SeekFrom, Write};

use tempfile::TempDir;

/// Returns the names of the files in a folder, including hidden files.
pub(crate) fn names(folder: &TempDir) -> Vec<String> {
    let entries = std::fs::read_dir(folder.path()).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// A writer that has space for some bytes and then fails like a full disk.
pub(crate) struct Full(Cursor<Vec<u8>>, usize);

impl Full {
    pub(crate) fn new(room: usize) -> Self {
        Self(Cursor::new(Vec::new()), room)
    }
}

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let end = self.0.position() as usize + bytes.len();
        if end > self.1 {
            Err(io::ErrorKind::StorageFull.into())
        } else {
            self.0.write(bytes)
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Full {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.0.seek(position)
    }
}
