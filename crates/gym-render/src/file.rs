//! Files that appear under their name only when they are complete.

mod temporary;

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use gym_core::{Error, Result};

pub use temporary::remove_unfinished_and_exit;
use temporary::{TemporaryPath, temporary};

/// A file that is written under a temporary name in its final folder. Dropping it without
/// [`commit`](Self::commit) removes it. If a program is killed, the next program that writes to the
/// folder removes the temporary file.
///
/// A symbolic link is followed: its target is replaced, and the link remains. The new file takes
/// the permissions of the file that it replaces. Devices, named pipes and `/dev/stdout` are not
/// replaced: `commit` writes the bytes to them.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    destination: Destination,
    file: BufWriter<File>,
    /// Declared after `file`, so that `file` is closed first.
    temporary: TemporaryPath,
}

/// The destination of a complete file.
#[derive(Debug, PartialEq)]
enum Destination {
    /// The file replaces the file at this path.
    Replace(PathBuf),
    /// The bytes are written to the device or pipe at this path.
    Append(PathBuf),
}

impl AtomicFile {
    /// Starts a file for `path`, which replaces an existing file.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder does not exist or cannot be written to, or if `path` is a
    /// folder.
    pub fn create(path: &Path) -> Result<Self> {
        let create = || {
            let destination = destination(path)?;
            let (file, temporary) = match &destination {
                Destination::Replace(path) => temporary(path)?,
                Destination::Append(path) => {
                    temporary(&std::env::temp_dir().join(path.file_name().unwrap_or_default()))?
                }
            };
            Ok(Self {
                path: path.to_owned(),
                destination,
                file: BufWriter::new(file),
                temporary,
            })
        };
        create().map_err(|error| Error::io(path, error))
    }

    /// Returns the temporary path, for another program that writes the file.
    pub fn temporary_path(&self) -> &Path {
        self.temporary.path()
    }

    /// Renames the file to its final path, where it replaces an existing file.
    ///
    /// # Errors
    /// [`Error::Io`] if the remaining bytes cannot be written; the file is then removed.
    pub fn commit(self) -> Result<()> {
        let Self {
            path,
            destination,
            file,
            temporary,
        } = self;
        let commit = || {
            let mut file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
            match destination {
                Destination::Replace(path) => {
                    // sync before the rename: otherwise a power cut between the two could leave an
                    // empty file
                    file.sync_all()?;
                    temporary.rename(path)
                }
                Destination::Append(path) => {
                    file.rewind()?;
                    io::copy(&mut file, &mut OpenOptions::new().append(true).open(path)?).map(drop)
                }
            }
        };
        commit().map_err(|error| Error::io(&path, error))
    }
}

/// Returns the destination of a file at `path`; follows links.
fn destination(path: &Path) -> io::Result<Destination> {
    const MAX_LINKS: usize = 40; // as on Linux
    let mut path = path.to_owned();
    match fs::metadata(&path) {
        Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => return Ok(Destination::Append(path)),
        _ => {}
    }
    for _ in 0..=MAX_LINKS {
        let Ok(target) = fs::read_link(&path) else {
            return Ok(Destination::Replace(path));
        };
        // an open file of this process, such as `/dev/stdout`, to which other programs may write
        // too
        if folder(&path)
            .canonicalize()
            .is_ok_and(|folder| folder.starts_with("/proc"))
        {
            return Ok(Destination::Append(path));
        }
        path = folder(&path).join(target);
    }
    Err(io::Error::other("its symbolic links form a loop"))
}

/// Returns the folder of `path`.
fn folder(path: &Path) -> &Path {
    path.parent()
        .filter(|folder| *folder != Path::new(""))
        .unwrap_or(Path::new("."))
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

/// Writes a whole file atomically.
///
/// # Errors
/// [`Error::Io`] if the file cannot be written; an existing file is then unchanged.
pub fn write(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let path = path.as_ref();
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes)
        .map_err(|error| Error::io(path, error))?;
    file.commit()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::TempDir;

    use super::temporary::remove_leftovers;
    use super::*;

    /// Returns the names of the files in a folder, including hidden files.
    fn names(folder: &TempDir) -> Vec<String> {
        let name =
            |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
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

    /// A file name may have any length up to 255 bytes, also with letters of several bytes.
    #[test]
    fn long_names_are_written() {
        let folder = TempDir::new().unwrap();
        for letter in ["a", "\u{e4}", "\u{1f3b2}"] {
            for length in (60..100).chain(230..=255) {
                let name = letter.repeat(length / letter.len());
                let path = folder.path().join(name);
                write(&path, b"whole").unwrap();
                assert_eq!(fs::read(&path).unwrap(), b"whole");
                fs::remove_file(&path).unwrap();
            }
        }
        let too_long = folder.path().join("a".repeat(256));
        assert!(write(too_long, b"").is_err());
        assert_eq!(names(&folder), [""; 0]);
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
        let (mut first, mut second) = (
            AtomicFile::create(&path).unwrap(),
            AtomicFile::create(&path).unwrap(),
        );
        first.write_all(b"first").unwrap();
        second.write_all(b"second").unwrap();
        second.commit().unwrap();
        first.commit().unwrap();
        assert_eq!(fs::read(path).unwrap(), b"first");
        assert_eq!(names(&folder), ["a.txt"]);
    }

    /// A killed program's file is not locked; a running program's file is.
    #[cfg(unix)]
    #[test]
    fn what_a_killed_run_left_behind_is_removed_by_the_next() {
        let folder = TempDir::new().unwrap();
        for name in [
            ".a.txt.Xy12Zw.gym-partial",
            ".b.gif.Xy12Zw.gym-partial",
            "a.gym-partial",
            ".a.txt.backup.tmp",
        ] {
            fs::write(folder.path().join(name), "half").unwrap();
        }
        let running = temporary(&folder.path().join("c.txt"));
        write(folder.path().join("a.txt"), b"new").unwrap();
        assert!(running.unwrap().1.path().exists());
        let mut left = names(&folder);
        left.sort();
        assert_eq!(
            left,
            [".a.txt.backup.tmp", "a.gym-partial", "a.txt"],
            "files of other programs stay"
        );
    }

    const WRITER: &str = "GYM_RENDER_TESTS_WRITER";

    /// The program that is killed: it repeatedly writes a file of one repeated letter.
    #[cfg(unix)]
    #[test]
    fn writer() {
        let Some(path) = std::env::var_os(WRITER) else {
            return;
        };
        for letter in (b'b'..=b'z').cycle() {
            write(&path, &vec![letter; 1 << 20]).unwrap();
        }
    }

    /// A program that is killed at any moment, as by a power cut, leaves a complete file, old or
    /// new, and at most one temporary file, which the next program removes.
    #[cfg(unix)]
    #[test]
    fn a_killed_program_leaves_a_whole_file() {
        use std::process::{Command, Stdio};

        for moment in 0..8 {
            let folder = TempDir::new().unwrap();
            let path = folder.path().join("a.txt");
            fs::write(&path, vec![b'a'; 1 << 20]).unwrap();
            let mut child = Command::new(std::env::current_exe().unwrap())
                .args(["--exact", "file::tests::writer"])
                .env(WRITER, &path)
                .stdout(Stdio::null())
                .spawn()
                .unwrap();
            // wait until the program writes, then for a varying moment
            while names(&folder).len() == 1 && fs::read(&path).unwrap()[0] == b'a' {
                assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
                std::thread::yield_now();
            }
            std::thread::sleep(std::time::Duration::from_micros(300 * moment));
            child.kill().unwrap();
            child.wait().unwrap();
            let left = fs::read(&path).unwrap();
            assert!(
                left.len() == 1 << 20 && left.iter().all(|letter| *letter == left[0]),
                "{}",
                left.len()
            );
            assert!(names(&folder).len() <= 2, "{:?}", names(&folder));
            write(&path, b"next").unwrap();
            assert_eq!(
                (fs::read(&path).unwrap(), names(&folder)),
                (b"next".to_vec(), vec!["a.txt".to_owned()])
            );
        }
    }

    const INTERRUPTED: &str = "GYM_RENDER_TESTS_INTERRUPTED";

    /// The program that is interrupted: its threads create files while it ends.
    #[test]
    fn interrupted() {
        let Some(folder) = std::env::var_os(INTERRUPTED) else {
            return;
        };
        for thread in 0..3 {
            let path = Path::new(&folder).join(format!("{thread}.txt"));
            std::thread::spawn(move || {
                loop {
                    AtomicFile::create(&path).unwrap();
                }
            });
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
        remove_unfinished_and_exit(130);
    }

    /// A program that ends while its threads create files leaves none.
    #[test]
    fn an_interrupted_program_leaves_no_temporary_file() {
        let folder = TempDir::new().unwrap();
        for _ in 0..30 {
            let status = std::process::Command::new(std::env::current_exe().unwrap())
                .args(["--exact", "file::tests::interrupted"])
                .env(INTERRUPTED, folder.path())
                .stdout(std::process::Stdio::null())
                .status()
                .unwrap();
            assert_eq!(status.code(), Some(130));
            assert_eq!(names(&folder), [""; 0]);
        }
    }

    /// A program does not remove the temporary file that another program is writing.
    #[cfg(unix)]
    #[test]
    fn a_file_that_is_being_written_is_no_leftover() {
        let folder = TempDir::new().unwrap();
        let hidden = folder.path().join(".x.gym-partial");
        let holder = File::create(&hidden).unwrap();
        holder.lock().unwrap();
        remove_leftovers(folder.path());
        assert!(hidden.exists());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_its_target_is_replaced() {
        use std::os::unix::fs::symlink;
        let folder = TempDir::new().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("there")).unwrap();
        fs::write(path("there/target"), "old").unwrap();
        symlink("there/target", path("relative")).unwrap();
        symlink(path("relative"), path("twice")).unwrap();
        symlink("there/new", path("dangling")).unwrap();
        write(path("twice"), b"new").unwrap();
        write(path("dangling"), b"first").unwrap();
        assert_eq!(fs::read(path("there/target")).unwrap(), b"new");
        assert_eq!(fs::read(path("there/new")).unwrap(), b"first");
        for name in ["relative", "twice", "dangling"] {
            assert!(
                fs::symlink_metadata(path(name)).unwrap().is_symlink(),
                "{name}"
            );
        }
        // Linux follows 40 links: `link40` can be written, `link41` cannot
        symlink("there/target", path("link1")).unwrap();
        for i in 2..=41 {
            symlink(format!("link{}", i - 1), path(&format!("link{i}"))).unwrap();
        }
        write(path("link40"), b"far").unwrap();
        assert_eq!(fs::read(path("there/target")).unwrap(), b"far");
        assert!(matches!(write(path("link41"), b""), Err(Error::Io { .. })));
        symlink("round", path("round")).unwrap();
        assert!(matches!(write(path("round"), b""), Err(Error::Io { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn a_file_keeps_its_permissions_when_it_is_replaced() {
        use std::os::unix::fs::PermissionsExt;
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("secret");
        for mode in [0o600, 0o640, 0o755] {
            fs::write(&path, "old").unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
            let file = AtomicFile::create(&path).unwrap();
            let half = fs::metadata(file.temporary_path())
                .unwrap()
                .permissions()
                .mode();
            assert_eq!(half & 0o777, mode, "a secret is one from the start");
            file.commit().unwrap();
            assert_eq!(
                fs::metadata(&path).unwrap().permissions().mode() & 0o777,
                mode
            );
        }
    }

    /// A device is written to and remains a device: `rename` would replace its node.
    #[cfg(target_os = "linux")]
    #[test]
    fn devices_and_pipes_are_written_to() {
        use std::os::unix::fs::{FileTypeExt, symlink};
        let folder = TempDir::new().unwrap();
        // only the destination: an attempt to replace the device would destroy it if the test fails
        // with root rights
        assert_eq!(
            destination(Path::new("/dev/full")).unwrap(),
            Destination::Append("/dev/full".into())
        );
        write("/dev/null", b"gone").unwrap();
        let full = write("/dev/full", b"too much").unwrap_err();
        assert!(
            matches!(&full, Error::Io { source, .. } if source.kind() == io::ErrorKind::StorageFull),
            "{full}"
        );
        assert!(
            fs::metadata("/dev/full")
                .unwrap()
                .file_type()
                .is_char_device()
        );

        let pipe = folder.path().join("pipe");
        assert!(
            std::process::Command::new("mkfifo")
                .arg(&pipe)
                .status()
                .unwrap()
                .success()
        );
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe).unwrap()
        });
        write(&pipe, b"through").unwrap();
        assert_eq!(reader.join().unwrap(), b"through");
        assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());

        // like `/dev/stdout`, redirected to a file to which another program writes too
        let log = folder.path().join("log");
        let mut open = File::create(&log).unwrap();
        open.write_all(b"before ").unwrap();
        let descriptor = format!("/proc/self/fd/{}", std::os::fd::AsRawFd::as_raw_fd(&open));
        symlink(descriptor, folder.path().join("stdout")).unwrap();
        write(folder.path().join("stdout"), b"through").unwrap();
        assert_eq!(fs::read(&log).unwrap(), b"before through");
        assert_eq!(
            names(&folder).len(),
            3,
            "nothing else is left in the folder"
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_file_has_the_permissions_of_any_other() {
        use std::os::unix::fs::PermissionsExt;
        let folder = TempDir::new().unwrap();
        let mode = |name: &str| {
            fs::metadata(folder.path().join(name))
                .unwrap()
                .permissions()
                .mode()
        };
        fs::write(folder.path().join("plain"), "").unwrap();
        write(folder.path().join("atomic"), b"").unwrap();
        assert_eq!(mode("atomic"), mode("plain"));
    }

    #[test]
    fn failures_are_errors_and_leave_nothing() {
        let folder = TempDir::new().unwrap();
        assert!(matches!(
            write(folder.path().join("no/a.txt"), b""),
            Err(Error::Io { .. })
        ));
        assert!(matches!(write("/", b""), Err(Error::Io { .. })));
        fs::create_dir_all(folder.path().join("taken/full")).unwrap();
        assert!(matches!(
            write(folder.path().join("taken"), b"x"),
            Err(Error::Io { .. })
        ));
        assert_eq!(names(&folder), ["taken"]);
    }
}
