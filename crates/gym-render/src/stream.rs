//! Writing a file of frames, in any format.

use std::io;
use std::path::{Path, PathBuf};

use crate::file::AtomicFile;
use gym_core::render::Frame;
use gym_core::{Error, Result};

/// A video format, and a file being written.
pub(crate) trait Format: Sized {
    /// Whom errors speak of.
    const NAME: &'static str;
    /// The largest width and height.
    const MAX_SIDE: u32;
    /// The largest number of frames per second.
    const MAX_FPS: u32;

    /// Whether files of this format can be written here.
    fn available() -> Result<()> {
        Ok(())
    }

    /// Starts a file with its first frame.
    fn start(file: AtomicFile, fps: u32, frame: &Frame) -> io::Result<Self>;

    /// Appends a frame of the same size.
    fn write(&mut self, frame: &Frame) -> io::Result<()>;

    /// Completes the file.
    fn finish(self) -> io::Result<AtomicFile>;
}

/// Frames on their way into a file. Dropping it finishes the file if a frame was written.
#[derive(Debug)]
pub(crate) struct Stream<F: Format> {
    path: PathBuf,
    fps: u32,
    state: State<F>,
}

#[derive(Debug)]
enum State<F> {
    /// No frame yet.
    Created(AtomicFile),
    Running {
        format: Box<F>,
        size: (u32, u32),
    },
    /// Finished, or failed.
    Over,
}

impl<F: Format> Stream<F> {
    pub(crate) fn create(path: &Path, fps: u32) -> Result<Self> {
        if !(1..=F::MAX_FPS).contains(&fps) {
            let reason = format!(
                "fps is {fps}: give the frames per second, 1 to {}",
                F::MAX_FPS
            );
            return Err(Error::argument(F::NAME, reason));
        }
        F::available()?;
        Ok(Self {
            path: path.to_owned(),
            fps,
            state: State::Created(AtomicFile::create(path)?),
        })
    }

    pub(crate) fn write(&mut self, frame: &Frame) -> Result<()> {
        let size = (frame.width(), frame.height());
        let sides = 1..=F::MAX_SIDE;
        let refusal = match self.state {
            State::Running { size: first, .. } if size != first => {
                format!(
                    "{frame:?} cannot follow {}x{}: all frames must have one size",
                    first.0, first.1
                )
            }
            State::Created(_) if !(sides.contains(&size.0) && sides.contains(&size.1)) => {
                format!(
                    "{frame:?} does not fit: width and height must be 1 to {} pixels",
                    F::MAX_SIDE
                )
            }
            _ => String::new(),
        };
        if !refusal.is_empty() {
            return Err(Error::argument(F::NAME, refusal));
        }
        let format = match std::mem::replace(&mut self.state, State::Over) {
            State::Created(file) => F::start(file, self.fps, frame).map(Box::new),
            State::Running { mut format, .. } => format.write(frame).map(|()| format),
            State::Over => Err(failed_before()),
        };
        let format = format.map_err(|error| Error::io(&self.path, error))?;
        self.state = State::Running { format, size };
        Ok(())
    }

    pub(crate) fn finish(&mut self) -> Result<()> {
        match std::mem::replace(&mut self.state, State::Over) {
            State::Created(_) => Err(Error::argument(
                F::NAME,
                "no frame was written: write one before `finish`",
            )),
            State::Running { format, .. } => format
                .finish()
                .map_err(|error| Error::io(&self.path, error))?
                .commit(),
            State::Over => Err(Error::io(&self.path, failed_before())),
        }
    }

    /// Abandons and removes the file.
    pub(crate) fn abandon(&mut self) {
        self.state = State::Over;
    }
}

impl<F: Format> Drop for Stream<F> {
    fn drop(&mut self) {
        if let State::Running { .. } = self.state {
            // The error cannot be reported anywhere.
            let _ = self.finish();
        }
    }
}

fn failed_before() -> io::Error {
    io::Error::other("an earlier write to this file failed")
}
