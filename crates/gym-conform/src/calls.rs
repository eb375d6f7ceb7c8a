//! A canvas that writes down the calls of a drawing.

use gym_core::canvas::{Align, Canvas, Color, Point, Segment, Shape, Transform};
use gym_core::{BoxEnv, Env};

/// The calls of a drawing as text, with every digit.
#[derive(Default)]
pub(crate) struct Calls {
    pub(crate) text: String,
    pub(crate) count: usize,
    pub(crate) depth: usize,
    pub(crate) fault: Option<String>,
}

impl Calls {
    pub(crate) fn of(env: &BoxEnv) -> Self {
        let mut calls = Self::default();
        env.draw(&mut calls);
        calls
    }

    fn call(&mut self, call: &str, numbers: &[f64]) {
        self.count += 1;
        if !numbers.iter().all(|x| x.is_finite()) {
            self.fault
                .get_or_insert_with(|| format!("a number that is not finite is drawn: {call}"));
        }
        self.text += call;
        self.text.push('\n');
    }
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
        self.call(&format!("clear {color:?}"), &[]);
    }

    fn fill(&mut self, shape: Shape<'_>, color: Color) {
        self.call(&format!("fill {shape:?} {color:?}"), &numbers(&shape));
    }

    fn stroke(&mut self, shape: Shape<'_>, width: f64, color: Color) {
        self.call(
            &format!("stroke {shape:?} {width} {color:?}"),
            &[&numbers(&shape)[..], &[width]].concat(),
        );
    }

    fn text(&mut self, text: &str, position: Point, size: f64, align: Align, color: Color) {
        let [x, y] = position;
        self.call(
            &format!("text {text:?} {position:?} {size} {align:?} {color:?}"),
            &[x, y, size],
        );
    }

    fn push(&mut self, transform: Transform) {
        let Transform { x, y, origin } = transform;
        self.call(
            &format!("push {transform:?}"),
            [x, y, origin].as_flattened(),
        );
        self.depth += 1;
    }

    fn pop(&mut self) {
        self.call("pop", &[]);
        match self.depth.checked_sub(1) {
            Some(depth) => self.depth = depth,
            None => drop(
                self.fault
                    .get_or_insert_with(|| "a `pop` has no `push`".into()),
            ),
        }
    }
}
