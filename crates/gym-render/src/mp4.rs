//! MP4, written by the program `ffmpeg`, which receives raw frames through a pipe.

use std::fs;
use std::io::{self, Read, Write};
use std::process::{Child, Command, Output, Stdio};

use crate::file::AtomicFile;
use gym_core::printable;
use gym_core::render::Frame;

const PROGRAM: &str = "ffmpeg";

/// A file that `ffmpeg` is writing.
#[derive(Debug)]
pub(crate) struct Mp4 {
    ffmpeg: Ffmpeg,
    file: AtomicFile,
}

/// The running program. Dropping it early kills the program.
#[derive(Debug)]
struct Ffmpeg(Child);

impl Drop for Ffmpeg {
    fn drop(&mut self) {
        // both calls fail if the program has already ended
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// H.264's limit of width and height in `libx264`.
pub(crate) const MAX_SIDE: u32 = 16_384;

/// Returns an error if `ffmpeg` is missing or fails.
pub(crate) fn available() -> Result<(), String> {
    let output = Command::new(PROGRAM)
        .arg("-version")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .output();
    let what = match output {
        Ok(output) if output.status.success() => return Ok(()),
        Ok(output) => format!(
            "fails (`ffmpeg -version` gives {}): repair it",
            failure(&output)
        ),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            "was not found: install it".to_owned()
        }
        Err(error) => format!("cannot be run ({error}): repair it"),
    };
    Err(format!(
        "MP4 is written by the program `ffmpeg`, which {what}, or choose a name that ends in .gif \
         or .png"
    ))
}

/// Returns the last line of the errors of a program that failed, or else how it ended.
fn failure(output: &Output) -> String {
    let stderr = String::from_utf8_lossy(&output.stderr);
    match stderr.trim().lines().last() {
        Some(line) => format!("\"{}\"", printable(line)),
        None => output.status.to_string(),
    }
}

impl Mp4 {
    pub(crate) fn start(file: AtomicFile, fps: u32, frame: &Frame) -> io::Result<Self> {
        let size = format!("{}x{}", frame.width(), frame.height());
        let ffmpeg = Command::new(PROGRAM)
            .args(["-loglevel", "error", "-xerror"])
            .args([
                "-f",
                "rawvideo",
                "-pix_fmt",
                "rgb24",
                "-s",
                &size,
                "-r",
                &fps.to_string(),
                "-i",
                "-",
            ])
            // players expect colours at half resolution, which requires even sizes
            .args([
                "-vf",
                "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
                "-pix_fmt",
                "yuv420p",
            ])
            .args(["-movflags", "+faststart", "-f", "mp4", "-y"])
            .arg(file.temporary_path())
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()?;
        let mut mp4 = Self {
            ffmpeg: Ffmpeg(ffmpeg),
            file,
        };
        mp4.write(frame)?;
        Ok(mp4)
    }

    pub(crate) fn write(&mut self, frame: &Frame) -> io::Result<()> {
        let Some(pipe) = &mut self.ffmpeg.0.stdin else {
            return Err(io::Error::other("the pipe to `ffmpeg` is closed"));
        };
        // the error of a broken pipe does not say why `ffmpeg` ended; the output of `ffmpeg` does
        pipe.write_all(frame.pixels())
            .or_else(|error| self.wait().and(Err(error)))
    }

    pub(crate) fn finish(mut self) -> io::Result<AtomicFile> {
        self.wait()?;
        Ok(self.file)
    }

    /// Closes the pipe and waits until the file is complete.
    fn wait(&mut self) -> io::Result<()> {
        self.ffmpeg.0.stdin = None;
        let mut message = String::new();
        if let Some(mut stderr) = self.ffmpeg.0.stderr.take() {
            stderr.read_to_string(&mut message)?;
        }
        if self.ffmpeg.0.wait()?.success() {
            if fs::metadata(self.file.temporary_path())?.len() > 0 {
                return Ok(());
            }
            return Err(io::Error::other("`ffmpeg` ended early and wrote nothing"));
        }
        let is_full = message.contains("No space left on device");
        let kind = if is_full {
            io::ErrorKind::StorageFull
        } else {
            io::ErrorKind::Other
        };
        Err(io::Error::new(
            kind,
            format!("`ffmpeg` failed: {}", message.trim()),
        ))
    }
}
