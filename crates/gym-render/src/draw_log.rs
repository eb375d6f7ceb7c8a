//! Drawings as text, for tests.

use std::fmt::{self, Write};

use gym_core::canvas::{Align, Canvas, Color, Image, Point, Primitive, Segment, Shape, Transform};

use crate::number::{Decimal, Pair, Rgb};

/// The calls of a drawing as lines of text, with numbers rounded to 3 decimals: tests compare calls
/// rather than pixels.
///
/// ```
/// use gym_core::canvas::{Canvas, Color, Transform};
/// use gym_render::DrawLog;
///
/// let log = DrawLog::of(|canvas| {
///     canvas.clear(Color::WHITE);
///     canvas.push(Transform::translate(10.0, 0.0));
///     canvas.line([0.0, 0.5], [1.0, 2.0 / 3.0], 2.0, Color::BLACK.alpha(128));
///     canvas.pop();
/// });
/// assert_eq!(
///     log.to_string(),
///     "clear #ffffff\n\
///      push x=1,0 y=0,1 origin=10,0\n  \
///        stroke polyline 0,0.5 1,0.667 width=2 #00000080\n\
///      pop\n"
/// );
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DrawLog {
    text: String,
    depth: usize,
}

impl DrawLog {
    /// Records the calls that `draw` makes.
    pub fn of(draw: impl FnOnce(&mut dyn Canvas)) -> Self {
        let mut log = Self::default();
        draw(&mut log);
        log
    }

    fn line(&mut self, line: fmt::Arguments<'_>) {
        // writing to a string cannot fail
        let _ = writeln!(self.text, "{:1$}{line}", "", 2 * self.depth);
    }
}

impl fmt::Display for DrawLog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Canvas for DrawLog {
    fn clear(&mut self, color: Color) {
        self.line(format_args!("clear {}", Rgba(color)));
    }

    fn fill(&mut self, shape: Shape<'_>, color: Color) {
        self.line(format_args!("fill {} {}", Geometry(shape), Rgba(color)));
    }

    fn stroke(&mut self, shape: Shape<'_>, width: f64, color: Color) {
        self.line(format_args!(
            "stroke {} width={} {}",
            Geometry(shape),
            Decimal::<3>(width),
            Rgba(color)
        ));
    }

    fn text(&mut self, text: &str, position: Point, size: f64, align: Align, color: Color) {
        let align = match align {
            Align::Left => "left",
            Align::Center => "center",
            Align::Right => "right",
        };
        let (position, size) = (Pair(position), Decimal::<3>(size));
        self.line(format_args!(
            "text {text:?} {position} size={size} {align} {}",
            Rgba(color)
        ));
    }

    fn image(&mut self, image: Image<'_>) {
        let mut sum = crc32fast::Hasher::new();
        for Color { r, g, b, a } in image.pixels {
            sum.update(&[*r, *g, *b, *a]);
        }
        let (min, size) = (Pair(image.min), Pair(image.size));
        self.line(format_args!(
            "image {min} size={size} pixels={}x{} crc={:08x}",
            image.width,
            image.rows().len(),
            sum.finalize()
        ));
    }

    fn push(&mut self, Transform { x, y, origin }: Transform) {
        self.line(format_args!(
            "push x={} y={} origin={}",
            Pair(x),
            Pair(y),
            Pair(origin)
        ));
        self.depth += 1;
    }

    fn push_smoothscaled(&mut self, from: (u32, u32), to: (u32, u32)) {
        self.line(format_args!(
            "push smoothscaled {}x{} to {}x{}",
            from.0, from.1, to.0, to.1
        ));
        self.depth += 1;
    }

    fn pygame(&mut self, primitive: Primitive<'_>, color: Color) {
        self.line(format_args!("pygame {} {}", Call(primitive), Rgba(color)));
    }

    fn pop(&mut self) {
        self.depth = self.depth.saturating_sub(1);
        self.line(format_args!("pop"));
    }
}

/// Writes `#rrggbb`, or `#rrggbbaa` if translucent.
struct Rgba(Color);

impl fmt::Display for Rgba {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let color = self.0;
        write!(f, "{}", Rgb(color))?;
        if color.a == 255 {
            Ok(())
        } else {
            write!(f, "{:02x}", color.a)
        }
    }
}

struct Geometry<'a>(Shape<'a>);

impl fmt::Display for Geometry<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Shape::Polygon(points) => list(f, "polygon", points),
            Shape::Polyline(points) => list(f, "polyline", points),
            Shape::Circle { center, radius } => {
                write!(f, "circle {} radius={}", Pair(center), Decimal::<3>(radius))
            }
            Shape::Rect { min, size, corner } => {
                write!(f, "rect {} size={}", Pair(min), Pair(size))?;
                if corner == 0.0 {
                    Ok(())
                } else {
                    write!(f, " corner={}", Decimal::<3>(corner))
                }
            }
            Shape::Path(segments) => {
                f.write_str("path")?;
                segments.iter().try_for_each(|segment| match *segment {
                    Segment::Move(to) => write!(f, " move {}", Pair(to)),
                    Segment::Line(to) => write!(f, " line {}", Pair(to)),
                    Segment::Quad(control, to) => write!(f, " quad {} {}", Pair(control), Pair(to)),
                    Segment::Cubic(a, b, to) => {
                        write!(f, " cubic {} {} {}", Pair(a), Pair(b), Pair(to))
                    }
                    Segment::Close => write!(f, " close"),
                })
            }
        }
    }
}

/// Writes a call of pygame with pygame's name.
struct Call<'a>(Primitive<'a>);

impl fmt::Display for Call<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let disc = |f: &mut fmt::Formatter<'_>, name, center, radius| {
            write!(f, "{name} {} radius={}", Pair(center), Decimal::<3>(radius))
        };
        let number = Decimal::<3>;
        match self.0 {
            Primitive::HLine { x1, x2, y } => {
                write!(f, "hline {} {} y={}", number(x1), number(x2), number(y))
            }
            Primitive::VLine { x, y1, y2 } => {
                write!(f, "vline {} {} x={}", number(y1), number(y2), number(x))
            }
            Primitive::AaPolygon(points) => list(f, "aapolygon", points),
            Primitive::FilledPolygon(points) => list(f, "filled_polygon", points),
            Primitive::Polygon(points) => list(f, "polygon", points),
            Primitive::AaCircle { center, radius } => disc(f, "aacircle", center, radius),
            Primitive::FilledCircle { center, radius } => disc(f, "filled_circle", center, radius),
            Primitive::Circle { center, radius } => disc(f, "circle", center, radius),
            Primitive::Lines {
                points,
                closed,
                width,
            } => {
                list(f, if closed { "closed lines" } else { "lines" }, points)?;
                write!(f, " width={width}")
            }
            Primitive::AaLines { points, closed } => {
                list(f, if closed { "closed aalines" } else { "aalines" }, points)
            }
        }
    }
}

fn list(f: &mut fmt::Formatter<'_>, name: &str, points: &[Point]) -> fmt::Result {
    f.write_str(name)?;
    points
        .iter()
        .try_for_each(|&point| write!(f, " {}", Pair(point)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_call_is_a_line() {
        let log = DrawLog::of(|canvas| {
            canvas.clear(Color::WHITE);
            canvas.push(Transform::y_up(400.0));
            canvas.push(Transform::rotate(0.5));
            canvas.polygon(
                &[[0.0, 0.0], [1.0, 0.000_49], [1.0, -0.000_49]],
                Color::rgb(129, 132, 203),
            );
            canvas.pop();
            canvas.circle([1.5, 2.0], 3.0, Color::BLACK);
            canvas.pop();
            canvas.pop();
            canvas.rect([0.0, 1.0], [2.0, 3.0], Color::BLACK.alpha(1));
            canvas.round_rect([0.0, 1.0], [2.0, 3.0], 0.5, Color::BLACK);
            canvas.text("a \"b\"\n", [1.0, 2.0], 12.0, Align::Right, Color::BLACK);
            let path = [
                Segment::Move([0.0, 0.0]),
                Segment::Line([1.0, 0.0]),
                Segment::Quad([2.0, 0.0], [2.0, 1.0]),
                Segment::Cubic([2.0, 2.0], [1.0, 2.0], [0.0, 2.0]),
                Segment::Close,
            ];
            canvas.stroke(Shape::Path(&path), 0.25, Color::BLACK);
        });
        let expected = r##"clear #ffffff
push x=1,0 y=0,-1 origin=0,400
  push x=0.878,0.479 y=-0.479,0.878 origin=0,0
    fill polygon 0,0 1,0 1,0 #8184cb
  pop
  fill circle 1.5,2 radius=3 #000000
pop
pop
fill rect 0,1 size=2,3 #00000001
fill rect 0,1 size=2,3 corner=0.5 #000000
text "a \"b\"\n" 1,2 size=12 right #000000
stroke path move 0,0 line 1,0 quad 2,0 2,1 cubic 2,2 1,2 0,2 close width=0.25 #000000
"##;
        assert_eq!(log.to_string(), expected);
    }
}
