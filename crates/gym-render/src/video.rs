//! Animations in any format, by the file's extension.

use std::path::Path;

use crate::file::AtomicFile;
use gym_core::render::Frame;
use gym_core::{Error, Result};

use crate::GifWriter;
use crate::apng::Apng;
use crate::mp4::Mp4;
use crate::stream::Stream;

/// Writes an animation in the format that the file's extension names.
///
/// | extension | format |
/// |---|---|
/// | `gif` | GIF, as [`GifWriter`] writes it: loops, exact for drawings of up to 255 colours |
/// | `png`, `apng` | animated PNG: loops, always exact, at any rate |
/// | `mp4` | H.264 if `ffmpeg` supports it; needs that program, and is not exact |
///
/// Each frame is written at once. The file appears under its name when it is finished. Dropping the
/// writer also finishes it if a frame was written, but cannot report errors.
#[derive(Debug)]
pub struct VideoWriter(Kind);

#[derive(Debug)]
enum Kind {
    Gif(GifWriter),
    Png(Stream<Apng<AtomicFile>>),
    Mp4(Stream<Mp4>),
}

impl VideoWriter {
    /// Starts a file of that many frames per second.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an extension or a frame rate that cannot be written, or if
    /// `ffmpeg` is needed and missing; [`Error::Io`] if the file cannot be created.
    pub fn create(path: impl AsRef<Path>, fps: u32) -> Result<Self> {
        let path = path.as_ref();
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        Ok(Self(match extension.to_str() {
            Some("gif") => Kind::Gif(GifWriter::create(path, fps)?),
            Some("png" | "apng") => Kind::Png(Stream::create(path, fps)?),
            Some("mp4") => Kind::Mp4(Stream::create(path, fps)?),
            _ => {
                let reason = format!(
                    "`{}` has no known extension: use .gif, .png, .apng or .mp4",
                    path.display()
                );
                return Err(Error::argument("VideoWriter", reason));
            }
        }))
    }

    /// Appends a frame.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a frame that is empty, too large for the format, or of
    /// another size than the first, which is left out. [`Error::Io`] if writing fails; the file is
    /// then removed, and every later call fails.
    pub fn write(&mut self, frame: &Frame) -> Result<()> {
        match &mut self.0 {
            Kind::Gif(writer) => writer.write(frame),
            Kind::Png(stream) => stream.write(frame),
            Kind::Mp4(stream) => stream.write(frame),
        }
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails, now or before; [`Error::InvalidArgument`] if no frame was
    /// written; the file is then removed.
    pub fn finish(self) -> Result<()> {
        match self.0 {
            Kind::Gif(writer) => writer.finish(),
            Kind::Png(mut stream) => stream.finish(),
            Kind::Mp4(mut stream) => stream.finish(),
        }
    }

    /// Abandons and removes the file.
    pub fn abandon(self) {
        match self.0 {
            Kind::Gif(writer) => writer.abandon(),
            Kind::Png(mut stream) => stream.abandon(),
            Kind::Mp4(mut stream) => stream.abandon(),
        }
    }
}

/// Writes all frames to a file; see [`VideoWriter`].
///
/// # Errors
/// The errors of [`VideoWriter`]; the file is then removed.
pub fn write_video(path: impl AsRef<Path>, fps: u32, frames: &[Frame]) -> Result<()> {
    let mut writer = VideoWriter::create(path, fps)?;
    if let Err(error) = frames.iter().try_for_each(|frame| writer.write(frame)) {
        writer.abandon();
        return Err(error);
    }
    writer.finish()
}
