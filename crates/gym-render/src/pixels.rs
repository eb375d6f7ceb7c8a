//! Blending colours into rows of 8-bit red, green, blue.

use std::ops::Range;

use gym_core::canvas::{Color, Image, Point, Transform};
use gym_core::render::Frame;

/// Bytes of a pixel.
pub(crate) const RGB: usize = 3;
/// Edges of rectangles are rounded to quarters of a pixel, like those of other shapes in
/// `tiny-skia` (its `SUPERSAMPLE_SHIFT` is 2). Therefore adjacent shapes fit together, and the
/// edges have few shades, which fit into a GIF's colour table.
const SUBPIXELS: usize = 4;

/// Covers the whole frame with a colour; a translucent colour blends.
pub(crate) fn clear(frame: &mut Frame, color: Color) {
    let pixels = frame.pixels_mut();
    blend_run(pixels, 0..pixels.len() / RGB, color, 255);
}

/// Blends a colour into the rectangle between two corners. The coverage of a pixel is a multiple of
/// 1/16.
pub(crate) fn fill_box(frame: &mut Frame, min: Point, max: Point, color: Color) {
    let (width, height) = (frame.width() as usize, frame.height() as usize);
    let columns = shares(min[0], max[0], width);
    for (rows, share_y) in shares(min[1], max[1], height) {
        for y in rows {
            let row = row(frame, y);
            for (columns, share_x) in &columns {
                blend_run(
                    row,
                    columns.clone(),
                    color,
                    (share_x * share_y * 255.0).round() as u8,
                );
            }
        }
    }
}

/// Blends an image into the frame: each pixel takes the colour of the image at its middle.
pub(crate) fn draw_image(frame: &mut Frame, image: Image<'_>, transform: Transform) {
    let rows: Vec<&[Color]> = image.rows().collect();
    let steps = [
        image.size[0] / image.width as f64,
        image.size[1] / rows.len() as f64,
    ];
    // from pixels of the image to pixels of the frame
    let place = transform.then(Transform {
        x: [steps[0], 0.0],
        y: [0.0, steps[1]],
        origin: image.min,
    });
    let area = place.x[0] * place.y[1] - place.x[1] * place.y[0];
    let sides = [image.width as f64, rows.len() as f64];
    let corners = [[0.0, 0.0], [sides[0], 0.0], [0.0, sides[1]], sides].map(|at| place.apply(at));
    let range = |k: usize, length: u32| {
        let all = corners.iter().map(|corner| corner[k]);
        let least = all.clone().fold(f64::INFINITY, f64::min).floor();
        let greatest = all.fold(f64::NEG_INFINITY, f64::max).ceil();
        let within = |x: f64| x.clamp(0.0, f64::from(length)) as usize;
        within(least)..within(greatest)
    };
    let (columns, lines) = (range(0, frame.width()), range(1, frame.height()));
    for y in lines {
        let line = row(frame, y);
        for x in columns.clone() {
            let from = [
                x as f64 + 0.5 - place.origin[0],
                y as f64 + 0.5 - place.origin[1],
            ];
            let column = (from[0] * place.y[1] - from[1] * place.y[0]) / area;
            let number = (from[1] * place.x[0] - from[0] * place.x[1]) / area;
            // (the comparisons also exclude NaN)
            if column >= 0.0 && number >= 0.0 {
                let pixel = rows
                    .get(number as usize)
                    .and_then(|row| row.get(column as usize));
                let bytes = &mut line[x * RGB..(x + 1) * RGB];
                match pixel {
                    Some(&color) if color.a == 255 => {
                        bytes.copy_from_slice(&[color.r, color.g, color.b]);
                    }
                    Some(&color) if color.a > 0 => blend(bytes, color, 255),
                    _ => {}
                }
            }
        }
    }
}

/// Splits the pixels that the interval from `min` to `max` touches into three runs: the first
/// pixel, the complete pixels, the last pixel. Each run has the fraction of its pixels that the
/// interval covers. `min` and `max` are rounded to 1 / [`SUBPIXELS`] of a pixel.
fn shares(min: f64, max: f64, count: usize) -> [(Range<usize>, f64); 3] {
    const PARTS: f64 = SUBPIXELS as f64;
    let snap = |at: f64| ((at * PARTS).round() / PARTS).clamp(0.0, count as f64);
    let (min, max) = (snap(min.min(max)), snap(min.max(max)));
    let (first, last) = (min as usize, max as usize);
    if first == last {
        // (for NaN, every run is empty)
        return [
            (first..(first + 1).min(count), max - min),
            (0..0, 0.0),
            (0..0, 0.0),
        ];
    }
    [
        (first..first + 1, (first + 1) as f64 - min),
        (first + 1..last, 1.0),
        (last..(last + 1).min(count), max - last as f64),
    ]
}

/// Returns the bytes of a row of pixels.
pub(crate) fn row(frame: &mut Frame, y: usize) -> &mut [u8] {
    let bytes = frame.width() as usize * RGB;
    &mut frame.pixels_mut()[y * bytes..][..bytes]
}

/// Blends a colour into consecutive pixels of a row with equal coverage.
pub(crate) fn blend_run(row: &mut [u8], pixels: Range<usize>, color: Color, coverage: u8) {
    if scale(color.a, coverage) == 255 {
        fill_run(row, pixels, color);
    } else {
        let run = &mut row[pixels.start * RGB..pixels.end * RGB];
        run.chunks_exact_mut(RGB)
            .for_each(|pixel| blend(pixel, color, coverage));
    }
}

/// Sets consecutive pixels of a row to a colour; ignores its alpha.
pub(crate) fn fill_run(row: &mut [u8], pixels: Range<usize>, Color { r, g, b, .. }: Color) {
    let run = &mut row[pixels.start * RGB..pixels.end * RGB];
    if r == g && g == b {
        return run.fill(r);
    }
    // write words of 8 bytes: in a loop over pixels the compiler writes single bytes
    let word = |i: usize| u64::from_ne_bytes(std::array::from_fn(|j| [r, g, b][(8 * i + j) % RGB]));
    let group = [word(0), word(1), word(2)];
    let mut groups = run.chunks_exact_mut(8 * RGB);
    for pixels in groups.by_ref() {
        for (pixels, word) in pixels.chunks_exact_mut(8).zip(group) {
            pixels.copy_from_slice(&word.to_ne_bytes());
        }
    }
    groups
        .into_remainder()
        .chunks_exact_mut(RGB)
        .for_each(|pixel| pixel.copy_from_slice(&[r, g, b]));
}

/// Blends a colour into a pixel, with the given coverage.
pub(crate) fn blend(pixel: &mut [u8], Color { r, g, b, a }: Color, coverage: u8) {
    let alpha = scale(a, coverage);
    for (old, new) in pixel.iter_mut().zip([r, g, b]) {
        let sum = u32::from(new) * u32::from(alpha) + u32::from(*old) * u32::from(255 - alpha);
        *old = ((sum + 127) / 255) as u8;
    }
}

/// Returns the rounded product of two fractions, all in 255ths.
fn scale(a: u8, b: u8) -> u8 {
    ((u32::from(a) * u32::from(b) + 127) / 255) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Raster;
    use gym_core::render::Painter;

    fn red(frame: &Frame) -> Vec<u8> {
        frame.pixels().iter().step_by(RGB).copied().collect()
    }

    #[test]
    fn a_box_covers_pixels_by_their_share() {
        let mut frame = Frame::new(4, 3).unwrap();
        fill_box(&mut frame, [0.5, 1.0], [2.75, 2.5], Color::WHITE);
        assert_eq!(red(&frame), [0, 0, 0, 0, 128, 255, 191, 0, 64, 128, 96, 0]);
    }

    /// Boxes between any two quarters of a pixel, along each axis, also beyond the frame and with their
    /// corners exchanged.
    #[test]
    fn every_box_covers_its_share_of_each_pixel() {
        let quarters = || (-2..=14).map(|i| f64::from(i) / 4.0);
        for (min, max) in quarters().flat_map(|min| quarters().map(move |max| (min, max))) {
            let share = |x: f64| (max.max(min).min(x + 1.0) - min.min(max).max(x)).max(0.0);
            let expected = [0.0, 1.0, 2.0].map(|x| (share(x) * 255.0).round() as u8);
            let mut row = Frame::new(3, 1).unwrap();
            fill_box(&mut row, [min, 0.0], [max, 1.0], Color::WHITE);
            assert_eq!(red(&row), expected, "from {min} to {max}");
            let mut column = Frame::new(1, 3).unwrap();
            fill_box(&mut column, [0.0, min], [1.0, max], Color::WHITE);
            assert_eq!(red(&column), expected, "from {min} down to {max}");
        }
    }

    #[test]
    fn edges_move_to_quarters_of_a_pixel() {
        assert_eq!(shares(0.6, 2.1, 4), [(0..1, 0.5), (1..2, 1.0), (2..3, 0.0)]);
        assert_eq!(
            shares(1.9, -0.3, 4),
            [(0..1, 1.0), (1..2, 1.0), (2..3, 0.0)]
        );
    }

    #[test]
    fn a_box_within_a_pixel_beyond_the_frame_or_not_a_number() {
        let mut frame = Frame::new(2, 1).unwrap();
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
    fn translucent_colours_mix() {
        let mut frame = Frame::new(9, 1).unwrap();
        clear(&mut frame, Color::rgb(10, 20, 30));
        clear(&mut frame, Color::rgb(110, 220, 30).alpha(51));
        assert_eq!(frame.pixels()[24..], [30, 60, 30]);
    }

    /// An image is sharp where a pixel of it is a pixel of the frame, and is stretched elsewhere; other
    /// canvases draw the same pixels.
    #[test]
    fn images_are_laid_over_the_frame() {
        let clear = Color::WHITE.alpha(0);
        let half = Color::WHITE.alpha(128);
        let pixels = [Color::rgb(200, 0, 0), half, clear, Color::WHITE];
        let image = |min: Point, side: f64| Image {
            min,
            size: [side; 2],
            width: 2,
            pixels: &pixels,
        };
        let sharp = crate::frame((3, 3), |canvas| canvas.image(image([1.0, 0.0], 2.0))).unwrap();
        assert_eq!(red(&sharp), [0, 200, 128, 0, 0, 255, 0, 0, 0]);
        let mut twice = Frame::new(4, 4).unwrap();
        let mut resolution = 0.0;
        Raster::new().paint(
            (2, 2),
            &mut |canvas| {
                resolution = canvas.resolution();
                canvas.image(image([0.0; 2], 2.0));
            },
            &mut twice,
        );
        assert_eq!(
            (resolution, red(&twice)[4..8].to_vec()),
            (2.0, vec![200, 200, 128, 128])
        );
        let log = crate::DrawLog::of(|canvas| canvas.image(image([1.0, 0.0], 2.0)));
        assert!(
            log.to_string()
                .starts_with("image 1,0 size=2,2 pixels=2x2 crc="),
            "{log}"
        );
        let document = crate::svg((3, 3), |canvas| canvas.image(image([1.0, 0.0], 2.0)));
        assert!(
            document.contains("<image x=\"1\" y=\"0\" width=\"2\" height=\"2\""),
            "{document}"
        );
        let none = Image {
            pixels: &[],
            ..image([0.0; 2], 1.0)
        };
        let empty = crate::frame((3, 3), |canvas| canvas.image(none)).unwrap();
        assert_eq!(empty, Frame::new(3, 3).unwrap());
        assert!(!crate::svg((3, 3), |canvas| canvas.image(none)).contains("image"));
    }

    /// A pixel of the frame has the colour of the image's pixel below its middle, however the image is
    /// stretched or shrunk along each axis.
    #[test]
    fn images_are_stretched_along_each_axis() {
        for ([columns, rows], [width, height]) in [
            ([1, 1], [5, 7]),
            ([3, 2], [6, 10]),
            ([2, 5], [12, 3]),
            ([4, 3], [2, 9]),
            ([3, 4], [30, 2]),
        ] {
            let shades = (1..=columns * rows).map(|i| Color::rgb(10 * i as u8, 0, 0));
            let pixels: Vec<Color> = shades.collect();
            let image = Image {
                min: [2.0, 1.0],
                size: [width as f64, height as f64],
                width: columns,
                pixels: &pixels,
            };
            let size = (width as u32 + 3, height as u32 + 2);
            let frame = red(&crate::frame(size, |canvas| canvas.image(image)).unwrap());
            let below = |i: usize, pixels: usize, length: usize| {
                // none if the middle is between two pixels
                let (twice, step) = ((2 * i + 1) * pixels, 2 * length);
                (!twice.is_multiple_of(step)).then_some(twice / step)
            };
            for (y, line) in frame.chunks(width + 3).enumerate() {
                for (x, found) in line.iter().enumerate() {
                    let expected = match (x.checked_sub(2), y.checked_sub(1)) {
                        (Some(x), Some(y)) if x < width && y < height => {
                            let place = (below(x, columns, width), below(y, rows, height));
                            let (Some(column), Some(row)) = place else {
                                continue;
                            };
                            pixels[row * columns + column].r
                        }
                        _ => 0,
                    };
                    assert_eq!(
                        *found, expected,
                        "{columns}x{rows} on {width}x{height}: {x}, {y}"
                    );
                }
            }
        }
    }
}
