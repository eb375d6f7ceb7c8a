//! The drawing surface of environments: a few vector shapes, at any size.
//!
//! An environment draws in the pixels of its own frame size (see
//! [`Metadata`](crate::render::Metadata)), origin top left, y down. The canvas decides the real
//! size: `gym-render` has one for pixels, one for SVG, and one that records calls.
//!
//! Environments that look like Gymnasium's pass the arguments of its pygame calls
//! ([`Canvas::pygame`]): at Gymnasium's size `gym-render` repeats pygame's pixels, at other sizes
//! it draws antialiased shapes. `draw` changes nothing; state that advances per frame is updated in
//! a method of its own.

use std::f64::consts::PI;
use std::fmt::{self, Write};
use std::ops::Deref;

use gym_numerics::math;

pub use super::image::Image;
use super::image::rectangles;

/// A point or a vector: `[x, y]`.
pub type Point = [f64; 2];

/// An opaque or translucent colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Color {
    /// Red, 0 to 255.
    pub r: u8,
    /// Green, 0 to 255.
    pub g: u8,
    /// Blue, 0 to 255.
    pub b: u8,
    /// 0 transparent, 255 opaque.
    pub a: u8,
}

impl Color {
    /// Black.
    pub const BLACK: Self = Self::rgb(0, 0, 0);
    /// White.
    pub const WHITE: Self = Self::rgb(255, 255, 255);

    /// An opaque colour.
    pub const fn rgb(r: u8, g: u8, b: u8) -> Self {
        Self { r, g, b, a: 255 }
    }

    /// The same colour, translucent.
    #[must_use]
    pub const fn alpha(self, a: u8) -> Self {
        Self { a, ..self }
    }
}

/// One piece of a [`Shape::Path`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment {
    /// Starts a new contour.
    Move(Point),
    /// A straight line.
    Line(Point),
    /// A quadratic Bézier curve: control point, end.
    Quad(Point, Point),
    /// A cubic Bézier curve: two control points, end.
    Cubic(Point, Point, Point),
    /// Back to the start of the contour.
    Close,
}

/// A shape to fill or stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape<'a> {
    /// Points joined by straight lines, closed.
    Polygon(&'a [Point]),
    /// Points joined by straight lines, open.
    Polyline(&'a [Point]),
    /// A circle.
    Circle {
        /// Its centre.
        center: Point,
        /// Its radius.
        radius: f64,
    },
    /// A rectangle with sides along the axes.
    Rect {
        /// The corner with the smallest coordinates.
        min: Point,
        /// Width and height.
        size: Point,
        /// Radius of the corners; 0 for sharp ones.
        corner: f64,
    },
    /// Any outline.
    Path(&'a [Segment]),
}

/// One call of pygame, with its numbers as Gymnasium passes them: coordinates name the centres of
/// pixels.
///
/// A canvas at Gymnasium's own size draws them as pygame does, to the last bit; any other draws
/// similar smooth shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive<'a> {
    /// `gfxdraw.hline`: the pixels of a row between two columns.
    HLine {
        /// An end.
        x1: f64,
        /// The other end.
        x2: f64,
        /// The row.
        y: f64,
    },
    /// `gfxdraw.vline`: the pixels of a column between two rows.
    VLine {
        /// The column.
        x: f64,
        /// An end.
        y1: f64,
        /// The other end.
        y2: f64,
    },
    /// `gfxdraw.aapolygon`: the smoothed outline of a polygon.
    AaPolygon(&'a [Point]),
    /// `gfxdraw.filled_polygon`: the inside of a polygon.
    FilledPolygon(&'a [Point]),
    /// `gfxdraw.aacircle`: the smoothed outline of a circle.
    AaCircle {
        /// Its centre.
        center: Point,
        /// Its radius.
        radius: f64,
    },
    /// `gfxdraw.filled_circle`: a circle with its outline.
    FilledCircle {
        /// Its centre.
        center: Point,
        /// Its radius.
        radius: f64,
    },
    /// `draw.polygon` of width 0: a polygon with its outline.
    Polygon(&'a [Point]),
    /// `draw.line`, `draw.lines`, and `draw.polygon` of a width above 0: lines between points.
    Lines {
        /// The points.
        points: &'a [Point],
        /// Whether a line leads from the last to the first.
        closed: bool,
        /// In pixels.
        width: u32,
    },
    /// `draw.circle`: a circle about a corner of pixels.
    Circle {
        /// Its centre.
        center: Point,
        /// Its radius.
        radius: f64,
    },
    /// `draw.aaline` and `draw.aalines`: smoothed lines between points.
    AaLines {
        /// The points.
        points: &'a [Point],
        /// Whether a line leads from the last to the first.
        closed: bool,
    },
}

/// The horizontal anchor of a text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// The position is the left end of the baseline.
    #[default]
    Left,
    /// The position is the middle of the baseline.
    Center,
    /// The position is the right end of the baseline.
    Right,
}

/// A change of coordinates: a point `p` of the inner coordinates lies at `x*p.x + y*p.y + origin`
/// of the outer ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// The inner x unit vector, in outer coordinates.
    pub x: Point,
    /// The inner y unit vector, in outer coordinates.
    pub y: Point,
    /// The inner origin, in outer coordinates.
    pub origin: Point,
}

impl Transform {
    /// No change.
    pub const IDENTITY: Self = Self {
        x: [1.0, 0.0],
        y: [0.0, 1.0],
        origin: [0.0, 0.0],
    };

    /// Moves the origin.
    pub const fn translate(dx: f64, dy: f64) -> Self {
        Self {
            origin: [dx, dy],
            ..Self::IDENTITY
        }
    }

    /// Scales both axes about the origin.
    pub const fn scale(sx: f64, sy: f64) -> Self {
        Self {
            x: [sx, 0.0],
            y: [0.0, sy],
            ..Self::IDENTITY
        }
    }

    /// Turns about the origin, from x towards y.
    pub fn rotate(radians: f64) -> Self {
        let (sin, cos) = math::sin_cos(radians);
        Self {
            x: [cos, sin],
            y: [-sin, cos],
            origin: [0.0, 0.0],
        }
    }

    /// y up, with the origin at the bottom left of a picture of that height.
    pub const fn y_up(height: f64) -> Self {
        Self {
            x: [1.0, 0.0],
            y: [0.0, -1.0],
            origin: [0.0, height],
        }
    }

    /// `inner` within `self`.
    #[must_use]
    pub fn then(self, inner: Self) -> Self {
        let vector = |[a, b]: Point| [self.x[0] * a + self.y[0] * b, self.x[1] * a + self.y[1] * b];
        Self {
            x: vector(inner.x),
            y: vector(inner.y),
            origin: self.apply(inner.origin),
        }
    }

    /// The outer coordinates of an inner point.
    pub fn apply(self, [a, b]: Point) -> Point {
        [
            self.x[0] * a + self.y[0] * b + self.origin[0],
            self.x[1] * a + self.y[1] * b + self.origin[1],
        ]
    }
}

/// A surface to draw on. A back end implements the required methods; the others are shorthands.
pub trait Canvas {
    /// Covers everything in one colour.
    fn clear(&mut self, color: Color);

    /// Fills a shape (rule: nonzero winding).
    fn fill(&mut self, shape: Shape<'_>, color: Color);

    /// Draws a shape's outline with round joins and butt ends.
    fn stroke(&mut self, shape: Shape<'_>, width: f64, color: Color);

    /// Writes one line of text; `size` is the height of a capital letter and `position` lies on
    /// the baseline. Text is upright in a y-down picture.
    fn text(&mut self, text: &str, position: Point, size: f64, align: Align, color: Color);

    /// Draws in inner coordinates until the matching [`pop`](Canvas::pop).
    fn push(&mut self, transform: Transform);

    /// Returns to the coordinates before the last [`push`](Canvas::push).
    fn pop(&mut self);

    /// Draws one of pygame's calls; see [`crate::pygame`] for the coordinates.
    fn pygame(&mut self, primitive: Primitive<'_>, color: Color) {
        smooth(self, primitive, color);
    }

    /// Draws on a surface of the size `from` until the matching [`pop`](Canvas::pop); pygame's
    /// `smoothscale` then shrinks it to the size `to`, in the pixels of this canvas.
    fn push_smoothscaled(&mut self, from: (u32, u32), to: (u32, u32)) {
        let scale = |from: u32, to: u32| f64::from(to) / f64::from(from.max(1));
        self.push(Transform::scale(scale(from.0, to.0), scale(from.1, to.1)));
    }

    /// Draws an image.
    fn image(&mut self, image: Image<'_>) {
        rectangles(self, image);
    }

    /// The number of pixels of the result for a unit of length: an image of so many is sharp.
    fn resolution(&self) -> f64 {
        1.0
    }

    /// Fills a polygon.
    fn polygon(&mut self, points: &[Point], color: Color) {
        self.fill(Shape::Polygon(points), color);
    }

    /// Draws a straight line.
    fn line(&mut self, from: Point, to: Point, width: f64, color: Color) {
        self.stroke(Shape::Polyline(&[from, to]), width, color);
    }

    /// Fills a circle.
    fn circle(&mut self, center: Point, radius: f64, color: Color) {
        self.fill(Shape::Circle { center, radius }, color);
    }

    /// Fills a rectangle with sharp corners.
    fn rect(&mut self, min: Point, size: Point, color: Color) {
        self.fill(
            Shape::Rect {
                min,
                size,
                corner: 0.0,
            },
            color,
        );
    }

    /// Fills a rectangle with round corners.
    fn round_rect(&mut self, min: Point, size: Point, corner: f64, color: Color) {
        self.fill(Shape::Rect { min, size, corner }, color);
    }
}

/// Draws one of pygame's calls as smooth shapes.
pub fn smooth<C: Canvas + ?Sized>(canvas: &mut C, primitive: Primitive<'_>, color: Color) {
    const THIN: f64 = 1.0;
    match primitive {
        Primitive::HLine { x1, x2, y } => {
            canvas.stroke(
                Shape::Polyline(&[[x1 - 0.5, y], [x2 + 0.5, y]]),
                THIN,
                color,
            );
        }
        Primitive::VLine { x, y1, y2 } => {
            let [y1, y2] = [y1.min(y2) - 0.5, y1.max(y2) + 0.5];
            canvas.stroke(Shape::Polyline(&[[x, y1], [x, y2]]), THIN, color);
        }
        Primitive::FilledPolygon(points) => canvas.fill(Shape::Polygon(points), color),
        // the polygon includes the pixels on its edges, which extend half a pixel beyond the edges
        Primitive::Polygon(points) => {
            canvas.fill(Shape::Polygon(points), color);
            canvas.stroke(Shape::Polygon(points), THIN, color);
        }
        Primitive::AaPolygon(points)
        | Primitive::AaLines {
            points,
            closed: true,
        } => {
            canvas.stroke(Shape::Polygon(points), THIN, color);
        }
        Primitive::AaLines {
            points,
            closed: false,
        } => canvas.stroke(Shape::Polyline(points), THIN, color),
        Primitive::Lines {
            points,
            closed,
            width,
        } => {
            let shape = if closed {
                Shape::Polygon(points)
            } else {
                Shape::Polyline(points)
            };
            canvas.stroke(shape, f64::from(width), color);
        }
        // callers draw this outline together with a filled circle, which includes the outline
        Primitive::AaCircle { .. } => {}
        Primitive::FilledCircle { center, radius } => {
            canvas.fill(
                Shape::Circle {
                    center,
                    radius: radius + 0.5,
                },
                color,
            );
        }
        Primitive::Circle {
            center: [x, y],
            radius,
        } => {
            canvas.fill(
                Shape::Circle {
                    center: [x - 0.5, y - 0.5],
                    radius,
                },
                color,
            );
        }
    }
}

/// A canvas that draws nothing: for timing a drawing, or checking that it does not fail.
#[derive(Clone, Copy, Debug, Default)]
pub struct Blank;

impl Canvas for Blank {
    fn clear(&mut self, _color: Color) {}
    fn fill(&mut self, _shape: Shape<'_>, _color: Color) {}
    fn stroke(&mut self, _shape: Shape<'_>, _width: f64, _color: Color) {}
    fn text(&mut self, _text: &str, _position: Point, _size: f64, _align: Align, _color: Color) {}
    fn push(&mut self, _transform: Transform) {}
    fn pop(&mut self) {}
    fn pygame(&mut self, _primitive: Primitive<'_>, _color: Color) {}
}

/// The points of an arc around `center`, from angle `start` to `end` in radians, both included.
pub fn arc<const N: usize>(center: Point, radius: f64, start: f64, end: f64) -> [Point; N] {
    std::array::from_fn(|i| {
        let angle = start + (end - start) * i as f64 / (N.max(2) - 1) as f64;
        [
            center[0] + radius * math::cos(angle),
            center[1] + radius * math::sin(angle),
        ]
    })
}

/// A short text, such as a number to draw, without allocation: `Label::new(format_args!("{n}"))`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Label {
    bytes: [u8; 24],
    len: usize,
}

impl Label {
    /// The text, truncated to what fits.
    pub fn new(text: fmt::Arguments<'_>) -> Self {
        let mut label = Self::default();
        // the only error is a full buffer
        let _ = label.write_fmt(text);
        label
    }
}

impl Write for Label {
    fn write_str(&mut self, piece: &str) -> fmt::Result {
        let free = self
            .bytes
            .get_mut(self.len..self.len + piece.len())
            .ok_or(fmt::Error)?;
        free.copy_from_slice(piece.as_bytes());
        self.len += piece.len();
        Ok(())
    }
}

impl Deref for Label {
    type Target = str;

    fn deref(&self) -> &str {
        std::str::from_utf8(&self.bytes[..self.len]).unwrap_or_default()
    }
}

/// A whole turn.
pub const TURN: f64 = 2.0 * PI;

#[cfg(test)]
mod tests {
    use super::*;

    /// A canvas that records the filled shapes, and the stroked shapes with their widths.
    #[derive(Default)]
    struct Drawn(Vec<String>);

    fn described(shape: Shape<'_>, width: Option<f64>) -> String {
        format!("{shape:?}, {width:?}")
    }

    impl Canvas for Drawn {
        fn clear(&mut self, _color: Color) {}
        fn fill(&mut self, shape: Shape<'_>, _color: Color) {
            self.0.push(described(shape, None));
        }
        fn stroke(&mut self, shape: Shape<'_>, width: f64, _color: Color) {
            self.0.push(described(shape, Some(width)));
        }
        fn text(
            &mut self,
            _text: &str,
            _position: Point,
            _size: f64,
            _align: Align,
            _color: Color,
        ) {
        }
        fn push(&mut self, _transform: Transform) {}
        fn pop(&mut self) {}
    }

    /// Lines reach half a pixel beyond the middles of their ends, and a filled circle half a pixel
    /// beyond its radius.
    #[test]
    fn every_primitive_has_its_smooth_shapes() {
        let points = &[[1.0, 1.0], [9.0, 2.0], [5.0, 8.0]];
        let (center, radius) = ([5.0, 5.0], 3.0);
        let (polygon, line) = (Shape::Polygon(points), Shape::Polyline(points));
        let circle = |center, radius| Shape::Circle { center, radius };
        let upright = Shape::Polyline(&[[1.0, 1.5], [1.0, 5.5]]);
        for (primitive, expected) in [
            (
                Primitive::HLine {
                    x1: 1.0,
                    x2: 4.0,
                    y: 2.0,
                },
                &[(Shape::Polyline(&[[0.5, 2.0], [4.5, 2.0]]), Some(1.0))][..],
            ),
            (
                Primitive::VLine {
                    x: 1.0,
                    y1: 2.0,
                    y2: 5.0,
                },
                &[(upright, Some(1.0))],
            ),
            (
                Primitive::VLine {
                    x: 1.0,
                    y1: 5.0,
                    y2: 2.0,
                },
                &[(upright, Some(1.0))],
            ),
            (Primitive::FilledPolygon(points), &[(polygon, None)]),
            (
                Primitive::Polygon(points),
                &[(polygon, None), (polygon, Some(1.0))],
            ),
            (Primitive::AaPolygon(points), &[(polygon, Some(1.0))]),
            (
                Primitive::AaLines {
                    points,
                    closed: true,
                },
                &[(polygon, Some(1.0))],
            ),
            (
                Primitive::AaLines {
                    points,
                    closed: false,
                },
                &[(line, Some(1.0))],
            ),
            (
                Primitive::Lines {
                    points,
                    closed: true,
                    width: 2,
                },
                &[(polygon, Some(2.0))],
            ),
            (
                Primitive::Lines {
                    points,
                    closed: false,
                    width: 3,
                },
                &[(line, Some(3.0))],
            ),
            (
                Primitive::FilledCircle { center, radius },
                &[(circle(center, 3.5), None)],
            ),
            (
                Primitive::Circle { center, radius },
                &[(circle([4.5, 4.5], 3.0), None)],
            ),
            // the filled circle includes this outline
            (Primitive::AaCircle { center, radius }, &[]),
        ] {
            let mut drawn = Drawn::default();
            smooth(&mut drawn, primitive, Color::rgb(0, 0, 0));
            let expected: Vec<_> = expected
                .iter()
                .map(|(shape, width)| described(*shape, *width))
                .collect();
            assert_eq!(drawn.0, expected, "{primitive:?}");
        }
    }

    #[test]
    fn labels_hold_what_fits() {
        assert_eq!(&*Label::new(format_args!("{:04.0} m", 12.3)), "0012 m");
        assert_eq!(
            &*Label::new(format_args!("{}{}", "x".repeat(20), "12345")),
            "x".repeat(20)
        );
        assert_eq!(&*Label::default(), "");
    }
}
