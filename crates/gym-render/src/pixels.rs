//! Laying colour over rows of 8-bit red, green, blue.

use std::ops::Range;

use gym_core::canvas::{Color, Point};
use gym_core::render::Frame;

/// Bytes of a pixel.
const RGB: usize = 3;
/// Edges lie on parts of a pixel, as in `tiny-skia` (its `SUPERSAMPLE_SHIFT` is 2). So shapes fit
/// together, and the few shades along edges fit into a GIF's colour table.
const SUBPIXELS: f64 = 4.0;
/// Pixels that are looked at together.
const GROUP: usize = 8;

/// Covers the whole frame; translucent colours are laid over what is there.
pub(crate) fn clear(frame: &mut Frame, color: Color) {
    blend_run(frame.pixels_mut(), color, 255);
}

/// Lays colour over the part of the frame between two corners. A pixel that is only partly inside
/// takes its share, in sixteenths.
pub(crate) fn fill_box(frame: &mut Frame, min: Point, max: Point, color: Color) {
    let (width, height) = (frame.width() as usize, frame.height() as usize);
    let columns = shares(min[0], max[0], width);
    for (rows, share_y) in shares(min[1], max[1], height) {
        for y in rows {
            let row = &mut frame.pixels_mut()[y * width * RGB..][..width * RGB];
            for (columns, share_x) in &columns {
                let run = &mut row[columns.start * RGB..columns.end * RGB];
                blend_run(run, color, (share_x * share_y * 255.0).round() as u8);
            }
        }
    }
}

/// Cuts the pixels that an interval touches into three runs (the first pixel, the whole ones, the
/// last one), each with the share of each of its pixels that lies inside. The ends move to the
/// nearest [`SUBPIXELS`] part of a pixel.
fn shares(min: f64, max: f64, count: usize) -> [(Range<usize>, f64); 3] {
    let snap = |at: f64| ((at * SUBPIXELS).round() / SUBPIXELS).clamp(0.0, count as f64);
    let (min, max) = (snap(min.min(max)), snap(min.max(max)));
    let (first, last) = (min as usize, max as usize);
    if first == last {
        // A NaN ends here too, as 0..0.
        return [(first..(first + 1).min(count), max - min), (0..0, 0.0), (0..0, 0.0)];
    }
    [
        (first..first + 1, (first + 1) as f64 - min),
        (first + 1..last, 1.0),
        (last..(last + 1).min(count), max - last as f64),
    ]
}

/// Lays colour over the pixels in `columns` and `rows` where `mask` (one byte per pixel of the
/// frame) covers them, and empties the mask there.
pub(crate) fn fill_mask(
    frame: &mut Frame,
    mask: &mut [u8],
    columns: Range<usize>,
    rows: Range<usize>,
    color: Color,
) {
    const EMPTY: [u8; GROUP] = [0; GROUP];
    const FULL: [u8; GROUP] = [255; GROUP];
    let width = frame.width() as usize;
    for y in rows {
        let (start, end) = (y * width + columns.start, y * width + columns.end);
        let mask = &mut mask[start..end];
        let row = &mut frame.pixels_mut()[start * RGB..end * RGB];
        for (run, mask) in row.chunks_mut(GROUP * RGB).zip(mask.chunks(GROUP)) {
            if mask == EMPTY {
                continue;
            }
            if mask == FULL {
                blend_run(run, color, 255);
                continue;
            }
            for (pixel, &coverage) in run.chunks_exact_mut(RGB).zip(mask) {
                blend(pixel, color, coverage);
            }
        }
        mask.fill(0);
    }
}

/// Lays colour over consecutive pixels that are all covered alike.
fn blend_run(run: &mut [u8], color: Color, coverage: u8) {
    let Color { r, g, b, a } = color;
    if scale(a, coverage) == 255 {
        let group: [u8; GROUP * RGB] = std::array::from_fn(|i| [r, g, b][i % RGB]);
        let mut groups = run.chunks_exact_mut(GROUP * RGB);
        groups.by_ref().for_each(|pixels| pixels.copy_from_slice(&group));
        let rest = groups.into_remainder();
        rest.copy_from_slice(&group[..rest.len()]);
    } else {
        run.chunks_exact_mut(RGB).for_each(|pixel| blend(pixel, color, coverage));
    }
}

/// `color` over `pixel`, weighed by the coverage.
fn blend(pixel: &mut [u8], Color { r, g, b, a }: Color, coverage: u8) {
    let alpha = scale(a, coverage);
    for (old, new) in pixel.iter_mut().zip([r, g, b]) {
        let sum = u32::from(new) * u32::from(alpha) + u32::from(*old) * u32::from(255 - alpha);
        *old = ((sum + 127) / 255) as u8;
    }
}

/// The product of two parts of 255, rounded.
fn scale(a: u8, b: u8) -> u8 {
    ((u32::from(a) * u32::from(b) + 127) / 255) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn red(frame: &Frame) -> Vec<u8> {
        frame.pixels().iter().step_by(RGB).copied().collect()
    }

    #[test]
    fn a_box_covers_pixels_by_their_share() {
        let mut frame = Frame::new(4, 3);
        fill_box(&mut frame, [0.5, 1.0], [2.75, 2.5], Color::WHITE);
        assert_eq!(red(&frame), [0, 0, 0, 0, 128, 255, 191, 0, 64, 128, 96, 0]);
    }

    #[test]
    fn edges_move_to_quarters_of_a_pixel() {
        assert_eq!(shares(0.6, 2.1, 4), [(0..1, 0.5), (1..2, 1.0), (2..3, 0.0)]);
        assert_eq!(shares(1.9, -0.3, 4), [(0..1, 1.0), (1..2, 1.0), (2..3, 0.0)]);
    }

    #[test]
    fn a_box_within_a_pixel_beyond_the_frame_or_not_a_number() {
        let mut frame = Frame::new(2, 1);
        fill_box(&mut frame, [0.25, 0.0], [0.75, 9.0], Color::WHITE);
        assert_eq!(red(&frame), [128, 0]);
        fill_box(&mut frame, [5.0, -3.0], [1.0, 1e300], Color::WHITE);
        assert_eq!(red(&frame), [128, 255]);
        let before = frame.clone();
        fill_box(&mut frame, [f64::NAN, 0.0], [f64::NAN, 1.0], Color::BLACK);
        fill_box(&mut frame, [-5.0, 0.0], [-4.0, 1.0], Color::BLACK);
        fill_box(&mut frame, [2.0, 1.0], [3.0, 2.0], Color::BLACK);
        assert_eq!(frame, before);
    }

    #[test]
    fn a_mask_is_applied_and_emptied() {
        let mut frame = Frame::new(10, 1);
        let mut mask = [255, 255, 255, 255, 255, 255, 255, 255, 51, 0];
        fill_mask(&mut frame, &mut mask, 0..10, 0..1, Color::rgb(100, 0, 0));
        assert_eq!(red(&frame), [100, 100, 100, 100, 100, 100, 100, 100, 20, 0]);
        assert_eq!(mask, [0; 10]);
    }

    #[test]
    fn translucent_colours_mix() {
        let mut frame = Frame::new(9, 1);
        clear(&mut frame, Color::rgb(10, 20, 30));
        clear(&mut frame, Color::rgb(110, 220, 30).alpha(51));
        assert_eq!(frame.pixels()[24..], [30, 60, 30]);
    }
}
