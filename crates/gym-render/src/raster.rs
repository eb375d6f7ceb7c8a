//! Drawings as pixels, anti-aliased.
//!
//! `tiny-skia` turns outlines into coverage, one byte per pixel, in fixed-point arithmetic. This
//! module lays the colour over the frame with it, in integers. So a drawing gives the same bytes
//! on every processor, with or without SIMD.

use std::fmt;

use gym_core::canvas::{Align, Canvas, Color, Point, Segment, Shape, Transform};
use gym_core::inventory;
use gym_core::render::{Frame, Painter, PainterProvider};
use tiny_skia::{FillRule, LineCap, LineJoin, Mask, Path, PathBuilder, PathStroker, Stroke};

use crate::outline::outline;
use crate::transforms::Transforms;
use crate::{font, pixels};

/// Shapes that reach further than this from the frame's corner, in pixels, are left out:
/// `tiny-skia` takes very long or fails on coordinates of a million.
const REACH: f32 = 32_768.0;

inventory::submit! {
    PainterProvider { new: || Box::new(Raster::new()) }
}

/// Draws into [`Frame`]s of any size; the coordinates of the drawing are stretched to fill them.
///
/// It keeps its buffers from frame to frame: use one for many. A shape that reaches further than
/// 32768 pixels from the frame's corner is left out, unless it is an upright rectangle.
pub struct Raster {
    /// Coverage of the shape being drawn, empty in between.
    mask: Option<Mask>,
    builder: PathBuilder,
    stroker: PathStroker,
    transforms: Transforms,
}

impl Raster {
    /// A painter without buffers yet.
    pub fn new() -> Self {
        Self {
            mask: None,
            builder: PathBuilder::new(),
            stroker: PathStroker::new(),
            transforms: Transforms::new(),
        }
    }
}

impl Default for Raster {
    fn default() -> Self {
        Self::new()
    }
}

impl fmt::Debug for Raster {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Raster").finish_non_exhaustive()
    }
}

impl Painter for Raster {
    fn paint(&mut self, size: (u32, u32), draw: &mut dyn FnMut(&mut dyn Canvas), frame: &mut Frame) {
        let (width, height) = (frame.width(), frame.height());
        if self.mask.as_ref().is_none_or(|mask| (mask.width(), mask.height()) != (width, height)) {
            self.mask = Mask::new(width, height);
        }
        let scale = |pixels: u32, units: u32| f64::from(pixels) / f64::from(units.max(1));
        self.transforms.restart(Transform::scale(scale(width, size.0), scale(height, size.1)));
        draw(&mut Surface { raster: self, frame });
    }
}

/// One frame of a drawing, at its own size.
pub fn frame(size: (u32, u32), draw: impl FnOnce(&mut dyn Canvas)) -> Frame {
    let mut frame = Frame::new(size.0, size.1);
    let mut draw = Some(draw);
    let mut once = |canvas: &mut dyn Canvas| {
        if let Some(draw) = draw.take() {
            draw(canvas);
        }
    };
    Raster::new().paint(size, &mut once, &mut frame);
    frame
}

/// A frame being drawn.
struct Surface<'a> {
    raster: &'a mut Raster,
    frame: &'a mut Frame,
}

impl Surface<'_> {
    /// A path of `segments`, in inner coordinates.
    fn path(&mut self, segments: impl FnOnce(&mut dyn FnMut(Segment))) -> Option<Path> {
        let mut builder = std::mem::take(&mut self.raster.builder);
        builder.clear();
        segments(&mut |segment| append(&mut builder, segment));
        builder.finish()
    }

    /// Fills a path given in inner coordinates, and keeps its buffer for the next one.
    fn fill_path(&mut self, path: Path, color: Color) {
        let transform = skia_transform(self.raster.transforms.current());
        let (Some(path), Some(mask)) = (path.transform(transform), &mut self.raster.mask) else {
            return;
        };
        if !within_reach(&path, 1.0) {
            return;
        }
        mask.fill_path(&path, FillRule::Winding, true, tiny_skia::Transform::identity());
        // One pixel more on each side, for curves that bulge out by a rounding error.
        let range = |min: f32, max: f32, count: u32| {
            let pixel = |at: f32| (at.max(0.0) as usize).min(count as usize);
            pixel(min - 1.0)..pixel(max + 2.0)
        };
        let bounds = path.bounds();
        let columns = range(bounds.left(), bounds.right(), mask.width());
        let rows = range(bounds.top(), bounds.bottom(), mask.height());
        pixels::fill_mask(self.frame, mask.data_mut(), columns, rows, color);
        self.raster.builder = path.clear();
    }

    /// Strokes a path given in inner coordinates. A line thinner than a pixel is drawn a pixel
    /// wide and fainter, so that it does not fall between the samples.
    fn stroke_path(&mut self, path: Path, width: f64, cap: LineCap, color: Color) {
        let transform = self.raster.transforms.current();
        let scale = (transform.x[0] * transform.y[1] - transform.x[1] * transform.y[0]).abs().sqrt();
        let pixels = width * scale;
        let (width, color) = if pixels < 1.0 {
            (1.0 / scale, color.alpha((f64::from(color.a) * pixels).round() as u8))
        } else {
            (width, color)
        };
        let stroke =
            Stroke { width: width as f32, line_cap: cap, line_join: LineJoin::Round, ..Stroke::default() };
        let resolution = PathStroker::compute_resolution_scale(&skia_transform(transform));
        if within_reach(&path, resolution)
            && let Some(outline) = self.raster.stroker.stroke(&path, &stroke, resolution)
        {
            self.fill_path(outline, color);
        }
    }
}

impl Canvas for Surface<'_> {
    fn clear(&mut self, color: Color) {
        pixels::clear(self.frame, color);
    }

    fn fill(&mut self, shape: Shape<'_>, color: Color) {
        let transform = self.raster.transforms.current();
        let upright = transform.x[1] == 0.0 && transform.y[0] == 0.0;
        if let Shape::Rect { min, size, corner: 0.0 } = shape
            && upright
        {
            let max = [min[0] + size[0], min[1] + size[1]];
            pixels::fill_box(self.frame, transform.apply(min), transform.apply(max), color);
        } else if let Some(path) = self.path(|mut emit| outline(shape, &mut emit)) {
            self.fill_path(path, color);
        }
    }

    fn stroke(&mut self, shape: Shape<'_>, width: f64, color: Color) {
        if let Some(path) = self.path(|mut emit| outline(shape, &mut emit)) {
            self.stroke_path(path, width, LineCap::Butt, color);
        }
    }

    fn text(&mut self, text: &str, position: Point, size: f64, align: Align, color: Color) {
        if let Some(path) = self.path(|mut emit| font::outline(text, position, size, align, &mut emit)) {
            self.stroke_path(path, size * font::WEIGHT, LineCap::Round, color);
        }
    }

    fn push(&mut self, transform: Transform) {
        self.raster.transforms.push(transform);
    }

    fn pop(&mut self) {
        self.raster.transforms.pop();
    }
}

/// Whether all points of a path, scaled, are numbers within [`REACH`].
fn within_reach(path: &Path, scale: f32) -> bool {
    path.points().iter().all(|point| point.x.abs() * scale <= REACH && point.y.abs() * scale <= REACH)
}

fn append(builder: &mut PathBuilder, segment: Segment) {
    let xy = |[x, y]: Point| (x as f32, y as f32);
    match segment {
        Segment::Move(to) => {
            let (x, y) = xy(to);
            builder.move_to(x, y);
        }
        Segment::Line(to) => {
            let (x, y) = xy(to);
            builder.line_to(x, y);
        }
        Segment::Quad(control, to) => {
            let ((x1, y1), (x, y)) = (xy(control), xy(to));
            builder.quad_to(x1, y1, x, y);
        }
        Segment::Cubic(control1, control2, to) => {
            let ((x1, y1), (x2, y2), (x, y)) = (xy(control1), xy(control2), xy(to));
            builder.cubic_to(x1, y1, x2, y2, x, y);
        }
        Segment::Close => builder.close(),
    }
}

fn skia_transform(Transform { x, y, origin }: Transform) -> tiny_skia::Transform {
    let [sx, ky, kx, sy, tx, ty] = [x[0], x[1], y[0], y[1], origin[0], origin[1]].map(|v| v as f32);
    tiny_skia::Transform::from_row(sx, ky, kx, sy, tx, ty)
}
