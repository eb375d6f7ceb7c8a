//! Animations as GIF, frame by frame, in bounded memory.
//!
//! The file is small, and its colours are exact as far as the format allows:
//! - Each image contains only the rectangle that changed. Its unchanged pixels are transparent or
//!   repeat their colours, whichever takes fewer bytes. An unchanged frame extends the previous
//!   one.
//! - All images share one table of 255 colours, which grows as colours appear. The table's
//!   place is at the start of the file; it is written last.
//! - An image has its own colour table if its new colours do not fit into the shared one. Only an
//!   image with more than 255 colours is reduced to similar colours.

use std::borrow::Cow;
use std::io::{self, Seek, SeekFrom, Write};
use std::ops::Range;

use gif::{Encoder, EncodingError, Repeat};
use gym_core::render::Frame;

use crate::changes::changed;
use crate::palette::{ENTRIES, Palette, Rgb, TRANSPARENT};

/// The offset of the shared colour table in the file, after the signature and the screen descriptor
/// (GIF89a specification, sections 17 and 18).
const TABLE_OFFSET: u64 = 13;
/// Delays are in hundredths of a second (GIF89a specification, section 23).
const TICKS_PER_SECOND: u64 = 100;
/// The shortest delay: browsers show an image with a shorter delay for 10 ticks.
const SHORTEST_DELAY: u64 = 2;

/// An animation that is being written, and that loops forever. Frames appear at their times,
/// rounded to hundredths of a second; rounding errors do not accumulate.
///
/// The last frame is not written until its duration is known.
pub(crate) struct Gif<W: Write + Seek> {
    encoder: Encoder<W>,
    palette: Palette,
    fps: u32,
    /// The number of frames so far.
    count: u64,
    /// The frame that is not written yet, and the tick at which it appears.
    pending: Frame,
    since: u64,
    /// The frame before `pending`; `None` before the first image.
    shown: Option<Frame>,
    /// Buffers for the rectangle that is being written.
    pixels: Vec<Option<Rgb>>,
    entries: Vec<u8>,
    opaque: Vec<u8>,
}

impl<W: Write + Seek> Gif<W> {
    pub(crate) fn start(writer: W, fps: u32, frame: &Frame) -> io::Result<Self> {
        let (width, height) = (frame.width() as u16, frame.height() as u16);
        let mut encoder =
            Encoder::new(writer, width, height, &[0; ENTRIES * 3]).map_err(io_error)?;
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
            opaque: Vec::new(),
        })
    }

    pub(crate) fn write(&mut self, frame: &Frame) -> io::Result<()> {
        let now = self.now();
        self.count += 1;
        if *frame == self.pending {
            return Ok(());
        }
        // otherwise the duration of `pending` would be too short: skip `pending`
        if now - self.since >= SHORTEST_DELAY {
            self.write_pending(now)?;
            match &mut self.shown {
                Some(shown) => std::mem::swap(shown, &mut self.pending),
                None => self.shown = Some(self.pending.clone()),
            }
            self.since = now;
        }
        self.pending.pixels_mut().copy_from_slice(frame.pixels());
        Ok(())
    }

    pub(crate) fn finish(mut self) -> io::Result<W> {
        self.write_pending(self.now().max(self.since + SHORTEST_DELAY))?;
        let mut writer = self.encoder.into_inner().map_err(io_error)?;
        writer.seek(SeekFrom::Start(TABLE_OFFSET))?;
        writer.write_all(self.palette.bytes())?;
        writer.flush()?;
        Ok(writer)
    }

    /// Returns the tick at which the next frame appears: the nearest to its exact time.
    fn now(&self) -> u64 {
        let fps = u64::from(self.fps);
        (self.count * TICKS_PER_SECOND + fps / 2) / fps
    }

    /// Writes `pending`, which is shown until the tick `until`.
    fn write_pending(&mut self, until: u64) -> io::Result<()> {
        let (columns, rows) = changed(self.shown.as_ref(), &self.pending);
        self.pixels.clear();
        gather(
            self.shown.as_ref(),
            &self.pending,
            columns.clone(),
            rows.clone(),
            &mut self.pixels,
        );
        let mut own = self.table();
        let mut picture = compressed(&self.entries);
        let mut filled = own.clone();
        let palette = filled.as_mut().unwrap_or(&mut self.palette);
        let colors = colors(&self.pending, columns.clone(), rows.clone());
        if palette.fill(&self.entries, colors, &mut self.opaque) {
            let opaque = compressed(&self.opaque);
            let size = |picture: &gif::Frame<'_>, own: &Option<Palette>| {
                picture.buffer.len() + own.as_ref().map_or(0, Palette::size)
            };
            if size(&opaque, &filled) < size(&picture, &own) {
                (picture, own) = (opaque, filled);
            }
        }
        (picture.left, picture.top) = (columns.start as u16, rows.start as u16);
        (picture.width, picture.height) = (columns.len() as u16, rows.len() as u16);
        picture.palette = own.map(|palette| palette.bytes().to_vec());
        let mut ticks = until - self.since;
        loop {
            picture.delay = u16::try_from(ticks).unwrap_or(u16::MAX);
            self.encoder
                .write_lzw_pre_encoded_frame(&picture)
                .map_err(io_error)?;
            ticks -= u64::from(picture.delay);
            if ticks == 0 {
                return Ok(());
            }
            // the rest of a delay that exceeds the format's limit: another image of one transparent
            // pixel
            picture = compressed(&[TRANSPARENT]);
            (picture.width, picture.height) = (1, 1);
        }
    }

    /// Translates `pixels` to `entries`; returns the image's own colour table if the image needs
    /// its own table.
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

impl<W: Write + Seek> std::fmt::Debug for Gif<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Gif")
            .field("fps", &self.fps)
            .field("count", &self.count)
            .finish_non_exhaustive()
    }
}

/// Returns a compressed image of the entries `entries`, without size and position.
fn compressed(entries: &[u8]) -> gif::Frame<'_> {
    let buffer = Cow::Borrowed(entries);
    let mut picture = gif::Frame {
        transparent: Some(TRANSPARENT),
        buffer,
        ..gif::Frame::default()
    };
    picture.make_lzw_pre_encoded();
    picture
}

/// Iterates over the colours in a rectangle, row by row.
fn colors(frame: &Frame, columns: Range<usize>, rows: Range<usize>) -> impl Iterator<Item = &Rgb> {
    let pixels = frame.pixels().as_chunks().0;
    let width = frame.width() as usize;
    rows.flat_map(move |y| &pixels[y * width..][columns.clone()])
}

/// Appends the pixels of a rectangle to `pixels`: `None` for each unchanged pixel.
fn gather(
    old: Option<&Frame>,
    new: &Frame,
    columns: Range<usize>,
    rows: Range<usize>,
    pixels: &mut Vec<Option<Rgb>>,
) {
    let news = colors(new, columns.clone(), rows.clone());
    match old {
        None => pixels.extend(news.copied().map(Some)),
        Some(old) => {
            let pairs = news.zip(colors(old, columns, rows));
            pixels.extend(pairs.map(|(new, old)| (new != old).then_some(*new)));
        }
    }
}

fn io_error(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;
    use std::io::Cursor;

    use gif::{ColorOutput, DecodeOptions, DisposalMethod};

    use super::*;

    use crate::testing::Full;

    /// A decoded image: its own properties, and the whole screen after it.
    struct Picture {
        delay: u16,
        /// Left, top, width, height.
        area: [u16; 4],
        own_table: bool,
        /// Whether the image has transparent pixels.
        transparent: bool,
        screen: Vec<u8>,
    }

    fn decode(bytes: &[u8]) -> Vec<Picture> {
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::Indexed);
        let mut decoder = options.read_info(Cursor::new(bytes)).unwrap();
        let shared = decoder.global_palette().unwrap().to_vec();
        let width = usize::from(decoder.width());
        let mut screen = vec![0; width * usize::from(decoder.height()) * 3];
        let mut pictures = Vec::new();
        while let Some(picture) = decoder.read_next_frame().unwrap() {
            assert_eq!(picture.dispose, DisposalMethod::Keep);
            let table = picture.palette.as_deref().unwrap_or(&shared);
            for (i, &entry) in picture.buffer.iter().enumerate() {
                if Some(entry) != picture.transparent {
                    let x = usize::from(picture.left) + i % usize::from(picture.width);
                    let y = usize::from(picture.top) + i / usize::from(picture.width);
                    let color = &table[usize::from(entry) * 3..][..3];
                    screen[(y * width + x) * 3..][..3].copy_from_slice(color);
                }
            }
            pictures.push(Picture {
                delay: picture.delay,
                area: [picture.left, picture.top, picture.width, picture.height],
                own_table: picture.palette.is_some(),
                transparent: picture
                    .buffer
                    .iter()
                    .any(|&entry| Some(entry) == picture.transparent),
                screen: screen.clone(),
            });
        }
        assert_eq!(decoder.repeat(), Repeat::Infinite);
        pictures
    }

    fn encode(fps: u32, frames: &[Frame]) -> Vec<u8> {
        let mut gif = Gif::start(Cursor::new(Vec::new()), fps, &frames[0]).unwrap();
        frames[1..]
            .iter()
            .for_each(|frame| gif.write(frame).unwrap());
        gif.finish().unwrap().into_inner()
    }

    fn delays(pictures: &[Picture]) -> Vec<u16> {
        pictures.iter().map(|picture| picture.delay).collect()
    }

    /// Returns a frame of this size with `color` at each position.
    fn frame(width: u32, height: u32, color: impl Fn(u32, u32) -> Rgb) -> Frame {
        let mut frame = Frame::new(width, height).unwrap();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        for (pixel, (x, y)) in frame.pixels_mut().chunks_exact_mut(3).zip(places) {
            pixel.copy_from_slice(&color(x, y));
        }
        frame
    }

    /// A square that moves over a background of several colours, with a new colour in each frame.
    fn moving(count: u32) -> Vec<Frame> {
        let color = |step: u32, x: u32, y: u32| match (x.wrapping_sub(step), y.wrapping_sub(3)) {
            (0..4, 0..4) => [255, step as u8, 0],
            _ => [0, (x / 5) as u8, (y / 5) as u8],
        };
        (0..count)
            .map(|step| frame(60, 10, |x, y| color(step, x, y)))
            .collect()
    }

    #[test]
    fn frames_come_back_exactly_from_the_rectangles_that_changed() {
        let frames = moving(40);
        let bytes = encode(50, &frames);
        let pictures = decode(&bytes);
        assert_eq!(pictures.len(), frames.len());
        for (picture, frame) in pictures.iter().zip(&frames) {
            assert_eq!(picture.screen, frame.pixels());
            assert_eq!((picture.delay, picture.own_table), (2, false));
        }
        assert_eq!(pictures[0].area, [0, 0, 60, 10]);
        assert_eq!(pictures[1].area, [0, 3, 5, 4]);
        assert_eq!(pictures[9].area, [8, 3, 5, 4]);
        assert_eq!(
            bytes,
            encode(50, &frames),
            "the same frames give the same file"
        );
    }

    /// Viewers show a frame of less than two hundredths of a second for a tenth of a second.
    #[test]
    fn the_last_frame_is_not_too_short() {
        let frames: Vec<_> = (0..4)
            .map(|red| frame(2, 2, move |_, _| [red, 0, 0]))
            .collect();
        for (fps, count) in [(1000, 1), (1000, 4), (100, 3), (60, 4), (50, 4), (10, 2)] {
            let pictures = decode(&encode(fps, &frames[..count]));
            let delays: Vec<_> = pictures
                .iter()
                .map(|picture| u64::from(picture.delay))
                .collect();
            assert!(
                delays.iter().all(|delay| *delay >= SHORTEST_DELAY),
                "{fps}, {count}: {delays:?}"
            );
            // the duration of the frames, rounded to hundredths, plus at most the shortest delay
            let whole = (100 * count as u64).div_ceil(u64::from(fps));
            let sum: u64 = delays.iter().sum();
            assert!(
                sum.abs_diff(whole) <= SHORTEST_DELAY,
                "{fps}, {count}: {delays:?}"
            );
        }
    }

    #[test]
    fn the_shared_table_holds_the_colours_in_order_and_no_others() {
        let frames = [
            frame(2, 1, |x, _| [x as u8, 9, 9]),
            frame(2, 1, |_, _| [7, 7, 7]),
        ];
        let bytes = encode(10, &frames);
        let table = &bytes[TABLE_OFFSET as usize..][..ENTRIES * 3];
        assert_eq!(table[..12], [0, 0, 0, 0, 9, 9, 1, 9, 9, 7, 7, 7]);
        assert!(table[12..].iter().all(|&byte| byte == 0));
    }

    #[test]
    fn pictures_bring_their_own_table_when_the_shared_one_is_full() {
        let ramp = |green: u8| frame(16, 10, move |x, y| [(y * 16 + x) as u8, green, 0]);
        let frames = [ramp(0), ramp(1), ramp(0)];
        let pictures = decode(&encode(10, &frames));
        let own: Vec<bool> = pictures.iter().map(|picture| picture.own_table).collect();
        assert_eq!(own, [false, true, false]);
        pictures
            .iter()
            .zip(&frames)
            .for_each(|(picture, frame)| assert_eq!(picture.screen, frame.pixels()));
    }

    #[test]
    fn unchanged_pixels_are_whatever_takes_fewer_bytes() {
        let noise = |x: u32, y: u32| (x * x + 3 * y * y + x * y).is_multiple_of(3);
        let plain = |shade| frame(40, 40, move |_, _| [shade; 3]);
        // the last images have their own colour tables, because each has 251 colours
        let ramp = |x: u32, y: u32, other: u8| {
            if y < 7 {
                [(y * 40 + x).min(251) as u8, other, 0]
            } else {
                [9; 3]
            }
        };
        let noisy = frame(40, 40, |x, y| [if noise(x, y) { 9 } else { 8 }; 3]);
        let frames = [
            noisy.clone(),
            plain(9), // compresses to a single run
            frame(40, 40, |x, y| if x == y { [8; 3] } else { [9; 3] }),
            frame(40, 40, |x, y| ramp(x, y, 1)),
            frame(
                40,
                40,
                |x, y| if noise(x, y) { [9; 3] } else { ramp(x, y, 2) },
            ),
            frame(40, 40, |x, y| ramp(x, y, 2)),
        ];
        let pictures = decode(&encode(10, &frames));
        pictures
            .iter()
            .zip(&frames)
            .for_each(|(picture, frame)| assert_eq!(picture.screen, frame.pixels()));
        let seen: Vec<_> = pictures
            .iter()
            .map(|picture| (picture.own_table, picture.transparent))
            .collect();
        let expected = [
            (false, false),
            (false, false),
            (false, true),
            (false, false),
            (true, false),
            (true, true),
        ];
        assert_eq!(seen, expected);
    }

    #[test]
    fn more_than_255_colours_are_reduced_to_similar_ones() {
        let frames = [frame(64, 64, |x, y| [(x * 4) as u8, (y * 4) as u8, 128])];
        let pictures = decode(&encode(10, &frames));
        let screen = &pictures[0].screen;
        assert!(screen.chunks_exact(3).collect::<HashSet<_>>().len() <= 255);
        let differences = screen
            .iter()
            .zip(frames[0].pixels())
            .map(|(a, b)| u64::from(a.abs_diff(*b)));
        let mean = differences.sum::<u64>() as f64 / screen.len() as f64;
        assert!(mean < 8.0, "{mean}");
    }

    #[test]
    fn times_are_true_on_average() {
        let frames = moving(31);
        assert_eq!(
            delays(&decode(&encode(30, &frames[..6]))),
            [3, 4, 3, 3, 4, 3]
        );
        let total = |fps| {
            delays(&decode(&encode(fps, &frames[..30])))
                .iter()
                .map(|&delay| u64::from(delay))
                .sum::<u64>()
        };
        assert_eq!([30, 24, 7, 1].map(total), [100, 125, 429, 3000]);
    }

    #[test]
    fn above_50_frames_per_second_some_are_left_out() {
        let frames = moving(60);
        let pictures = decode(&encode(60, &frames));
        let delays = delays(&pictures);
        assert!(delays.iter().all(|&delay| delay >= 2), "{delays:?}");
        assert_eq!(delays.iter().sum::<u16>(), 100);
        assert_eq!(pictures.last().unwrap().screen, frames[59].pixels());
        let shown = |picture: &Picture| frames.iter().any(|frame| frame.pixels() == picture.screen);
        assert!(pictures.iter().all(shown));
    }

    #[test]
    fn a_frame_that_changes_nothing_prolongs_the_one_before() {
        let [a, b] = [0, 9].map(|red| frame(3, 3, |_, _| [red, 0, 0]));
        let run = [
            a.clone(),
            a.clone(),
            a.clone(),
            b.clone(),
            b.clone(),
            a.clone(),
        ];
        assert_eq!(delays(&decode(&encode(20, &run))), [15, 10, 5]);
        // a change that is reverted before the change is visible
        assert_eq!(
            delays(&decode(&encode(100, &[a.clone(), a.clone(), b, a]))),
            [2, 2]
        );
    }

    #[test]
    fn long_times_are_split() {
        let still = frame(2, 2, |_, _| [1, 2, 3]);
        let pictures = decode(&encode(1, &vec![still; 700]));
        assert_eq!(delays(&pictures), [65535, 4465], "70000 in all");
        assert_eq!(pictures[1].area, [0, 0, 1, 1]);
        assert_eq!(pictures[1].screen, [1, 2, 3].repeat(4));
    }

    #[test]
    fn a_full_disk_is_an_error_wherever_it_strikes() {
        let frames = moving(20);
        let size = encode(50, &frames).len();
        let write = |room: usize| {
            let writer = Full::new(room);
            let mut animation = Gif::start(writer, 50, &frames[0])?;
            frames[1..]
                .iter()
                .try_for_each(|frame| animation.write(frame))?;
            animation.finish().map(|_| ())
        };
        for room in 0..size {
            assert_eq!(
                write(room).unwrap_err().kind(),
                io::ErrorKind::StorageFull,
                "{room}"
            );
        }
        write(size).unwrap();
    }
}
