//! Drawings as SVG.

use std::fmt::Write;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gym_core::Result;
use gym_core::canvas::{Align, Canvas, Color, Image, Point, Segment, Shape, Transform};

use crate::file;

use crate::font;
use crate::number::{Decimal, Pair, Rgb};
use crate::png;
use crate::transforms::Transforms;

/// Writes a drawing as a standalone SVG document.
///
/// Numbers are rounded to 3 decimals (in transforms to 6). Text is drawn as paths: it looks the
/// same everywhere and needs no font.
#[derive(Clone, Debug)]
pub struct Svg {
    size: (u32, u32),
    body: String,
    transforms: Transforms,
}

impl Svg {
    /// Makes an empty document of this width and height.
    pub fn new(size: (u32, u32)) -> Self {
        Self {
            size,
            body: String::new(),
            transforms: Transforms::new(),
        }
    }

    /// Returns the document.
    pub fn finish(self) -> String {
        let (width, height) = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" stroke-linejoin=\"round\">\n{}</svg>\n",
            self.body
        )
    }

    /// Appends an element with its style and the current transform.
    fn element(&mut self, element: &str, style: &str) {
        let transform = self.transforms.current();
        let _ = write!(self.body, "  <{element} {style}");
        if transform != Transform::IDENTITY {
            let Transform { x, y, origin } = transform;
            let [a, b, c, d, e, f] =
                [x[0], x[1], y[0], y[1], origin[0], origin[1]].map(Decimal::<6>);
            let _ = write!(self.body, " transform=\"matrix({a} {b} {c} {d} {e} {f})\"");
        }
        self.body.push_str("/>\n");
    }
}

impl Canvas for Svg {
    fn clear(&mut self, color: Color) {
        if color.a == 255 {
            self.body.clear();
        }
        let _ = writeln!(
            self.body,
            "  <rect width=\"100%\" height=\"100%\" {}/>",
            paint("fill", color)
        );
    }

    fn fill(&mut self, shape: Shape<'_>, color: Color) {
        self.element(&geometry(shape), &paint("fill", color));
    }

    fn stroke(&mut self, shape: Shape<'_>, width: f64, color: Color) {
        self.element(&geometry(shape), &stroke(width, color));
    }

    fn text(&mut self, text: &str, position: Point, size: f64, align: Align, color: Color) {
        let mut segments = Vec::new();
        font::outline(text, position, size, align, &mut |segment| {
            segments.push(segment);
        });
        let style = stroke(size * font::WEIGHT, color) + " stroke-linecap=\"round\"";
        self.element(&path(&segments), &style);
    }

    fn image(&mut self, image: Image<'_>) {
        // (an image without pixels cannot be encoded, and shows nothing)
        if let Ok(bytes) = png::image_bytes(image) {
            let [x, y, width, height] =
                [image.min[0], image.min[1], image.size[0], image.size[1]].map(Decimal::<3>);
            let place = format!("x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"");
            let data = STANDARD.encode(bytes);
            let style =
                format!("preserveAspectRatio=\"none\" href=\"data:image/png;base64,{data}\"");
            self.element(&format!("image {place}"), &style);
        }
    }

    fn push(&mut self, transform: Transform) {
        self.transforms.push(transform);
    }

    fn pop(&mut self) {
        self.transforms.pop();
    }
}

/// Returns a drawing as an SVG document.
///
/// ```
/// use gym_core::canvas::{Canvas, Color};
///
/// let document = gym_render::svg((20, 10), |canvas| {
///     canvas.clear(Color::WHITE);
///     canvas.circle([5.0, 5.0], 2.5, Color::BLACK);
/// });
/// assert!(document.contains("<circle cx=\"5\" cy=\"5\" r=\"2.5\" fill=\"#000000\"/>"));
/// ```
pub fn svg(size: (u32, u32), draw: impl FnOnce(&mut dyn Canvas)) -> String {
    let mut canvas = Svg::new(size);
    draw(&mut canvas);
    canvas.finish()
}

/// Writes a drawing to an SVG file.
///
/// # Errors
/// [`Error::Io`](gym_core::Error::Io) if the file cannot be written.
pub fn write_svg(
    path: impl AsRef<Path>,
    size: (u32, u32),
    draw: impl FnOnce(&mut dyn Canvas),
) -> Result<()> {
    file::write(path, svg(size, draw).as_bytes())
}

/// Returns the element name and the geometry attributes of a shape.
fn geometry(shape: Shape<'_>) -> String {
    let list = |points: &[Point]| {
        points
            .iter()
            .map(|&point| Pair(point).to_string())
            .collect::<Vec<_>>()
            .join(" ")
    };
    match shape {
        Shape::Polygon(points) => format!("polygon points=\"{}\"", list(points)),
        Shape::Polyline(points) => format!("polyline points=\"{}\"", list(points)),
        Shape::Circle { center, radius } => {
            let [cx, cy, r] = [center[0], center[1], radius].map(Decimal::<3>);
            format!("circle cx=\"{cx}\" cy=\"{cy}\" r=\"{r}\"")
        }
        Shape::Rect { min, size, corner } => {
            let [x, y, width, height] = [min[0], min[1], size[0], size[1]].map(Decimal::<3>);
            let rounding = if corner > 0.0 {
                format!(" rx=\"{}\"", Decimal::<3>(corner))
            } else {
                String::new()
            };
            format!("rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"{rounding}")
        }
        Shape::Path(segments) => path(segments),
    }
}

/// Returns a path element.
fn path(segments: &[Segment]) -> String {
    let mut data = String::new();
    for segment in segments {
        let _ = match *segment {
            Segment::Move(to) => write!(data, "M{}", Pair(to)),
            Segment::Line(to) => write!(data, "L{}", Pair(to)),
            Segment::Quad(control, to) => write!(data, "Q{} {}", Pair(control), Pair(to)),
            Segment::Cubic(a, b, to) => write!(data, "C{} {} {}", Pair(a), Pair(b), Pair(to)),
            Segment::Close => write!(data, "Z"),
        };
    }
    format!("path d=\"{data}\"")
}

/// Returns the attributes of a colour for `fill` or `stroke`.
fn paint(what: &str, color: Color) -> String {
    let opacity = f64::from(color.a) / 255.0;
    match color.a {
        255 => format!("{what}=\"{}\"", Rgb(color)),
        _ => format!(
            "{what}=\"{}\" {what}-opacity=\"{}\"",
            Rgb(color),
            Decimal::<3>(opacity)
        ),
    }
}

fn stroke(width: f64, color: Color) -> String {
    format!(
        "fill=\"none\" {} stroke-width=\"{}\"",
        paint("stroke", color),
        Decimal::<3>(width)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document() {
        let document = svg((60, 40), |canvas| {
            canvas.rect([0.0, 0.0], [9.0, 9.0], Color::BLACK);
            canvas.clear(Color::WHITE);
            canvas.push(Transform::y_up(40.0));
            canvas.line([0.0, 10.0], [60.0, 10.123_46], 1.5, Color::BLACK);
            canvas.pop();
            canvas.round_rect([1.0, 2.0], [3.0, 4.0], 0.5, Color::rgb(255, 0, 0).alpha(51));
            let triangle = [
                Segment::Move([0.0, 0.0]),
                Segment::Quad([1.0, 0.0], [1.0, 1.0]),
                Segment::Close,
            ];
            canvas.fill(Shape::Path(&triangle), Color::BLACK);
            canvas.text("l", [0.0, 20.0], 20.0, Align::Left, Color::BLACK);
        });
        let expected = "\
<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"60\" height=\"40\" viewBox=\"0 0 60 40\" stroke-linejoin=\"round\">
  <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>
  <polyline points=\"0,10 60,10.123\" fill=\"none\" stroke=\"#000000\" stroke-width=\"1.5\" transform=\"matrix(1 0 0 -1 0 40)\"/>
  <rect x=\"1\" y=\"2\" width=\"3\" height=\"4\" rx=\"0.5\" fill=\"#ff0000\" fill-opacity=\"0.2\"/>
  <path d=\"M0,0Q1,0 1,1Z\" fill=\"#000000\"/>
  <path d=\"M1.25,0L1.25,17C1.25,18.657 2.593,20 4.25,20\" fill=\"none\" stroke=\"#000000\" stroke-width=\"2.5\" stroke-linecap=\"round\"/>
</svg>
";
        assert_eq!(document, expected);
    }

    #[test]
    fn a_translucent_clear_keeps_what_is_below() {
        let document = svg((1, 1), |canvas| {
            canvas.circle([0.0, 0.0], 1.0, Color::BLACK);
            canvas.clear(Color::WHITE.alpha(128));
        });
        assert!(document.contains("circle") && document.contains("fill-opacity=\"0.502\""));
    }
}
