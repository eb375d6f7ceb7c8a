//! Antialiased shapes, by `tiny-skia`.
//!
//! `tiny-skia` computes the coverage of each pixel in a mask no larger than the shape. This module
//! blends the colour into runs of pixels with equal coverage. Frames repeat most shapes of earlier
//! frames, so the runs of each shape are cached.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use gym_core::canvas::{Align, Color, Point, Segment, Shape, Transform};
use gym_core::render::Frame;
use tiny_skia::{FillRule, LineCap, LineJoin, Mask, Path, PathBuilder, Stroke};

use crate::outline::outline;
use crate::{font, pixels};

/// The largest side of a mask. Larger shapes are drawn in several masks.
const LARGEST: u32 = 4096;

/// Shapes that extend beyond this distance from the frame's corner, in pixels, are not drawn:
/// `tiny-skia` does not support them.
const REACH: f32 = 32_768.0;

/// Draws antialiased shapes, with a cache of their runs.
#[derive(Debug, Default)]
pub(crate) struct Skia {
    /// The runs of each shape. The key consists of all parameters of the shape, its transform and
    /// the frame's size.
    known: HashMap<Box<[u64]>, Box<[Run]>, BuildHasherDefault<WordHasher>>,
    /// The size of `known` in words of 8 bytes.
    words: usize,
    /// The key and the runs of the current shape.
    key: Vec<u64>,
    runs: Vec<Run>,
}

/// Adjacent pixels of a row with equal coverage, in 255ths.
#[derive(Clone, Copy, Debug)]
struct Run {
    x: u16,
    y: u16,
    len: u16,
    coverage: u8,
}

impl Skia {
    /// The number of words (2 MB) at which the cache is cleared: a drawing that fills the cache
    /// does not repeat its shapes.
    const MOST: usize = 1 << 18;

    /// Fills a shape.
    pub(crate) fn fill(
        &mut self,
        frame: &mut Frame,
        shape: Shape<'_>,
        transform: Transform,
        color: Color,
    ) {
        self.key.clear();
        self.key.push(0);
        self.place(frame, transform);
        self.shape(shape);
        self.draw(frame, color, |frame, emit| {
            if let Some(path) = path(|emit| outline(shape, &mut |segment| emit(segment))) {
                fill_path(frame, path.transform(skia(transform)), emit);
            }
        });
    }

    /// Strokes a shape's outline.
    pub(crate) fn stroke(
        &mut self,
        frame: &mut Frame,
        shape: Shape<'_>,
        width: f64,
        transform: Transform,
        color: Color,
    ) {
        let Some((width, color)) = visible(width, transform, color) else {
            return;
        };
        self.key.clear();
        self.key.extend([1, width.to_bits()]);
        self.place(frame, transform);
        self.shape(shape);
        self.draw(frame, color, |frame, emit| {
            if let Some(path) = path(|emit| outline(shape, &mut |segment| emit(segment))) {
                stroke_path(frame, &path, width, LineCap::Butt, transform, emit);
            }
        });
    }

    /// Draws a line of text.
    pub(crate) fn text(
        &mut self,
        frame: &mut Frame,
        (text, position, size, align): (&str, Point, f64, Align),
        transform: Transform,
        color: Color,
    ) {
        let Some((width, color)) = visible(size * font::WEIGHT, transform, color) else {
            return;
        };
        self.key.clear();
        self.key
            .extend([2, size.to_bits(), align as u64, text.len() as u64]);
        self.key.extend(text.bytes().map(u64::from));
        self.points(&[position]);
        self.place(frame, transform);
        self.draw(frame, color, |frame, emit| {
            let strokes = path(|emit| {
                font::outline(text, position, size, align, &mut |segment| emit(segment));
            });
            if let Some(path) = strokes {
                stroke_path(frame, &path, width, LineCap::Round, transform, emit);
            }
        });
    }

    /// Adds the frame's size and the transform to the key.
    fn place(&mut self, frame: &Frame, Transform { x, y, origin }: Transform) {
        self.key
            .push(u64::from(frame.width()) << 32 | u64::from(frame.height()));
        self.points(&[x, y, origin]);
    }

    /// Adds points to the key.
    fn points(&mut self, points: &[Point]) {
        self.key
            .extend(points.as_flattened().iter().map(|x| x.to_bits()));
    }

    /// Adds a shape to the key.
    fn shape(&mut self, shape: Shape<'_>) {
        match shape {
            Shape::Polygon(points) => {
                self.key.push(0);
                self.points(points);
            }
            Shape::Polyline(points) => {
                self.key.push(1);
                self.points(points);
            }
            Shape::Circle { center, radius } => {
                self.key.push(2);
                self.points(&[center, [radius; 2]]);
            }
            Shape::Rect { min, size, corner } => {
                self.key.push(3);
                self.points(&[min, size, [corner; 2]]);
            }
            Shape::Path(segments) => {
                self.key.push(4);
                for segment in segments {
                    match *segment {
                        Segment::Move(to) => (self.key.push(0), self.points(&[to])),
                        Segment::Line(to) => (self.key.push(1), self.points(&[to])),
                        Segment::Quad(a, to) => (self.key.push(2), self.points(&[a, to])),
                        Segment::Cubic(a, b, to) => (self.key.push(3), self.points(&[a, b, to])),
                        Segment::Close => (self.key.push(4), ()),
                    };
                }
            }
        }
    }

    /// Blends a colour into the shape of the current key; `cover` computes the runs if the cache
    /// does not have them.
    fn draw(
        &mut self,
        frame: &mut Frame,
        color: Color,
        cover: impl FnOnce(&Frame, &mut dyn FnMut(Run)),
    ) {
        if let Some(runs) = self.known.get(&self.key[..]) {
            return lay(frame, runs, color);
        }
        self.runs.clear();
        cover(frame, &mut |run| self.runs.push(run));
        lay(frame, &self.runs, color);
        self.words += self.key.len() + self.runs.len();
        if self.words > Self::MOST {
            self.known.clear();
            self.words = 0;
        } else {
            self.known.insert(self.key[..].into(), self.runs[..].into());
        }
    }
}

/// Blends a colour into runs of pixels.
fn lay(frame: &mut Frame, runs: &[Run], color: Color) {
    let bytes = frame.width() as usize * pixels::RGB;
    for &Run {
        x,
        y,
        len,
        coverage,
    } in runs
    {
        let (x, y, len) = (usize::from(x), usize::from(y), usize::from(len));
        let row = &mut frame.pixels_mut()[y * bytes..][..bytes];
        pixels::blend_run(row, x..x + len, color, coverage);
    }
}

/// A fast hash without protection against attacks: the keys come from drawings, not from an
/// attacker.
#[derive(Default)]
struct WordHasher(u64);

impl Hasher for WordHasher {
    fn finish(&self) -> u64 {
        self.0 ^ self.0 >> 32
    }

    fn write(&mut self, bytes: &[u8]) {
        let (words, rest) = bytes.as_chunks::<8>();
        words
            .iter()
            .for_each(|word| self.write_u64(u64::from_ne_bytes(*word)));
        rest.iter()
            .for_each(|byte| self.write_u64(u64::from(*byte)));
    }

    fn write_u64(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }

    fn write_usize(&mut self, word: usize) {
        self.write_u64(word as u64);
    }
}

fn skia(Transform { x, y, origin }: Transform) -> tiny_skia::Transform {
    let [sx, ky, kx, sy, tx, ty] = [x[0], x[1], y[0], y[1], origin[0], origin[1]].map(|x| x as f32);
    tiny_skia::Transform::from_row(sx, ky, kx, sy, tx, ty)
}

/// Returns the path that `draw` emits; `None` if the path is empty or has a non-finite number.
fn path(draw: impl FnOnce(&mut dyn FnMut(Segment))) -> Option<Path> {
    let mut path = PathBuilder::new();
    let xy = |[x, y]: Point| (x as f32, y as f32);
    draw(&mut |segment| match segment {
        Segment::Move(to) => path.move_to(xy(to).0, xy(to).1),
        Segment::Line(to) => path.line_to(xy(to).0, xy(to).1),
        Segment::Quad(a, to) => path.quad_to(xy(a).0, xy(a).1, xy(to).0, xy(to).1),
        Segment::Cubic(a, b, to) => {
            path.cubic_to(xy(a).0, xy(a).1, xy(b).0, xy(b).1, xy(to).0, xy(to).1);
        }
        Segment::Close => path.close(),
    });
    path.finish()
}

/// Returns the number of pixels per unit of the drawing.
pub(crate) fn scale(transform: Transform) -> f64 {
    (transform.x[0] * transform.y[1] - transform.x[1] * transform.y[0])
        .abs()
        .sqrt()
}

/// Returns width and colour of a line, if it is visible. A line thinner than a pixel is drawn one
/// pixel wide and fainter, so that it does not fall between samples.
fn visible(width: f64, transform: Transform, color: Color) -> Option<(f64, Color)> {
    let scale = scale(transform);
    let pixels = width * scale;
    // (the negation also excludes NaN)
    if !(pixels > 0.0 && pixels <= f64::from(2.0 * REACH)) {
        return None;
    }
    Some(if pixels < 1.0 {
        (
            1.0 / scale,
            color.alpha((f64::from(color.a) * pixels).round() as u8),
        )
    } else {
        (width, color)
    })
}

fn stroke_path(
    frame: &Frame,
    path: &Path,
    width: f64,
    line_cap: LineCap,
    transform: Transform,
    emit: &mut dyn FnMut(Run),
) {
    let stroke = Stroke {
        width: width as f32,
        line_cap,
        line_join: LineJoin::Round,
        ..Stroke::default()
    };
    if let Some(path) = path.stroke(&stroke, scale(transform) as f32) {
        fill_path(frame, path.transform(skia(transform)), emit);
    }
}

/// Passes the runs of pixels that a path covers to `emit`.
fn fill_path(frame: &Frame, path: Option<Path>, emit: &mut dyn FnMut(Run)) {
    let Some(path) = path else { return };
    let bounds = path.bounds();
    let sides = [bounds.left(), bounds.right(), bounds.top(), bounds.bottom()];
    if sides.iter().any(|side| side.abs() > REACH) {
        return;
    }
    let place = |x: f32, size: u32| x.clamp(0.0, size as f32) as u32;
    let (left, top) = (
        place(bounds.left().floor(), frame.width()),
        place(bounds.top().floor(), frame.height()),
    );
    let right = place(bounds.right().ceil(), frame.width());
    let bottom = place(bounds.bottom().ceil(), frame.height());
    for top in (top..bottom).step_by(LARGEST as usize) {
        for left in (left..right).step_by(LARGEST as usize) {
            let size = ((right - left).min(LARGEST), (bottom - top).min(LARGEST));
            let Some(mut mask) = Mask::new(size.0, size.1) else {
                continue;
            };
            let place = tiny_skia::Transform::from_translate(-(left as f32), -(top as f32));
            mask.fill_path(&path, FillRule::Winding, true, place);
            for (y, row) in (top..).zip(mask.data().chunks_exact(size.0 as usize)) {
                let mut x = left;
                for run in row.chunk_by(|a, b| a == b) {
                    if run[0] != 0 {
                        // coordinates fit into 16 bits, because no shape extends beyond [`REACH`]
                        emit(Run {
                            x: x as u16,
                            y: y as u16,
                            len: run.len() as u16,
                            coverage: run[0],
                        });
                    }
                    x += run.len() as u32;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_bounded_and_gives_the_same_picture() {
        let circle = |skia: &mut Skia, frame: &mut Frame, i: u32| {
            let shape = Shape::Circle {
                center: [40.0, 40.0 + f64::from(i) / 1024.0],
                radius: 39.5,
            };
            skia.fill(frame, shape, Transform::IDENTITY, Color::WHITE);
        };
        let mut skia = Skia::default();
        let mut most = 0;
        for i in (0..1000).chain(0..10) {
            let mut frame = Frame::new(80, 80).unwrap();
            circle(&mut skia, &mut frame, i);
            assert!(skia.words <= Skia::MOST);
            most = most.max(skia.known.len());
            if i.is_multiple_of(100) {
                let mut fresh = Frame::new(80, 80).unwrap();
                circle(&mut Skia::default(), &mut fresh, i);
                assert!(frame == fresh, "{i}");
            }
        }
        assert!(skia.known.len() < most, "it was given up");
        let known = skia.known.len();
        circle(&mut skia, &mut Frame::new(80, 80).unwrap(), 9);
        assert_eq!(skia.known.len(), known, "it is known");
    }

    #[test]
    fn a_scale_is_a_larger_drawing() {
        let points = [[1.0, 1.0], [7.0, 2.0], [6.0, 7.0]];
        for scale in [0.25, 0.5, 1.0, 2.0, 4.0] {
            let larger = points.map(|point| point.map(|x| scale * x));
            for width in [0.125, 0.25, 0.5, 1.0, 1.5, 3.0] {
                let drawn = |points: &[Point], width: f64, scale: f64| {
                    let (mut skia, mut frame) = (Skia::default(), Frame::new(32, 32).unwrap());
                    let transform = Transform::scale(scale, scale);
                    let size = 4.0 * width;
                    skia.stroke(
                        &mut frame,
                        Shape::Polyline(points),
                        width,
                        transform,
                        Color::WHITE,
                    );
                    let text = ("a", points[0], size, Align::Left);
                    skia.text(&mut frame, text, transform, Color::WHITE);
                    frame
                };
                assert!(
                    drawn(&points, width, scale) == drawn(&larger, scale * width, 1.0),
                    "a line {width} wide, {scale} times as large"
                );
            }
        }
    }

    #[test]
    fn shapes_are_told_apart_by_all_that_decides_them() {
        let points = [[1.0, 1.0], [7.0, 2.0], [6.0, 7.0]];
        let [polygon, polyline] = [Shape::Polygon(&points), Shape::Polyline(&points)];
        let turned = Transform {
            x: [0.0, 1.0],
            y: [1.0, 0.0],
            ..Transform::IDENTITY
        };
        let draw = |skia: &mut Skia, frame: &mut Frame, i: u32| match i {
            0 => skia.fill(frame, polygon, Transform::IDENTITY, Color::WHITE),
            1 => skia.fill(frame, polygon, turned, Color::WHITE),
            2 => skia.stroke(frame, polygon, 1.0, Transform::IDENTITY, Color::WHITE),
            3 => skia.stroke(frame, polyline, 1.0, Transform::IDENTITY, Color::WHITE),
            4 => skia.stroke(frame, polyline, 2.0, Transform::IDENTITY, Color::WHITE),
            5 => skia.text(
                frame,
                ("a", [1.0, 7.0], 6.0, Align::Left),
                Transform::IDENTITY,
                Color::WHITE,
            ),
            6 => skia.text(
                frame,
                ("b", [1.0, 7.0], 6.0, Align::Left),
                Transform::IDENTITY,
                Color::WHITE,
            ),
            _ => skia.text(
                frame,
                ("b", [5.0, 7.0], 6.0, Align::Center),
                Transform::IDENTITY,
                Color::WHITE,
            ),
        };
        let mut skia = Skia::default();
        let pictures = [8, 9].map(|side| {
            [0, 1, 2, 3, 4, 5, 6, 7].map(|i| {
                let (mut frame, mut fresh) = (
                    Frame::new(side, side).unwrap(),
                    Frame::new(side, side).unwrap(),
                );
                draw(&mut skia, &mut frame, i);
                draw(&mut Skia::default(), &mut fresh, i);
                assert!(frame == fresh, "{i}");
                frame
            })
        });
        for (i, picture) in pictures[0].iter().enumerate() {
            assert!(pictures[0][..i].iter().all(|other| other != picture), "{i}");
        }
    }
}
