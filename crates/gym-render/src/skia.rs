//! Smooth shapes, by `tiny-skia`.
//!
//! It computes how much of each pixel a shape covers, in a mask no larger than the shape; the colour is laid
//! over the frame here, row by row.

use gym_core::canvas::{Align, Color, Point, Segment, Shape, Transform};
use gym_core::render::Frame;
use tiny_skia::{FillRule, LineCap, LineJoin, Mask, Path, PathBuilder, Stroke};

use crate::outline::outline;
use crate::{font, pixels};

/// Larger masks are made in pieces.
const LARGEST: u32 = 4096;

/// A shape that reaches further from the frame's corner, in pixels, is left out: `tiny-skia` is not made for
/// it.
const REACH: f32 = 32_768.0;

/// Fills a shape.
pub(crate) fn fill(frame: &mut Frame, shape: Shape<'_>, transform: Transform, color: Color) {
    if let Some(path) = path(|emit| outline(shape, &mut |segment| emit(segment))) {
        fill_path(frame, path.transform(skia(transform)), color);
    }
}

/// Draws a shape's outline.
pub(crate) fn stroke(frame: &mut Frame, shape: Shape<'_>, width: f64, transform: Transform, color: Color) {
    if let Some(path) = path(|emit| outline(shape, &mut |segment| emit(segment))) {
        stroke_path(frame, &path, width, LineCap::Butt, transform, color);
    }
}

/// Writes a line of text.
pub(crate) fn text(
    frame: &mut Frame,
    text: &str,
    position: Point,
    size: f64,
    align: Align,
    transform: Transform,
    color: Color,
) {
    let strokes = path(|emit| font::outline(text, position, size, align, &mut |segment| emit(segment)));
    if let Some(path) = strokes {
        stroke_path(frame, &path, size * font::WEIGHT, LineCap::Round, transform, color);
    }
}

fn skia(Transform { x, y, origin }: Transform) -> tiny_skia::Transform {
    let [sx, ky, kx, sy, tx, ty] = [x[0], x[1], y[0], y[1], origin[0], origin[1]].map(|x| x as f32);
    tiny_skia::Transform::from_row(sx, ky, kx, sy, tx, ty)
}

/// The path that `draw` emits; none if it is empty, or a number is not finite.
fn path(draw: impl FnOnce(&mut dyn FnMut(Segment))) -> Option<Path> {
    let mut path = PathBuilder::new();
    let xy = |[x, y]: Point| (x as f32, y as f32);
    draw(&mut |segment| match segment {
        Segment::Move(to) => path.move_to(xy(to).0, xy(to).1),
        Segment::Line(to) => path.line_to(xy(to).0, xy(to).1),
        Segment::Quad(a, to) => path.quad_to(xy(a).0, xy(a).1, xy(to).0, xy(to).1),
        Segment::Cubic(a, b, to) => path.cubic_to(xy(a).0, xy(a).1, xy(b).0, xy(b).1, xy(to).0, xy(to).1),
        Segment::Close => path.close(),
    });
    path.finish()
}

/// A line thinner than a pixel is drawn a pixel wide and fainter, so that it does not fall between the
/// samples.
fn stroke_path(
    frame: &mut Frame,
    path: &Path,
    width: f64,
    line_cap: LineCap,
    transform: Transform,
    color: Color,
) {
    let scale = (transform.x[0] * transform.y[1] - transform.x[1] * transform.y[0]).abs().sqrt();
    let pixels = width * scale;
    // not a number neither
    if !(pixels > 0.0 && pixels <= f64::from(2.0 * REACH)) {
        return;
    }
    let (width, color) = if pixels < 1.0 {
        (1.0 / scale, color.alpha((f64::from(color.a) * pixels).round() as u8))
    } else {
        (width, color)
    };
    let stroke = Stroke { width: width as f32, line_cap, line_join: LineJoin::Round, ..Stroke::default() };
    if let Some(path) = path.stroke(&stroke, scale as f32) {
        fill_path(frame, path.transform(skia(transform)), color);
    }
}

fn fill_path(frame: &mut Frame, path: Option<Path>, color: Color) {
    let Some(path) = path else { return };
    let bounds = path.bounds();
    let sides = [bounds.left(), bounds.right(), bounds.top(), bounds.bottom()];
    if sides.iter().any(|side| side.abs() > REACH) {
        return;
    }
    let place = |x: f32, size: u32| x.clamp(0.0, size as f32) as u32;
    let (left, top) =
        (place(bounds.left().floor(), frame.width()), place(bounds.top().floor(), frame.height()));
    let right = place(bounds.right().ceil(), frame.width());
    let bottom = place(bounds.bottom().ceil(), frame.height());
    for y in (top..bottom).step_by(LARGEST as usize) {
        for x in (left..right).step_by(LARGEST as usize) {
            let Some(mut mask) = Mask::new((right - x).min(LARGEST), (bottom - y).min(LARGEST)) else {
                continue;
            };
            let place = tiny_skia::Transform::from_translate(-(x as f32), -(y as f32));
            mask.fill_path(&path, FillRule::Winding, true, place);
            for (row, coverage) in (y..).zip(mask.data().chunks_exact(mask.width() as usize)) {
                lay(pixels::row(frame, row as usize), x as usize, coverage, color);
            }
        }
    }
}

/// Lays colour over a row from a pixel on, runs of the same coverage at once.
fn lay(row: &mut [u8], mut x: usize, coverage: &[u8], color: Color) {
    for run in coverage.chunk_by(|a, b| a == b) {
        if run[0] != 0 {
            pixels::blend_run(row, x..x + run.len(), color, run[0]);
        }
        x += run.len();
    }
}
