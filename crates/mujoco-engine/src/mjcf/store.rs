//! Where the files of a model are: on the disk, or in memory.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, ErrorKind};
use std::path::{Component, Path};

use gym_numerics::file;

/// The largest size in bytes of all files of a model that are no texts, each as often as it is named.
const MAX_ASSETS: u64 = 256 << 20;

/// The files that a model may name.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum Store<'a> {
    #[default]
    Disk,
    /// Files by their paths, with `/` after each folder.
    Memory(&'a BTreeMap<String, Vec<u8>>),
}

impl<'a> Store<'a> {
    /// The file of a path in memory.
    fn in_memory(files: &'a BTreeMap<String, Vec<u8>>, path: &Path) -> Option<&'a [u8]> {
        files.get(&plain(path)?).map(Vec::as_slice)
    }

    /// Whether there is a file, or on the disk a folder, of that path.
    pub(super) fn exists(self, path: &Path) -> bool {
        match self {
            Self::Disk => path.exists(),
            Self::Memory(files) => Self::in_memory(files, path).is_some(),
        }
    }

    /// Whether there is a file of that path.
    pub(super) fn has_file(self, path: &Path) -> bool {
        match self {
            Self::Disk => path.is_file(),
            Self::Memory(_) => self.exists(path),
        }
    }

    /// Whether two paths are of one file.
    pub(super) fn same(self, a: &Path, b: &Path) -> bool {
        match self {
            Self::Disk => match (a.canonicalize(), b.canonicalize()) {
                (Ok(a), Ok(b)) => a == b,
                _ => a == b,
            },
            Self::Memory(_) => plain(a).is_some_and(|a| plain(b) == Some(a)),
        }
    }

    /// The bytes of a regular file of at most `max` bytes.
    fn read(self, path: &Path, max: usize) -> io::Result<Cow<'a, [u8]>> {
        let files = match self {
            Self::Disk => return file::read(path, max).map(Cow::Owned),
            Self::Memory(files) => files,
        };
        match Self::in_memory(files, path) {
            None => Err(io::Error::new(ErrorKind::NotFound, "there is no such file")),
            Some(bytes) if bytes.len() > max => {
                let reason = format!("longer than {max} bytes");
                Err(io::Error::new(ErrorKind::FileTooLarge, reason))
            }
            Some(bytes) => Ok(Cow::Borrowed(bytes)),
        }
    }

    /// The text of a regular file of at most `max` bytes.
    pub(super) fn read_text(self, path: &Path, max: usize) -> io::Result<String> {
        String::from_utf8(self.read(path, max)?.into_owned())
            .map_err(|_| io::Error::new(ErrorKind::InvalidData, "not text in UTF-8"))
    }

    /// The files of assets that may be read.
    pub(crate) fn assets(self) -> Assets<'a> {
        Assets {
            store: self,
            left: MAX_ASSETS,
        }
    }
}

/// A path without `.`, and with each `..` applied; `None` if it leads out of the files.
fn plain(path: &Path) -> Option<String> {
    let mut parts = Vec::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                parts.pop()?;
            }
            Component::Normal(name) => parts.push(name.to_str()?),
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(parts.join("/"))
}

/// The files that are no texts, of a limited size together.
#[derive(Debug)]
pub(crate) struct Assets<'a> {
    store: Store<'a>,
    /// How many more bytes may be read.
    left: u64,
}

impl<'a> Assets<'a> {
    /// The bytes of a regular file.
    pub(crate) fn read(&mut self, path: &Path) -> Result<Cow<'a, [u8]>, String> {
        let most = usize::try_from(self.left).unwrap_or(usize::MAX);
        let bytes = self
            .store
            .read(path, most)
            .map_err(|error| match error.kind() {
                ErrorKind::FileTooLarge => too_large(),
                _ => error.to_string(),
            })?;
        self.left -= bytes.len() as u64;
        Ok(bytes)
    }

    /// Counts bytes of what has no file.
    pub(crate) fn count(&mut self, bytes: u64) -> Result<(), String> {
        self.left = self.left.checked_sub(bytes).ok_or_else(too_large)?;
        Ok(())
    }
}

/// Why no more files of assets are read.
fn too_large() -> String {
    format!("the files of all assets together have more than {MAX_ASSETS} bytes: simplify them")
}
