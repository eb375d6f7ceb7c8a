//! Animations as GIF files, frame by frame, in bounded memory.
//!
//! The file stays small and its colours exact as far as the format allows:
//! - Each picture holds only the rectangle that changed, and in it only the pixels that changed;
//!   the rest is transparent. A frame that changes nothing prolongs the one before.
//! - All pictures share one table of 255 colours, which grows with the colours that appear. It
//!   stands at the start of the file and is written last.
//! - A picture whose new colours no longer fit brings a table of its own, and only one that has
//!   more than 255 colours itself is reduced to similar ones.

use std::borrow::Cow;
use std::io::{self, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use gif::{Encoder, EncodingError, Repeat};
use gym_core::render::Frame;
use gym_core::{Error, Result};

use crate::atomic::AtomicFile;
use crate::palette::{ENTRIES, Palette, Rgb, TRANSPARENT};

/// Where the shared colour table lies in the file: behind signature and screen descriptor (GIF89a
/// specification, sections 17 and 18).
const TABLE_OFFSET: u64 = 13;
/// Time is counted in hundredths of a second (GIF89a specification, section 23).
const TICKS_PER_SECOND: u64 = 100;
/// Browsers show a picture with a shorter delay for 10 ticks.
const SHORTEST_DELAY: u64 = 2;

/// Writes an animation that loops for ever.
///
/// Frames are shown at their true times, rounded to hundredths of a second; rounding errors do
/// not add up. Above 50 frames per second some frames are left out, since viewers do not show
/// pictures for less than two hundredths.
///
/// The file appears under its name when it is finished. Dropping the writer finishes it too if a
/// frame was written, but cannot report errors.
#[derive(Debug)]
pub struct GifWriter {
    path: PathBuf,
    fps: u32,
    state: State,
}

#[derive(Debug)]
enum State {
    /// No frame yet.
    Created(AtomicFile),
    Running(Box<Animation<AtomicFile>>),
    /// Finished, or failed.
    Over,
}

impl GifWriter {
    /// Starts a file of that many frames per second.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for 0 frames per second, [`Error::Io`] if the file cannot be
    /// created.
    pub fn create(path: impl AsRef<Path>, fps: u32) -> Result<Self> {
        if fps == 0 {
            return Err(Error::argument("GifWriter", "fps is 0: give the frames per second, 1 or more"));
        }
        let path = path.as_ref().to_owned();
        let state = State::Created(AtomicFile::create(&path)?);
        Ok(Self { path, fps, state })
    }

    /// Appends a frame.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a frame that is empty, larger than 65535 pixels a side, or
    /// of another size than the first; it is left out. [`Error::Io`] if writing fails; the file is
    /// then removed, and every later call fails.
    pub fn write(&mut self, frame: &Frame) -> Result<()> {
        let result = match std::mem::replace(&mut self.state, State::Over) {
            State::Created(file) => match screen_size(frame) {
                Ok(size) => Animation::start(file, size, self.fps, frame)
                    .map(|animation| State::Running(Box::new(animation))),
                Err(error) => {
                    self.state = State::Created(file);
                    return Err(error);
                }
            },
            State::Running(mut animation) => {
                if let Err(error) = animation.check(frame) {
                    self.state = State::Running(animation);
                    return Err(error);
                }
                animation.write(frame).map(|()| State::Running(animation))
            }
            State::Over => Err(io::Error::other("writing this file failed before")),
        };
        self.state = result.map_err(|error| Error::io(&self.path, error))?;
        Ok(())
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails, now or before; [`Error::InvalidArgument`] if no frame was
    /// written. There is no file then.
    pub fn finish(mut self) -> Result<()> {
        self.end()
    }

    fn end(&mut self) -> Result<()> {
        match std::mem::replace(&mut self.state, State::Over) {
            State::Created(_) => {
                Err(Error::argument("GifWriter", "no frame was written: write one before `finish`"))
            }
            State::Running(animation) => {
                animation.finish().map_err(|error| Error::io(&self.path, error))?.commit()
            }
            State::Over => Err(Error::io(&self.path, io::Error::other("writing this file failed before"))),
        }
    }
}

impl Drop for GifWriter {
    fn drop(&mut self) {
        if let State::Running(_) = self.state {
            // There is no one to tell.
            let _ = self.end();
        }
    }
}

/// Writes all frames to a GIF file; see [`GifWriter`].
///
/// # Errors
/// As those of [`GifWriter`]; there is no file then.
pub fn write_gif(path: impl AsRef<Path>, fps: u32, frames: &[Frame]) -> Result<()> {
    let mut writer = GifWriter::create(path, fps)?;
    if let Err(error) = frames.iter().try_for_each(|frame| writer.write(frame)) {
        writer.state = State::Over;
        return Err(error);
    }
    writer.finish()
}

/// Width and height of an animation that starts with this frame.
fn screen_size(frame: &Frame) -> Result<(u16, u16)> {
    match (u16::try_from(frame.width()), u16::try_from(frame.height())) {
        (Ok(width), Ok(height)) if width > 0 && height > 0 => Ok((width, height)),
        _ => Err(Error::argument(
            "GifWriter",
            format!("{frame:?} does not fit: a GIF is 1 to 65535 pixels wide and high"),
        )),
    }
}

/// An animation being written. The last frame is held back until its duration is known.
struct Animation<W: Write + Seek> {
    encoder: Encoder<W>,
    palette: Palette,
    fps: u32,
    /// Frames so far.
    count: u64,
    /// The frame held back, and the tick at which it appears.
    pending: Frame,
    since: u64,
    /// What is on the screen before it; `None` before the first picture.
    shown: Option<Frame>,
    /// Buffers for the rectangle being written.
    pixels: Vec<Option<Rgb>>,
    entries: Vec<u8>,
}

impl<W: Write + Seek> Animation<W> {
    fn start(writer: W, (width, height): (u16, u16), fps: u32, frame: &Frame) -> io::Result<Self> {
        let mut encoder = Encoder::new(writer, width, height, &[0; ENTRIES * 3]).map_err(io_error)?;
        encoder.set_repeat(Repeat::Infinite).map_err(io_error)?;
        Ok(Self {
            encoder,
            palette: Palette::new(),
            fps,
            count: 1,
            pending: frame.clone(),
            since: 0,
            shown: None,
            pixels: Vec::new(),
            entries: Vec::new(),
        })
    }

    /// Whether the frame has the size of the animation.
    fn check(&self, frame: &Frame) -> Result<()> {
        if (frame.width(), frame.height()) == (self.pending.width(), self.pending.height()) {
            return Ok(());
        }
        let reason = format!("{frame:?} cannot follow {:?}: all frames must have one size", self.pending);
        Err(Error::argument("GifWriter", reason))
    }

    fn write(&mut self, frame: &Frame) -> io::Result<()> {
        let now = self.now();
        self.count += 1;
        if *frame == self.pending {
            return Ok(());
        }
        // Otherwise the frame held back would be too short: this one takes its place.
        if now - self.since >= SHORTEST_DELAY {
            self.flush(now)?;
            match &mut self.shown {
                Some(shown) => std::mem::swap(shown, &mut self.pending),
                None => self.shown = Some(self.pending.clone()),
            }
            self.since = now;
        }
        self.pending.pixels_mut().copy_from_slice(frame.pixels());
        Ok(())
    }

    fn finish(mut self) -> io::Result<W> {
        self.flush(self.now().max(self.since + SHORTEST_DELAY))?;
        let mut writer = self.encoder.into_inner().map_err(io_error)?;
        writer.seek(SeekFrom::Start(TABLE_OFFSET))?;
        writer.write_all(self.palette.bytes())?;
        writer.flush()?;
        Ok(writer)
    }

    /// The tick at which the next frame appears: the nearest to its true time.
    fn now(&self) -> u64 {
        let fps = u64::from(self.fps);
        (self.count * TICKS_PER_SECOND + fps / 2) / fps
    }

    /// Writes the frame held back, to be shown until that tick.
    fn flush(&mut self, until: u64) -> io::Result<()> {
        let (columns, rows) = changed(self.shown.as_ref(), &self.pending);
        self.pixels.clear();
        gather(self.shown.as_ref(), &self.pending, columns.clone(), rows.clone(), &mut self.pixels);
        let palette = self.table().map(|palette| palette.bytes().to_vec());
        let mut picture = gif::Frame {
            transparent: Some(TRANSPARENT),
            left: columns.start as u16,
            top: rows.start as u16,
            width: columns.len() as u16,
            height: rows.len() as u16,
            palette,
            buffer: Cow::Borrowed(&self.entries),
            ..gif::Frame::default()
        };
        let mut ticks = until - self.since;
        loop {
            picture.delay = u16::try_from(ticks).unwrap_or(u16::MAX);
            self.encoder.write_frame(&picture).map_err(io_error)?;
            ticks -= u64::from(picture.delay);
            if ticks == 0 {
                return Ok(());
            }
            // Longer than a delay can be: a transparent pixel follows.
            let dot =
                gif::Frame { transparent: Some(TRANSPARENT), width: 1, height: 1, ..gif::Frame::default() };
            picture = gif::Frame { buffer: Cow::Borrowed(&[TRANSPARENT]), ..dot };
        }
    }

    /// Translates `pixels` into `entries`, and returns the table if it is not the shared one.
    fn table(&mut self) -> Option<Palette> {
        if self.palette.translate(&self.pixels, &mut self.entries) {
            return None;
        }
        let mut own = Palette::new();
        if !own.translate(&self.pixels, &mut self.entries) {
            own = Palette::reduce(&self.pixels, &mut self.entries);
        }
        Some(own)
    }
}

impl<W: Write + Seek> std::fmt::Debug for Animation<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Animation")
            .field("fps", &self.fps)
            .field("count", &self.count)
            .finish_non_exhaustive()
    }
}

/// The smallest rectangle that holds every changed pixel; one pixel if none changed.
fn changed(old: Option<&Frame>, new: &Frame) -> (Range<usize>, Range<usize>) {
    let Some(old) = old else { return (0..new.width() as usize, 0..new.height() as usize) };
    let row = new.width() as usize * 3;
    let (mut columns, mut rows) = (row..0, 0..0);
    for (y, (old, new)) in old.pixels().chunks_exact(row).zip(new.pixels().chunks_exact(row)).enumerate() {
        if old == new {
            continue;
        }
        rows = if rows.is_empty() { y..y + 1 } else { rows.start..y + 1 };
        let differs = |(old, new): (&u8, &u8)| old != new;
        let before = old[..columns.start].iter().zip(&new[..columns.start]).position(differs);
        columns.start = before.unwrap_or(columns.start);
        let after = old[columns.end..].iter().zip(&new[columns.end..]).rposition(differs);
        columns.end += after.map_or(0, |distance| distance + 1);
    }
    if rows.is_empty() { (0..1, 0..1) } else { (columns.start / 3..columns.end.div_ceil(3), rows) }
}

/// Appends the pixels of a rectangle, `None` for those that did not change.
fn gather(
    old: Option<&Frame>,
    new: &Frame,
    columns: Range<usize>,
    rows: Range<usize>,
    pixels: &mut Vec<Option<Rgb>>,
) {
    let width = new.width() as usize;
    for y in rows {
        let range = (y * width + columns.start) * 3..(y * width + columns.end) * 3;
        let new = new.pixels()[range.clone()].as_chunks().0;
        match old {
            None => pixels.extend(new.iter().copied().map(Some)),
            Some(old) => {
                let old: &[Rgb] = old.pixels()[range].as_chunks().0;
                pixels.extend(new.iter().zip(old).map(|(new, old)| (new != old).then_some(*new)));
            }
        }
    }
}

fn io_error(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        other => io::Error::other(other),
    }
}
