//! Outlines as straight lines.

use gym_core::canvas::{Point, Segment};

/// How far a line may be from the curve it stands for, in pixels.
pub(crate) const TOLERANCE: f64 = 1.0 / 16.0;
/// No curve is cut into more lines.
const MOST_LINES: f64 = 512.0;

/// What follows an outline along straight lines.
pub(crate) trait Pen {
    /// Starts a new contour.
    fn move_to(&mut self, to: Point);

    /// A straight line.
    fn line_to(&mut self, to: Point);

    /// Back to the start of the contour.
    fn close(&mut self);
}

/// Leads a pen along an outline, piece by piece.
#[derive(Debug)]
pub(crate) struct Flatten<'a, P> {
    pen: &'a mut P,
    start: Point,
    at: Point,
    /// Pixels per unit.
    scale: f64,
}

impl<'a, P: Pen> Flatten<'a, P> {
    /// For a pen that writes in units of so many pixels.
    pub(crate) fn new(pen: &'a mut P, scale: f64) -> Self {
        Self { pen, start: [0.0; 2], at: [0.0; 2], scale }
    }

    pub(crate) fn segment(&mut self, segment: Segment) {
        match segment {
            Segment::Move(to) => {
                self.pen.move_to(to);
                (self.start, self.at) = (to, to);
            }
            Segment::Line(to) => {
                self.pen.line_to(to);
                self.at = to;
            }
            Segment::Quad(b, c) => {
                let a = self.at;
                // the second derivative is twice the bend
                self.curve(2.0 * bend(a, b, c), c, |t, u| {
                    [0, 1].map(|i| u * u * a[i] + 2.0 * u * t * b[i] + t * t * c[i])
                });
            }
            Segment::Cubic(b, c, d) => {
                let a = self.at;
                // the second derivative is at most 6 times the larger bend
                self.curve(6.0 * bend(a, b, c).max(bend(b, c, d)), d, |t, u| {
                    [0, 1].map(|i| u * u * (u * a[i] + 3.0 * t * b[i]) + t * t * (3.0 * u * c[i] + t * d[i]))
                });
            }
            Segment::Close => {
                self.pen.close();
                self.at = self.start;
            }
        }
    }

    /// A curve by its largest second derivative, its end, and its points at `t` and `u = 1 - t`.
    fn curve(&mut self, second: f64, end: Point, point: impl Fn(f64, f64) -> Point) {
        // a line across a stretch h of the curve is off by h^2 / 8 times the second derivative
        let lines = (second * self.scale / (8.0 * TOLERANCE)).sqrt().min(MOST_LINES) as u32 + 1;
        for i in 1..lines {
            let t = f64::from(i) / f64::from(lines);
            self.pen.line_to(point(t, 1.0 - t));
        }
        self.pen.line_to(end);
        self.at = end;
    }
}

/// The length of `a - 2 b + c`.
fn bend(a: Point, b: Point, c: Point) -> f64 {
    let [x, y] = [0, 1].map(|i| a[i] - 2.0 * b[i] + c[i]);
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outline::outline;
    use gym_core::canvas::Shape;

    #[derive(Default)]
    struct Corners(Vec<Point>);

    impl Pen for Corners {
        fn move_to(&mut self, to: Point) {
            self.0.push(to);
        }

        fn line_to(&mut self, to: Point) {
            self.0.push(to);
        }

        fn close(&mut self) {
            self.0.extend(self.0.first().copied());
        }
    }

    #[test]
    fn a_circle_is_within_the_tolerance() {
        for (radius, scale) in [(10.0, 1.0), (10.0, 30.0), (0.5, 1.0)] {
            let mut corners = Corners::default();
            let mut pen = Flatten::new(&mut corners, scale);
            outline(Shape::Circle { center: [0.0; 2], radius }, &mut |segment| pen.segment(segment));
            for pair in corners.0.windows(2) {
                let middle = [0, 1].map(|i| f64::midpoint(pair[0][i], pair[1][i]));
                let off = (middle[0].hypot(middle[1]) - radius).abs() * scale;
                assert!(off <= 1.05 * TOLERANCE, "{radius} {scale} {off}");
            }
        }
    }

    #[test]
    fn curves_end_where_they_should_and_odd_ones_do_not_last() {
        for odd in [0.0, 1e300, f64::NAN, f64::INFINITY] {
            let mut corners = Corners::default();
            let mut pen = Flatten::new(&mut corners, 1.0);
            pen.segment(Segment::Move([1.0, 2.0]));
            pen.segment(Segment::Quad([odd, 4.0], [5.0, 6.0]));
            pen.segment(Segment::Cubic([odd, 4.0], [8.0, odd], [7.0, 8.0]));
            assert_eq!(corners.0.last(), Some(&[7.0, 8.0]));
            assert!(corners.0.len() as f64 <= 2.0 * (MOST_LINES + 1.0) + 1.0);
        }
    }
}
