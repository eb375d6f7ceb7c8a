//! A canvas that writes down the calls of a drawing.

use std::fmt::{self, Write as _};

use gym_core::canvas::{Align, Canvas, Color, Point, Segment, Shape, Transform};
use gym_core::{BoxEnv, Env};

/// The calls that draw an environment.
#[derive(Default)]
pub(crate) struct Calls {
    /// Every call with its arguments, to the last bit. Some drawings have thousands of calls, and a
    /// comparison of bytes takes a tenth of the time of a comparison of formatted text.
    pub(crate) record: Vec<u8>,
    pub(crate) count: usize,
    pub(crate) depth: usize,
    pub(crate) fault: Option<String>,
    text: Option<String>,
}

impl Calls {
    pub(crate) fn of(env: &BoxEnv) -> Self {
        let mut calls = Self::default();
        env.draw(&mut calls);
        calls
    }

    /// Returns the calls as text, with every digit, for messages.
    pub(crate) fn text(env: &BoxEnv) -> String {
        let mut calls = Self {
            text: Some(String::new()),
            ..Self::default()
        };
        env.draw(&mut calls);
        calls.text.unwrap_or_default()
    }

    /// Records a call: the whole call as text (`call`), a letter for the method (`name`), the
    /// arguments that are not numbers (`bytes`), and the numbers (`numbers`).
    fn call(&mut self, call: fmt::Arguments<'_>, name: u8, bytes: &[u8], numbers: &[f64]) {
        self.count += 1;
        if !numbers.iter().all(|x| x.is_finite()) {
            self.fault
                .get_or_insert_with(|| format!("a number that is not finite is drawn: {call}"));
        }
        self.record.push(name);
        for len in [bytes.len(), numbers.len()] {
            self.record.extend(len.to_le_bytes());
        }
        self.record.extend(bytes);
        for x in numbers {
            // every NaN counts as equal: the check `drawing-sound` reports it
            let x = if x.is_nan() { f64::NAN } else { *x };
            self.record.extend(x.to_bits().to_le_bytes());
        }
        if let Some(text) = &mut self.text {
            // writing to a `String` cannot fail
            let _ = writeln!(text, "{call}");
        }
    }
}

/// Returns the kind of `shape`, the kinds of its segments, and `color`.
fn kinds(shape: &Shape<'_>, color: Color) -> Vec<u8> {
    let mut kinds = color_bytes(color).to_vec();
    kinds.push(match shape {
        Shape::Polygon(_) => 0,
        Shape::Polyline(_) => 1,
        Shape::Circle { .. } => 2,
        Shape::Rect { .. } => 3,
        Shape::Path(_) => 4,
    });
    if let Shape::Path(segments) = shape {
        kinds.extend(segments.iter().map(|segment| match segment {
            Segment::Move(_) => 0,
            Segment::Line(_) => 1,
            Segment::Quad(..) => 2,
            Segment::Cubic(..) => 3,
            Segment::Close => 4,
        }));
    }
    kinds
}

fn color_bytes(color: Color) -> [u8; 4] {
    let Color { r, g, b, a } = color;
    [r, g, b, a]
}

/// Returns the coordinates and sizes of `shape`.
fn numbers(shape: &Shape<'_>) -> Vec<f64> {
    match *shape {
        Shape::Polygon(points) | Shape::Polyline(points) => points.as_flattened().to_vec(),
        Shape::Circle {
            center: [x, y],
            radius,
        } => vec![x, y, radius],
        Shape::Rect {
            min: [x, y],
            size: [w, h],
            corner,
        } => vec![x, y, w, h, corner],
        Shape::Path(segments) => {
            let points = segments.iter().flat_map(|segment| match *segment {
                Segment::Move(p) | Segment::Line(p) => vec![p],
                Segment::Quad(a, b) => vec![a, b],
                Segment::Cubic(a, b, c) => vec![a, b, c],
                Segment::Close => vec![],
            });
            points.flatten().collect()
        }
    }
}

impl Canvas for Calls {
    fn clear(&mut self, color: Color) {
        self.call(
            format_args!("clear {color:?}"),
            b'c',
            &color_bytes(color),
            &[],
        );
    }

    fn fill(&mut self, shape: Shape<'_>, color: Color) {
        self.call(
            format_args!("fill {shape:?} {color:?}"),
            b'f',
            &kinds(&shape, color),
            &numbers(&shape),
        );
    }

    fn stroke(&mut self, shape: Shape<'_>, width: f64, color: Color) {
        self.call(
            format_args!("stroke {shape:?} {width} {color:?}"),
            b's',
            &kinds(&shape, color),
            &[&numbers(&shape)[..], &[width]].concat(),
        );
    }

    fn text(&mut self, text: &str, position: Point, size: f64, align: Align, color: Color) {
        let [x, y] = position;
        let align_byte = match align {
            Align::Left => 0,
            Align::Center => 1,
            Align::Right => 2,
        };
        self.call(
            format_args!("text {text:?} {position:?} {size} {align:?} {color:?}"),
            b't',
            &[&color_bytes(color)[..], &[align_byte], text.as_bytes()].concat(),
            &[x, y, size],
        );
    }

    fn push(&mut self, transform: Transform) {
        let Transform { x, y, origin } = transform;
        self.call(
            format_args!("push {transform:?}"),
            b'p',
            &[],
            [x, y, origin].as_flattened(),
        );
        self.depth += 1;
    }

    fn pop(&mut self) {
        self.call(format_args!("pop"), b'q', &[], &[]);
        match self.depth.checked_sub(1) {
            Some(depth) => self.depth = depth,
            None => drop(
                self.fault
                    .get_or_insert_with(|| "a `pop` has no `push`".into()),
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Different calls have different records, and equal calls have equal records.
    #[test]
    fn records_tell_calls_apart() {
        let (black, grey) = (Color::rgb(0, 0, 0), Color::rgb(0, 0, 1));
        let points = [[0.0, 1.0], [2.0, 3.0]];
        let moves = [Segment::Move([0.0, 1.0]), Segment::Move([2.0, 3.0])];
        let lines = [Segment::Move([0.0, 1.0]), Segment::Line([2.0, 3.0])];
        let circle = Shape::Circle {
            center: [0.0, 1.0],
            radius: 2.0,
        };
        let rect = |size, corner| Shape::Rect {
            min: [0.0, 1.0],
            size,
            corner,
        };
        let curve = |b| [Segment::Quad([0.0, 1.0], b)];
        let (wide, high) = (curve([2.0, 1.0]), curve([0.0, 3.0]));
        let closed = [Segment::Move([0.0, 1.0]), Segment::Close];
        let turned = Transform {
            x: [0.0, 1.0],
            y: [-1.0, 0.0],
            origin: [0.0, 0.0],
        };
        let cubic = Segment::Cubic([0.0; 2], [1.0; 2], [2.0; 2]);
        let (curved, begun) = ([cubic, Segment::Close], [Segment::Close, cubic]);
        let near = [[0.0, 1.0_f64.next_up()], [2.0, 3.0]];
        let calls: [&dyn Fn(&mut Calls); 32] = [
            &|calls| calls.clear(black),
            &|calls| calls.clear(black.alpha(7)),
            &|calls| calls.fill(Shape::Polygon(&points), black),
            &|calls| calls.fill(Shape::Polygon(&points), grey),
            &|calls| calls.fill(Shape::Polyline(&points), black),
            &|calls| calls.fill(Shape::Polygon(&[[-0.0, 1.0], [2.0, 3.0]]), black),
            &|calls| calls.fill(Shape::Path(&moves), black),
            &|calls| calls.fill(Shape::Path(&lines), black),
            &|calls| calls.fill(circle, black),
            &|calls| calls.stroke(circle, 1.0, black),
            &|calls| calls.stroke(circle, 1.5, black),
            &|calls| calls.text("a", [0.0, 1.0], 2.0, Align::Left, black),
            &|calls| calls.text("a", [0.0, 1.0], 2.0, Align::Right, black),
            &|calls| calls.text("b", [0.0, 1.0], 2.0, Align::Left, black),
            &|calls| calls.text("a", [0.0, 1.0], 2.0, Align::Center, black),
            &|calls| calls.text("a", [0.5, 1.0], 2.0, Align::Left, black),
            &|calls| calls.text("a", [0.0, 1.5], 2.0, Align::Left, black),
            &|calls| calls.text("a", [0.0, 1.0], 2.5, Align::Left, black),
            &|calls| calls.text("a", [0.0, 1.0], 2.0, Align::Left, grey),
            // (as many bytes and numbers as the circle has)
            &|calls| calls.text("", [0.0, 1.0], 2.0, Align::Right, black),
            &|calls| calls.fill(rect([2.0, 3.0], 0.0), black),
            &|calls| calls.fill(rect([3.0, 2.0], 0.0), black),
            &|calls| calls.fill(rect([2.0, 3.0], 1.0), black),
            &|calls| calls.fill(Shape::Path(&wide), black),
            &|calls| calls.fill(Shape::Path(&high), black),
            &|calls| calls.fill(Shape::Path(&closed), black),
            &|calls| calls.fill(Shape::Path(&curved), black),
            &|calls| calls.fill(Shape::Path(&begun), black),
            &|calls| calls.fill(Shape::Polygon(&near), black),
            &|calls| calls.push(turned),
            &|calls| calls.push(Transform::IDENTITY),
            &|calls| calls.pop(),
        ];
        let record = |call: &dyn Fn(&mut Calls)| {
            let mut calls = Calls::default();
            call(&mut calls);
            calls.record
        };
        for (i, call) in calls.iter().enumerate() {
            assert_eq!(record(call), record(call), "call {i}");
            for (j, other) in calls[..i].iter().enumerate() {
                assert_ne!(record(call), record(other), "calls {i} and {j}");
            }
        }
    }
}
