//! Shapes as outlines: straight lines and cubic curves.

use gym_core::canvas::{Point, Segment, Shape};

/// The distance from an end of a cubic Bézier curve to its control point, if the curve approximates
/// a quarter of a unit circle: `4/3 (sqrt(2) - 1)`. With this distance the curve's middle lies on
/// the circle.
const QUARTER_ARM: f64 = 0.552_284_749_830_793_4;

/// Returns a quarter of an ellipse from `from` to `to`, whose tangents at the ends meet in
/// `corner`. If the tangents are not perpendicular, the result is an affine image of the quarter.
pub(crate) fn quarter(from: Point, corner: Point, to: Point) -> Segment {
    let arm = |end: Point| [0, 1].map(|i| end[i] + QUARTER_ARM * (corner[i] - end[i]));
    Segment::Cubic(arm(from), arm(to), to)
}

/// Passes the outline of a shape to `emit`.
pub(crate) fn outline(shape: Shape<'_>, emit: &mut impl FnMut(Segment)) {
    match shape {
        Shape::Polygon(points) => {
            polyline(points, emit);
            emit(Segment::Close);
        }
        Shape::Polyline(points) => polyline(points, emit),
        Shape::Circle {
            center: [x, y],
            radius,
        } => {
            rounded(
                [x - radius, y - radius],
                [x + radius, y + radius],
                radius,
                emit,
            );
        }
        Shape::Rect { min, size, corner } => {
            let max = [min[0] + size[0], min[1] + size[1]];
            if corner > 0.0 {
                let corner = corner.min(size[0].abs() / 2.0).min(size[1].abs() / 2.0);
                rounded(min, max, corner, emit);
            } else {
                polyline(&[min, [max[0], min[1]], max, [min[0], max[1]]], emit);
                emit(Segment::Close);
            }
        }
        Shape::Path(segments) => segments.iter().copied().for_each(emit),
    }
}

fn polyline(points: &[Point], emit: &mut impl FnMut(Segment)) {
    if let [first, rest @ ..] = points {
        emit(Segment::Move(*first));
        rest.iter().for_each(|&point| emit(Segment::Line(point)));
    }
}

/// Passes the outline of a rectangle with rounded corners to `emit`.
fn rounded([x0, y0]: Point, [x1, y1]: Point, radius: f64, emit: &mut impl FnMut(Segment)) {
    emit(Segment::Move([x0 + radius, y0]));
    let corners = [
        ([x1 - radius, y0], [x1, y0], [x1, y0 + radius]),
        ([x1, y1 - radius], [x1, y1], [x1 - radius, y1]),
        ([x0 + radius, y1], [x0, y1], [x0, y1 - radius]),
        ([x0, y0 + radius], [x0, y0], [x0 + radius, y0]),
    ];
    for (from, corner, to) in corners {
        emit(Segment::Line(from));
        emit(quarter(from, corner, to));
    }
    emit(Segment::Close);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segments(shape: Shape<'_>) -> Vec<Segment> {
        let mut segments = Vec::new();
        outline(shape, &mut |segment| segments.push(segment));
        segments
    }

    #[test]
    fn the_middle_of_a_quarter_lies_on_the_circle() {
        let from = [1.0, 0.0];
        let Segment::Cubic(a, b, to) = quarter(from, [1.0, 1.0], [0.0, 1.0]) else {
            panic!()
        };
        let middle = [0, 1].map(|i| (from[i] + 3.0 * a[i] + 3.0 * b[i] + to[i]) / 8.0);
        assert!(
            (middle[0].hypot(middle[1]) - 1.0).abs() < 1e-12,
            "{middle:?}"
        );
    }

    #[test]
    fn polygons_close_and_polylines_do_not() {
        let points = [[0.0, 0.0], [1.0, 0.0]];
        assert_eq!(
            segments(Shape::Polyline(&points)),
            [Segment::Move(points[0]), Segment::Line(points[1])]
        );
        assert_eq!(
            segments(Shape::Polygon(&points)).last(),
            Some(&Segment::Close)
        );
        assert_eq!(segments(Shape::Polyline(&[])), []);
    }

    #[test]
    fn corners_are_no_larger_than_the_rectangle() {
        let rect = |corner| {
            segments(Shape::Rect {
                min: [0.0, 0.0],
                size: [4.0, 2.0],
                corner,
            })
        };
        assert_eq!(rect(9.0), rect(1.0));
        assert_eq!(rect(9.0)[0], Segment::Move([1.0, 0.0]));
        assert_eq!(rect(0.0).len(), 5);
    }
}
