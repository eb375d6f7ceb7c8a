//! Frames as PNG files, and many frames in one image.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::file::AtomicFile;
use gym_core::canvas::{Color, Image};
use gym_core::render::Frame;
use gym_core::{Error, Result};
use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};

/// Pixels between and around the frames of a contact sheet.
const GAP: u32 = 4;
/// The gray level between the frames of a contact sheet.
const BACKGROUND: u8 = 232;

/// Writes a frame to a PNG file.
///
/// # Errors
/// [`Error::InvalidArgument`] for a frame without pixels, [`Error::Io`] if the file cannot be
/// written.
pub fn write_png(path: impl AsRef<Path>, frame: &Frame) -> Result<()> {
    let path = path.as_ref();
    let mut file = AtomicFile::create(path)?;
    encode(&mut file, frame).map_err(|error| match error {
        EncodingError::IoError(error) => Error::io(path, error),
        other => refused(frame, &other),
    })?;
    file.commit()
}

/// Writes `frames` below each other to one PNG file; the iterator draws each frame only when it is
/// needed. `size` is the common width of the frames and the sum of their heights.
///
/// # Errors
/// The errors of [`write_png`], and those of `frames`.
pub(crate) fn write_stack(
    path: &Path,
    size: (u32, u32),
    frames: impl Iterator<Item = Result<Frame>>,
) -> Result<()> {
    let refused = |error| match error {
        EncodingError::IoError(error) => Error::io(path, error),
        other => {
            let (width, height) = size;
            let reason = format!("{width}x{height} pixels cannot be written as PNG: {other}");
            Error::argument("write_png", reason)
        }
    };
    let mut file = AtomicFile::create(path)?;
    let mut encoder = Encoder::new(&mut file, size.0, size.1);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    // the fast compression suffices for large areas of one colour
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header().map_err(refused)?;
    let mut rows = writer.stream_writer().map_err(refused)?;
    for frame in frames {
        rows.write_all(frame?.pixels())
            .map_err(|error| Error::io(path, error))?;
    }
    rows.finish().map_err(refused)?;
    writer.finish().map_err(refused)?;
    file.commit()
}

/// Encodes a frame as PNG.
pub(crate) fn bytes(frame: &Frame) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode(&mut bytes, frame).map_err(|error| refused(frame, &error))?;
    Ok(bytes)
}

/// Encodes an image with opacity as PNG.
pub(crate) fn image_bytes(image: Image<'_>) -> std::result::Result<Vec<u8>, EncodingError> {
    let pixels = image.rows().flatten();
    let pixels: Vec<u8> = pixels
        .flat_map(|&Color { r, g, b, a }| [r, g, b, a])
        .collect();
    let side = |pixels: usize| u32::try_from(pixels).unwrap_or(u32::MAX);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, side(image.width), side(image.rows().len()));
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(bytes)
}

fn encode(writer: impl Write, frame: &Frame) -> std::result::Result<(), EncodingError> {
    let mut encoder = Encoder::new(writer, frame.width(), frame.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(frame.pixels())?;
    writer.finish()
}

fn refused(frame: &Frame, error: &EncodingError) -> Error {
    Error::argument(
        "write_png",
        format!("{frame:?} cannot be written as PNG: {error}"),
    )
}

/// Writes frames to `frame-0000.png`, `frame-0001.png` and so on in a folder, which is created if
/// it does not exist. Returns the paths.
///
/// # Errors
/// The errors of [`write_png`]; earlier frames remain.
pub fn write_png_sequence<'a>(
    folder: impl AsRef<Path>,
    frames: impl IntoIterator<Item = &'a Frame>,
) -> Result<Vec<PathBuf>> {
    let folder = folder.as_ref();
    fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
    let write = |(index, frame)| {
        let path = folder.join(format!("frame-{index:04}.png"));
        write_png(&path, frame).map(|()| path)
    };
    frames.into_iter().enumerate().map(write).collect()
}

/// Puts frames into one image, row by row, with `columns` frames per row (at least one). A frame
/// smaller than the largest is centred in its cell.
///
/// # Errors
/// [`Error::Custom`] if the image does not fit in memory.
pub fn contact_sheet(frames: &[Frame], columns: usize) -> Result<Frame> {
    tile(frames, columns, GAP)
}

/// Like [`contact_sheet`], with a gap of `gap` pixels around each frame.
pub(crate) fn tile(frames: &[Frame], columns: usize, gap: u32) -> Result<Frame> {
    let columns = columns.clamp(1, frames.len().max(1));
    let rows = frames.len().div_ceil(columns);
    let width = frames.iter().map(Frame::width).max().unwrap_or(0);
    let height = frames.iter().map(Frame::height).max().unwrap_or(0);
    let (cell_width, cell_height) = (gap + width, gap + height);
    // (a side that overflows becomes `u32::MAX`, which [`Frame::new`] refuses)
    let side = |cells: usize, cell| {
        u32::try_from(cells).map_or(u32::MAX, |n| n.saturating_mul(cell).saturating_add(gap))
    };
    let mut sheet = Frame::new(side(columns, cell_width), side(rows, cell_height))?;
    let columns = columns as u32;
    sheet.pixels_mut().fill(BACKGROUND);
    let sheet_row = sheet.width() as usize * 3;
    for (index, frame) in (0..).zip(frames) {
        let left = gap + index % columns * cell_width + (width - frame.width()) / 2;
        let top = gap + index / columns * cell_height + (height - frame.height()) / 2;
        let row = frame.width() as usize * 3;
        for (y, pixels) in frame.pixels().chunks_exact(row.max(1)).enumerate() {
            sheet.pixels_mut()[(top as usize + y) * sheet_row + left as usize * 3..][..row]
                .copy_from_slice(pixels);
        }
    }
    Ok(sheet)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    use crate::testing::names;

    fn plain(width: u32, height: u32, shade: u8) -> Frame {
        let mut frame = Frame::new(width, height).unwrap();
        frame.pixels_mut().fill(shade);
        frame
    }

    fn read(path: &Path) -> (u32, u32, Vec<u8>) {
        let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(path).unwrap()));
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!(
            (info.color_type, info.bit_depth),
            (ColorType::Rgb, BitDepth::Eight)
        );
        (info.width, info.height, pixels)
    }

    #[test]
    fn a_sequence_reads_back() {
        let folder = TempDir::new().unwrap();
        let mut frames = [plain(5, 3, 7), plain(2, 2, 200)];
        frames[0].pixels_mut()[4] = 99;
        let paths = write_png_sequence(folder.path().join("run"), &frames).unwrap();
        assert!(paths[1].ends_with("run/frame-0001.png"));
        for (path, frame) in paths.iter().zip(&frames) {
            assert_eq!(
                read(path),
                (frame.width(), frame.height(), frame.pixels().to_vec())
            );
        }
        assert_eq!(names(&folder), ["run"]);
    }

    #[test]
    fn a_frame_without_pixels_is_refused_and_leaves_nothing() {
        let folder = TempDir::new().unwrap();
        let error = write_png(folder.path().join("a.png"), &Frame::new(0, 3).unwrap()).unwrap_err();
        assert!(matches!(error, Error::InvalidArgument { .. }), "{error}");
        assert!(matches!(
            write_png(folder.path().join("no/a.png"), &plain(1, 1, 0)),
            Err(Error::Io { .. })
        ));
        assert_eq!(names(&folder), [""; 0]);
    }

    #[test]
    fn a_contact_sheet_places_frames_in_rows() {
        let sheet = contact_sheet(&[plain(2, 1, 10), plain(1, 2, 20), plain(2, 2, 30)], 2).unwrap();
        assert_eq!((sheet.width(), sheet.height()), (4 + 2 * 6, 4 + 2 * 6));
        let shade = |x: usize, y: usize| sheet.pixels()[(y * 16 + x) * 3];
        assert_eq!([shade(4, 4), shade(5, 4), shade(4, 5)], [10, 10, 232]);
        assert_eq!([shade(10, 4), shade(10, 5), shade(11, 4)], [20, 20, 232]);
        assert_eq!([shade(4, 10), shade(5, 11), shade(10, 10)], [30, 30, 232]);
    }

    #[test]
    fn odd_contact_sheets() {
        assert_eq!(contact_sheet(&[], 3).unwrap().pixels().len(), 8 * 4 * 3);
        assert_eq!(
            contact_sheet(&[plain(1, 1, 0), Frame::new(0, 0).unwrap()], 0)
                .unwrap()
                .height(),
            14
        );
    }
}
