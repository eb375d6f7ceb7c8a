//! Temporary files: their names, their locks, and the removal of those that nobody finishes.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::folder;

/// The path of a temporary file. Dropping it removes the file.
#[derive(Debug)]
pub(super) struct TemporaryPath(PathBuf);

/// The temporary files of this program.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

impl TemporaryPath {
    /// Creates the file. [`AlreadyExists`](io::ErrorKind::AlreadyExists) if there is a file at
    /// `path`.
    fn create(path: PathBuf) -> io::Result<(File, Self)> {
        // the lock covers creation and insertion, so that `remove_unfinished` finds every file that
        // exists
        let mut unfinished = unfinished();
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .create_new(true)
            .open(&path)?;
        unfinished.insert(path.clone());
        Ok((file, Self(path)))
    }

    /// The path.
    pub(super) fn path(&self) -> &Path {
        &self.0
    }

    /// Renames the file.
    pub(super) fn rename(mut self, to: PathBuf) -> io::Result<()> {
        fs::rename(&self.0, to)?;
        unfinished().remove(&self.0);
        // clear the path, so that `drop` removes nothing: another program's file may have this name
        // by now
        self.0.clear();
        Ok(())
    }
}

impl Drop for TemporaryPath {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
        unfinished().remove(&self.0);
    }
}

/// Removes every temporary file of this program and ends the program with the exit code `code`.
/// Call it in a signal handler: a program that a signal ends drops no [`AtomicFile`](super::AtomicFile).
pub fn remove_unfinished_and_exit(code: i32) -> ! {
    let _no_new_files = remove_unfinished();
    std::process::exit(code)
}

/// Removes every temporary file of this program. Until the guard is dropped, other threads create
/// no temporary files.
fn remove_unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    let unfinished = unfinished();
    for path in &*unfinished {
        let _ = fs::remove_file(path);
    }
    unfinished
}

/// The suffix of temporary files.
const SUFFIX: &str = ".gym-partial";

/// The number of bytes of a file's name that its temporary file's name may repeat.
const MAX_START: usize = 80;

/// Creates a file with a unique name in the folder of `path`, with the permissions of the file at
/// `path`.
pub(super) fn temporary(path: &Path) -> io::Result<(File, TemporaryPath)> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let no_name = || io::Error::new(io::ErrorKind::InvalidInput, "the path has no file name");
    let name = path.file_name().ok_or_else(no_name)?.to_string_lossy();
    // a file name has at most 255 bytes, and on some systems fewer
    let end = |(at, letter): (usize, char)| at + letter.len_utf8();
    let ends = name.char_indices().map(end);
    let end = ends.take_while(|end| *end <= MAX_START).last();
    let name = &name[..end.unwrap_or(0)];
    remove_leftovers(folder(path));
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let hidden = folder(path).join(format!(".{name}.{count}{SUFFIX}"));
        let (file, temporary) = match TemporaryPath::create(hidden) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            created => created?,
        };
        lock(&file);
        // another program may have removed the temporary file as a leftover before this program
        // locked it
        if temporary.0.exists() {
            #[cfg(unix)]
            if let Ok(found) = fs::metadata(path) {
                use std::os::unix::fs::{MetadataExt, fchown};
                // only root can change the owner
                let _ = fchown(&file, Some(found.uid()), Some(found.gid()));
                file.set_permissions(found.permissions())?;
            }
            return Ok((file, temporary));
        }
    }
}

/// Locks a temporary file to mark it as being written. If the file system has no locks, the file
/// stays unlocked.
fn lock(file: &File) {
    // on Windows a lock would prevent other programs, such as `ffmpeg`, from writing to the file
    if cfg!(unix) {
        let _ = file.lock();
    }
}

/// Removes temporary files in `folder` that no running program writes. Each folder is cleaned only
/// once, because a recording of many files would otherwise read the folder for each file.
pub(super) fn remove_leftovers(folder: &Path) {
    static CLEANED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let Ok(folder) = folder.canonicalize() else {
        return;
    };
    if cfg!(not(unix))
        || !CLEANED
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .insert(folder.clone())
    {
        return;
    }
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file
            && name.as_encoded_bytes().starts_with(b".")
            && name.as_encoded_bytes().ends_with(SUFFIX.as_bytes())
        {
            // a lock may require write access; `file` keeps the lock until the file is removed
            if let Ok(file) = OpenOptions::new().write(true).open(entry.path())
                && file.try_lock().is_ok()
            {
                let _ = fs::remove_file(entry.path());
            }
        }
    }
}
