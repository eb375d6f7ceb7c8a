//! Regular files, read whole.
//!
//! A pipe that nobody writes is never opened, and a device such as `/dev/zero` never ends: whoever
//! reads a file that a user names reads it here.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read as _};
use std::path::Path;

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

#[cfg(test)]
mod tests {
    use super::*;

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
