//! Lines of a width, as outlines.
//!
//! Every straight piece becomes a rectangle and every bend a sector, all of one orientation, so that
//! the nonzero winding rule makes them one.

use gym_core::canvas::{Point, Transform};

use crate::coverage::Coverage;
use crate::flatten::{Pen, TOLERANCE};

/// A pen with a width, in inner coordinates. Bends are round.
#[derive(Debug)]
pub(crate) struct Stroker<'a> {
    coverage: &'a mut Coverage,
    transform: Transform,
    radius: f64,
    /// Whether ends are round, or else straight.
    round_ends: bool,
    /// How far an arc may be from the lines it is cut into.
    tolerance: f64,
    start: Point,
    at: Point,
    /// The directions of the contour's first and last piece, once there is one.
    ends: Option<[Point; 2]>,
}

impl<'a> Stroker<'a> {
    /// A pen of that width, where a unit is so many pixels long.
    pub(crate) fn new(
        coverage: &'a mut Coverage,
        transform: Transform,
        width: f64,
        round_ends: bool,
        scale: f64,
    ) -> Self {
        Self {
            coverage,
            transform,
            radius: width / 2.0,
            round_ends,
            tolerance: TOLERANCE / scale,
            start: [0.0; 2],
            at: [0.0; 2],
            ends: None,
        }
    }

    /// Ends an open contour; the last one needs it too.
    pub(crate) fn end(&mut self) {
        if let Some([first, last]) = self.ends.take()
            && self.round_ends
        {
            self.half_circle(self.start, times(first, -1.0));
            self.half_circle(self.at, last);
        }
    }

    /// The half of a circle around `center` that lies in that direction.
    fn half_circle(&mut self, center: Point, direction: Point) {
        let (side, top) = (times(left(direction), self.radius), times(direction, self.radius));
        self.move_to_outline(plus(center, side));
        self.arc(center, side, top);
        self.arc(center, top, times(side, -1.0));
    }

    /// Fills the gap at the outer side of a bend.
    fn bend(&mut self, center: Point, before: Point, after: Point) {
        let turn = before[0] * after[1] - before[1] * after[0];
        // on the side away from the turn, and in the orientation of the rectangles
        let (from, to, radius) =
            if turn > 0.0 { (after, before, -self.radius) } else { (before, after, self.radius) };
        let (from, to) = (times(left(from), radius), times(left(to), radius));
        if length(minus(from, to)) < self.tolerance {
            return;
        }
        self.move_to_outline(center);
        self.line_to_outline(plus(center, from));
        if before[0] * after[0] + before[1] * after[1] < 0.0 {
            let middle = minus(before, after);
            let middle = times(middle, self.radius / length(middle));
            self.arc(center, from, middle);
            self.arc(center, middle, to);
        } else {
            self.arc(center, from, to);
        }
    }

    /// Lines along an arc of at most a right angle, whose ends are given from its centre.
    fn arc(&mut self, center: Point, from: Point, to: Point) {
        let chord = minus(to, from);
        // the height of an arc over its chord is about this
        let height = (chord[0] * chord[0] + chord[1] * chord[1]) / (8.0 * self.radius);
        if height > self.tolerance {
            let sum = plus(from, to);
            let middle = times(sum, self.radius / length(sum));
            self.arc(center, from, middle);
            self.arc(center, middle, to);
        } else {
            self.line_to_outline(plus(center, to));
        }
    }

    fn move_to_outline(&mut self, to: Point) {
        self.coverage.move_to(self.transform.apply(to));
    }

    fn line_to_outline(&mut self, to: Point) {
        self.coverage.line_to(self.transform.apply(to));
    }
}

impl Pen for Stroker<'_> {
    fn move_to(&mut self, to: Point) {
        self.end();
        (self.start, self.at) = (to, to);
    }

    fn line_to(&mut self, to: Point) {
        let (from, line) = (self.at, minus(to, self.at));
        let length = length(line);
        if length == 0.0 {
            return;
        }
        let direction = times(line, 1.0 / length);
        let side = times(left(direction), self.radius);
        self.move_to_outline(plus(from, side));
        for corner in [plus(to, side), minus(to, side), minus(from, side)] {
            self.line_to_outline(corner);
        }
        if let Some([_, last]) = self.ends {
            self.bend(from, last, direction);
        }
        let first = self.ends.map_or(direction, |[first, _]| first);
        self.ends = Some([first, direction]);
        self.at = to;
    }

    fn close(&mut self) {
        self.line_to(self.start);
        if let Some([first, last]) = self.ends.take() {
            self.bend(self.start, last, first);
        }
    }
}

fn plus(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn times(a: Point, factor: f64) -> Point {
    a.map(|x| x * factor)
}

/// A quarter of a turn.
fn left([x, y]: Point) -> Point {
    [-y, x]
}

fn length([x, y]: Point) -> f64 {
    (x * x + y * y).sqrt()
}
