//! Animated PNG, frame by frame, in bounded memory and with exact colours.
//!
//! Each image contains only the rectangle that changed. The crate `png` compresses the rectangle.
//! This module writes the chunks itself, because the file starts with the number of images, which
//! is known only at the end. The chunks are those of the PNG specification, third edition, section
//! 11.3.6 (acTL, fcTL, fdAT).

use std::io::{self, Seek, SeekFrom, Write};

use gym_core::render::Frame;
use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, Filter};

use crate::changes::changed;

const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";
/// Bytes of a chunk besides its data: length, kind and checksum.
const CHUNK: u64 = 12;
/// Bytes of data in an IHDR chunk.
const HEADER: u64 = 13;

/// An animation that is being written. The last frame is not written until its duration is known.
#[derive(Debug)]
pub(crate) struct Apng<W> {
    writer: W,
    fps: u32,
    /// The numbers of images and of animation chunks so far.
    pictures: u32,
    sequence: u32,
    /// The frame that is not written yet, and the number of frames that it lasts.
    pending: Frame,
    repeats: u32,
    /// The frame before `pending`; `None` before the first image.
    shown: Option<Frame>,
    /// Buffers for the rectangle that is being written: its pixels, and a PNG file of it.
    pixels: Vec<u8>,
    file: Vec<u8>,
}

impl<W: Write + Seek> Apng<W> {
    pub(crate) fn start(writer: W, fps: u32, frame: &Frame) -> io::Result<Self> {
        let mut apng = Self {
            writer,
            fps,
            pictures: 0,
            sequence: 0,
            pending: frame.clone(),
            repeats: 1,
            shown: None,
            pixels: Vec::new(),
            file: Vec::new(),
        };
        apng.writer.write_all(&SIGNATURE)?;
        let [width, height] = [frame.width(), frame.height()].map(u32::to_be_bytes);
        // 8 bits of red, green and blue; standard compression and filters; not interlaced
        chunk(
            &mut apng.writer,
            *b"IHDR",
            &[&width, &height, &[8, 2, 0, 0, 0]],
        )?;
        apng.write_count()?;
        Ok(apng)
    }

    pub(crate) fn write(&mut self, frame: &Frame) -> io::Result<()> {
        // durations are 16-bit numbers
        if *frame == self.pending && self.repeats < u32::from(u16::MAX) {
            self.repeats += 1;
            return Ok(());
        }
        self.write_pending()?;
        match &mut self.shown {
            Some(shown) => std::mem::swap(shown, &mut self.pending),
            None => self.shown = Some(self.pending.clone()),
        }
        self.pending.pixels_mut().copy_from_slice(frame.pixels());
        self.repeats = 1;
        Ok(())
    }

    pub(crate) fn finish(mut self) -> io::Result<W> {
        self.write_pending()?;
        chunk(&mut self.writer, *b"IEND", &[])?;
        self.writer
            .seek(SeekFrom::Start(SIGNATURE.len() as u64 + CHUNK + HEADER))?;
        self.write_count()?;
        self.writer.flush()?;
        Ok(self.writer)
    }

    /// Writes the chunk with the number of images, which loop forever.
    fn write_count(&mut self) -> io::Result<()> {
        chunk(
            &mut self.writer,
            *b"acTL",
            &[&self.pictures.to_be_bytes(), &[0; 4]],
        )
    }

    fn write_pending(&mut self) -> io::Result<()> {
        let (columns, rows) = changed(self.shown.as_ref(), &self.pending);
        self.pixels.clear();
        let row = self.pending.width() as usize * 3;
        for y in rows.clone() {
            let (start, end) = (y * row + columns.start * 3, y * row + columns.end * 3);
            self.pixels
                .extend_from_slice(&self.pending.pixels()[start..end]);
        }
        let (width, height) = (columns.len() as u32, rows.len() as u32);
        self.file.clear();
        compress(&mut self.file, width, height, &self.pixels)?;

        let place = [width, height, columns.start as u32, rows.start as u32].map(u32::to_be_bytes);
        let delay = [self.repeats as u16, self.fps as u16].map(u16::to_be_bytes);
        // disposal operation 0: keep the image; blend operation 0: overwrite the old content
        let parts: [&[u8]; 4] = [
            &self.sequence.to_be_bytes(),
            place.as_flattened(),
            delay.as_flattened(),
            &[0, 0],
        ];
        chunk(&mut self.writer, *b"fcTL", &parts)?;
        self.sequence += 1;
        for data in image_data(&self.file) {
            if self.pictures == 0 {
                chunk(&mut self.writer, *b"IDAT", &[data])?;
            } else {
                chunk(
                    &mut self.writer,
                    *b"fdAT",
                    &[&self.sequence.to_be_bytes(), data],
                )?;
                self.sequence += 1;
            }
        }
        self.pictures += 1;
        Ok(())
    }
}

/// Compresses an image to a PNG file.
fn compress(file: &mut Vec<u8>, width: u32, height: u32, pixels: &[u8]) -> io::Result<()> {
    let mut encoder = Encoder::new(file, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Balanced);
    // drawings have large areas of one colour, which compress best without a filter
    encoder.set_filter(Filter::NoFilter);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(pixels)?;
        writer.finish()
    });
    written.map_err(|error| match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    })
}

/// Iterates over the contents of the IDAT chunks of a PNG file.
fn image_data(file: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = file.get(SIGNATURE.len()..).unwrap_or_default();
    let chunks = std::iter::from_fn(move || {
        let (length, after) = rest.split_first_chunk()?;
        let (kind, after) = after.split_first_chunk::<4>()?;
        let (data, after) = after.split_at_checked(u32::from_be_bytes(*length) as usize)?;
        rest = after.get(4..)?;
        Some((kind, data))
    });
    chunks.filter_map(|(kind, data)| (kind == b"IDAT").then_some(data))
}

/// Writes a chunk whose data consists of `parts`.
fn chunk(writer: &mut impl Write, kind: [u8; 4], parts: &[&[u8]]) -> io::Result<()> {
    let length: usize = parts.iter().map(|part| part.len()).sum();
    writer.write_all(&(length as u32).to_be_bytes())?;
    let mut checksum = crc32fast::Hasher::new();
    for part in [kind.as_slice()].iter().chain(parts) {
        checksum.update(part);
        writer.write_all(part)?;
    }
    writer.write_all(&checksum.finalize().to_be_bytes())
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::testing::Full;

    fn plain(shade: u8) -> Frame {
        let mut frame = Frame::new(5, 4).unwrap();
        frame.pixels_mut().fill(shade);
        frame
    }

    fn encode(fps: u32, frames: &[Frame]) -> Vec<u8> {
        let mut apng = Apng::start(Cursor::new(Vec::new()), fps, &frames[0]).unwrap();
        frames[1..]
            .iter()
            .for_each(|frame| apng.write(frame).unwrap());
        apng.finish().unwrap().into_inner()
    }

    /// The duration, the area (left, top, width, height) and the pixels of an image.
    type Picture = ((u16, u16), [u32; 4], Vec<u8>);

    fn decode(bytes: &[u8]) -> Vec<Picture> {
        let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        let control = reader.info().animation_control().copied().unwrap();
        assert_eq!(control.num_plays, 0);
        let picture = |_| {
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut pixels).unwrap();
            pixels.truncate(info.buffer_size());
            let control = *reader.info().frame_control().unwrap();
            let area = [
                control.x_offset,
                control.y_offset,
                control.width,
                control.height,
            ];
            ((control.delay_num, control.delay_den), area, pixels)
        };
        (0..control.num_frames).map(picture).collect()
    }

    #[test]
    fn pictures_hold_what_changed_for_as_long_as_it_lasts() {
        let [a, mut b] = [10, 10].map(plain);
        b.pixels_mut()[(2 * 5 + 3) * 3..][..6].fill(99);
        let pictures = decode(&encode(50, &[a.clone(), a.clone(), b.clone(), a.clone()]));
        assert_eq!(
            pictures,
            [
                ((2, 50), [0, 0, 5, 4], a.pixels().to_vec()),
                ((1, 50), [3, 2, 2, 1], vec![99; 6]),
                ((1, 50), [3, 2, 2, 1], vec![10; 6]),
            ]
        );
    }

    #[test]
    fn a_single_frame_is_an_animation_too() {
        assert_eq!(
            decode(&encode(1, &[plain(7)])),
            [((1, 1), [0, 0, 5, 4], vec![7; 60])]
        );
    }

    #[test]
    fn a_full_disk_is_an_error_wherever_it_strikes() {
        let frames = [plain(1), plain(2), plain(3)];
        let size = encode(50, &frames).len();
        let write = |room: usize| {
            let mut apng = Apng::start(Full::new(room), 50, &frames[0])?;
            frames[1..].iter().try_for_each(|frame| apng.write(frame))?;
            apng.finish().map(|_| ())
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

    #[test]
    fn long_times_are_split() {
        let pictures = decode(&encode(1, &vec![plain(7); 70_000]));
        let times: Vec<_> = pictures.iter().map(|(time, ..)| time.0).collect();
        assert_eq!(times, [65535, 4465]);
    }
}
