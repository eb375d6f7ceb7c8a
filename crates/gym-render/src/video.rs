//! Animations in every format, to a file or to memory.

use std::fmt;
use std::io::{self, Cursor, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use gym_core::render::Frame;
use gym_core::{Error, Result};

use crate::apng::Apng;
use crate::file::AtomicFile;
use crate::gif::Gif;
use crate::mp4::{self, Mp4};

/// The format of a [`Video`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum VideoFormat {
    /// GIF (extension `gif`). It loops, and is exact for drawings of up to 255 colours. Above 50
    /// frames per second it skips frames, because viewers show each image for at least two
    /// hundredths of a second.
    Gif,
    /// Animated PNG (`png` or `apng`). It loops, and is always exact.
    Apng,
    /// H.264 (`mp4`), to a file only. It needs the program `ffmpeg`, and is not exact.
    Mp4,
}

impl VideoFormat {
    /// Returns the format that the extension of `path` selects.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an unknown extension.
    pub fn of(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("gif") => Ok(Self::Gif),
            Some("png" | "apng") => Ok(Self::Apng),
            Some("mp4") => Ok(Self::Mp4),
            _ => Err(refused(format!(
                "`{}` has no known extension: use .gif, .png, .apng or .mp4",
                path.display()
            ))),
        }
    }

    /// The largest width and height.
    fn max_side(self) -> u32 {
        match self {
            Self::Gif => u16::MAX.into(),
            Self::Apng => i32::MAX as u32,
            Self::Mp4 => mp4::MAX_SIDE,
        }
    }

    /// The largest number of frames per second.
    fn max_fps(self) -> u32 {
        match self {
            Self::Gif => u32::MAX,
            Self::Apng => u16::MAX.into(),
            Self::Mp4 => 1000,
        }
    }
}

impl fmt::Display for VideoFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Gif => "GIF",
            Self::Apng => "PNG",
            Self::Mp4 => "MP4",
        })
    }
}

/// Writes an animation, frame by frame, to a file or to memory.
///
/// ```no_run
/// # fn frames() -> Vec<gym_core::render::Frame> { Vec::new() }
/// use gym_render::Video;
///
/// let mut video = Video::create("cartpole.gif", 50)?;
/// for frame in frames() {
///     video.write(&frame)?;
/// }
/// video.finish()?;
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// Memory holds a few frames at a time (and the encoded bytes, for a video in memory). A file
/// appears under its name when it is finished. Dropping the video also finishes the file if it has
/// a frame, but cannot report errors.
#[derive(Debug)]
pub struct Video {
    format: VideoFormat,
    fps: u32,
    /// The path of the file; `None` for a video in memory.
    path: Option<PathBuf>,
    state: State,
}

#[derive(Debug)]
enum State {
    /// No frame was written yet.
    Created(Output),
    Running {
        encoder: Encoder,
        size: (u32, u32),
    },
    /// The video was finished, or an error ended it.
    Over,
}

impl Video {
    /// Starts a file with `fps` frames per second in the format that its extension selects: see
    /// [`VideoFormat`].
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an unknown extension, for an `fps` that the format does not
    /// support, and for MP4 without `ffmpeg`; [`Error::Io`] if the file cannot be created.
    pub fn create(path: impl AsRef<Path>, fps: u32) -> Result<Self> {
        let path = path.as_ref();
        let format = VideoFormat::of(path)?;
        check_fps(format, fps)?;
        if format == VideoFormat::Mp4 {
            mp4::available().map_err(refused)?;
        }
        Ok(Self {
            format,
            fps,
            path: Some(path.to_owned()),
            state: State::Created(Output::File(AtomicFile::create(path)?)),
        })
    }

    /// Starts a video in memory with `fps` frames per second; [`into_bytes`](Self::into_bytes)
    /// returns it.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for [`VideoFormat::Mp4`], and for an `fps` that the format does
    /// not support.
    pub fn in_memory(format: VideoFormat, fps: u32) -> Result<Self> {
        check_fps(format, fps)?;
        if format == VideoFormat::Mp4 {
            let reason = "MP4 needs a file: use `Video::create`, or another format";
            return Err(refused(reason));
        }
        Ok(Self {
            format,
            fps,
            path: None,
            state: State::Created(Output::Memory(Cursor::default())),
        })
    }

    /// Appends a frame.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a frame that is empty, too large for the format, or of
    /// another size than the first; such a frame is skipped. [`Error::Io`] if writing fails; the
    /// file is then removed, and every later call fails.
    pub fn write(&mut self, frame: &Frame) -> Result<()> {
        let size = (frame.width(), frame.height());
        match self.state {
            State::Running { size: first, .. } if size != first => {
                return Err(refused(format!(
                    "{frame:?} cannot follow {}x{}: all frames must have one size",
                    first.0, first.1
                )));
            }
            State::Created(_) => {
                let sides = 1..=self.format.max_side();
                if !sides.contains(&size.0) || !sides.contains(&size.1) {
                    return Err(refused(format!(
                        "{frame:?} does not fit: width and height must be 1 to {} pixels",
                        self.format.max_side()
                    )));
                }
            }
            _ => {}
        }
        let encoder = match std::mem::replace(&mut self.state, State::Over) {
            State::Created(output) => Encoder::start(self.format, output, self.fps, frame),
            State::Running { mut encoder, .. } => encoder.write(frame).map(|()| encoder),
            State::Over => Err(failed_before()),
        };
        let encoder = encoder.map_err(|error| self.failed(error))?;
        self.state = State::Running { encoder, size };
        Ok(())
    }

    /// Completes the file.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails, now or before; [`Error::InvalidArgument`] if no frame was
    /// written. The file is then removed.
    pub fn finish(mut self) -> Result<()> {
        self.complete()?.commit()
    }

    /// Completes a video in memory and returns its bytes.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if no frame was written, or the video is a file, which is then
    /// removed.
    pub fn into_bytes(mut self) -> Result<Vec<u8>> {
        match self.complete()? {
            Output::Memory(bytes) => Ok(bytes.into_inner()),
            Output::File(_) => Err(refused(
                "the video is a file: call `finish`, or make it with `Video::in_memory`",
            )),
        }
    }

    /// Abandons and removes the file.
    pub fn abandon(mut self) {
        self.state = State::Over;
    }

    fn complete(&mut self) -> Result<Output> {
        match std::mem::replace(&mut self.state, State::Over) {
            State::Created(_) => Err(refused("no frame was written: write one before `finish`")),
            State::Running { encoder, .. } => encoder.finish().map_err(|error| self.failed(error)),
            State::Over => Err(self.failed(failed_before())),
        }
    }

    fn failed(&self, error: io::Error) -> Error {
        match &self.path {
            Some(path) => Error::io(path, error),
            None => Error::custom(format!("the {} could not be written: {error}", self.format)),
        }
    }
}

impl Drop for Video {
    fn drop(&mut self) {
        if let State::Running { .. } = self.state {
            // `drop` cannot report the error
            let _ = self.complete().and_then(Output::commit);
        }
    }
}

/// Writes all frames to a file; see [`Video`].
///
/// # Errors
/// The errors of [`Video`]; the file is then removed.
pub fn write_video(path: impl AsRef<Path>, fps: u32, frames: &[Frame]) -> Result<()> {
    let mut video = Video::create(path, fps)?;
    if let Err(error) = frames.iter().try_for_each(|frame| video.write(frame)) {
        video.abandon();
        return Err(error);
    }
    video.finish()
}

fn check_fps(format: VideoFormat, fps: u32) -> Result<()> {
    let max = format.max_fps();
    if (1..=max).contains(&fps) {
        return Ok(());
    }
    Err(refused(format!(
        "fps is {fps}: give the frames per second, 1 to {max}"
    )))
}

fn refused(reason: impl Into<String>) -> Error {
    Error::argument("Video", reason)
}

fn failed_before() -> io::Error {
    io::Error::other("an earlier write to this file failed")
}

/// The destination of a video's bytes.
#[derive(Debug)]
pub(crate) enum Output {
    File(AtomicFile),
    Memory(Cursor<Vec<u8>>),
}

impl Output {
    /// Renames a file to its final path.
    fn commit(self) -> Result<()> {
        match self {
            Self::File(file) => file.commit(),
            Self::Memory(_) => Ok(()),
        }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.write(bytes),
            Self::Memory(memory) => memory.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::File(file) => file.flush(),
            Self::Memory(memory) => memory.flush(),
        }
    }
}

impl Seek for Output {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        match self {
            Self::File(file) => file.seek(position),
            Self::Memory(memory) => memory.seek(position),
        }
    }
}

/// The encoder of a video.
#[derive(Debug)]
enum Encoder {
    Gif(Box<Gif<Output>>),
    Apng(Box<Apng<Output>>),
    Mp4(Box<Mp4>),
}

impl Encoder {
    /// Starts a video with its first frame.
    fn start(format: VideoFormat, output: Output, fps: u32, frame: &Frame) -> io::Result<Self> {
        Ok(match (format, output) {
            (VideoFormat::Mp4, Output::File(file)) => {
                Self::Mp4(Box::new(Mp4::start(file, fps, frame)?))
            }
            (VideoFormat::Mp4, Output::Memory(_)) => {
                return Err(io::ErrorKind::Unsupported.into());
            }
            (VideoFormat::Gif, output) => Self::Gif(Box::new(Gif::start(output, fps, frame)?)),
            (VideoFormat::Apng, output) => Self::Apng(Box::new(Apng::start(output, fps, frame)?)),
        })
    }

    /// Appends a frame of the same size.
    fn write(&mut self, frame: &Frame) -> io::Result<()> {
        match self {
            Self::Gif(gif) => gif.write(frame),
            Self::Apng(apng) => apng.write(frame),
            Self::Mp4(mp4) => mp4.write(frame),
        }
    }

    fn finish(self) -> io::Result<Output> {
        match self {
            Self::Gif(gif) => gif.finish(),
            Self::Apng(apng) => apng.finish(),
            Self::Mp4(mp4) => mp4.finish().map(Output::File),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::TempDir;

    use super::*;
    use crate::testing::names;

    /// Frames of a line that moves.
    fn moving(count: u32) -> Vec<Frame> {
        (0..count)
            .map(|step| {
                let mut frame = Frame::new(60, 10).unwrap();
                let start = step as usize * 3;
                frame.pixels_mut()[start..start + 12].fill(255);
                frame
            })
            .collect()
    }

    fn encoded(frames: &[Frame]) -> Vec<u8> {
        let mut video = Video::in_memory(VideoFormat::Gif, 50).unwrap();
        frames.iter().for_each(|frame| video.write(frame).unwrap());
        video.into_bytes().unwrap()
    }

    #[test]
    fn files_appear_when_finished_or_dropped() {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("a.gif");
        let mut writer = Video::create(&path, 50).unwrap();
        moving(3)
            .iter()
            .for_each(|frame| writer.write(frame).unwrap());
        assert!(!path.exists());
        writer.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), encoded(&moving(3)));

        let mut dropped = Video::create(folder.path().join("b.gif"), 50).unwrap();
        moving(3)
            .iter()
            .for_each(|frame| dropped.write(frame).unwrap());
        drop(dropped);
        write_video(folder.path().join("c.gif"), 50, &moving(3)).unwrap();
        assert_eq!(names(&folder), ["a.gif", "b.gif", "c.gif"]);
        assert_eq!(
            fs::read(folder.path().join("b.gif")).unwrap(),
            fs::read(folder.path().join("c.gif")).unwrap()
        );
    }

    #[test]
    fn an_animation_in_memory_equals_the_file() {
        let folder = TempDir::new().unwrap();
        let frames = moving(12);
        for (format, name) in [(VideoFormat::Gif, "a.gif"), (VideoFormat::Apng, "a.png")] {
            let path = folder.path().join(name);
            write_video(&path, 50, &frames).unwrap();
            let mut video = Video::in_memory(format, 50).unwrap();
            frames.iter().for_each(|frame| video.write(frame).unwrap());
            assert!(video.write(&Frame::new(3, 3).unwrap()).is_err());
            assert_eq!(video.into_bytes().unwrap(), fs::read(path).unwrap());
        }
        assert!(Video::in_memory(VideoFormat::Gif, 0).is_err());
        assert!(Video::in_memory(VideoFormat::Mp4, 50).is_err());
        let mut empty = Video::in_memory(VideoFormat::Gif, 1).unwrap();
        assert!(empty.write(&Frame::new(0, 2).unwrap()).is_err());
        assert!(empty.into_bytes().is_err());
    }

    #[test]
    fn a_file_has_no_bytes_in_memory() {
        let folder = TempDir::new().unwrap();
        let mut video = Video::create(folder.path().join("a.gif"), 50).unwrap();
        video.write(&moving(1)[0]).unwrap();
        assert!(video.into_bytes().is_err());
        assert_eq!(names(&folder), [""; 0]);
    }

    #[test]
    fn mistakes_are_errors_and_leave_no_file() {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("a.gif");
        let refused = |result: Result<()>| matches!(result, Err(Error::InvalidArgument { .. }));
        let mixed = [Frame::new(2, 2).unwrap(), Frame::new(3, 2).unwrap()];
        assert!(refused(Video::create(&path, 0).map(|_| ())));
        assert!(refused(Video::create(&path, 1).unwrap().finish()));
        assert!(refused(write_video(&path, 1, &[])));
        assert!(refused(write_video(&path, 1, &mixed)));
        assert!(refused(write_video(&path, 1, &[Frame::new(0, 2).unwrap()])));
        assert!(refused(write_video(
            &path,
            1,
            &[Frame::new(65536, 1).unwrap()]
        )));
        assert!(matches!(
            Video::create(folder.path().join("no/a.gif"), 1),
            Err(Error::Io { .. })
        ));
        drop(Video::create(&path, 1).unwrap());
        assert_eq!(names(&folder), [""; 0]);

        let mut writer = Video::create(&path, 1).unwrap();
        assert!(refused(writer.write(&Frame::new(0, 0).unwrap())));
        writer.write(&mixed[0]).unwrap();
        assert!(refused(writer.write(&mixed[1])));
        writer.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), {
            let mut video = Video::in_memory(VideoFormat::Gif, 1).unwrap();
            video.write(&mixed[0]).unwrap();
            video.into_bytes().unwrap()
        });
    }

    #[test]
    fn after_a_failure_there_is_no_file_and_every_call_fails() {
        let folder = TempDir::new().unwrap();
        let mut writer = Video::create(folder.path().join("a.gif"), 50).unwrap();
        writer.write(&Frame::new(2, 2).unwrap()).unwrap();
        // remove the folder, so that the final rename fails
        fs::remove_dir_all(folder.path()).unwrap();
        let completed = writer.complete().and_then(Output::commit);
        assert!(matches!(completed, Err(Error::Io { .. })));
        assert!(matches!(
            writer.write(&Frame::new(2, 2).unwrap()),
            Err(Error::Io { .. })
        ));
        assert!(matches!(writer.finish(), Err(Error::Io { .. })));
    }
}
