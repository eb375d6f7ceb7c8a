//! Drawing in the pixels of Gymnasium's pictures.
//!
//! Gymnasium draws with pygame, y up, and flips the surface. pygame's coordinates name the centres of
//! pixels, and its filled shapes include the pixels of their outline; so here the origin lies in the
//! middle of the bottom left pixel, and a filled shape is half a pixel larger on each side. pygame cuts
//! the fractions off coordinates. The same is done here at Gymnasium's size of the picture, where it
//! also keeps edges sharp and GIFs small; at other sizes shapes move smoothly.

use gym_core::canvas::{Canvas, Color, Point, Transform};

/// The coordinates of a picture of that height.
pub(crate) const fn flipped(height: f64) -> Transform {
    Transform { origin: [0.5, height - 0.5], ..Transform::y_up(0.0) }
}

/// The whole pixel that pygame takes for a point.
pub(crate) fn whole(canvas: &dyn Canvas, point: Point) -> Point {
    if canvas.unit_is_pixel() { point.map(f64::trunc) } else { point }
}

/// A polygon with its outline, placed by `place`.
pub(crate) fn polygon<const N: usize>(
    canvas: &mut dyn Canvas,
    place: Transform,
    corners: [Point; N],
    color: Color,
) {
    let corners = corners.map(|corner| whole(canvas, place.apply(corner)));
    canvas.polygon(&grown(corners), color);
}

/// A convex polygon with each edge moved outwards by half a pixel.
fn grown<const N: usize>(corners: [Point; N]) -> [Point; N] {
    const SHARPEST: f64 = 0.5; // keeps the tip of a pointed corner near it
    let edge = |i: usize| {
        let ([x0, y0], [x1, y1]) = (corners[i % N], corners[(i + 1) % N]);
        let length = (x1 - x0).hypot(y1 - y0).max(f64::MIN_POSITIVE);
        [(x1 - x0) / length, (y1 - y0) / length]
    };
    // corners that follow each other clockwise, y up, have the outside on their left
    let turn: f64 = (0..N).map(|i| edge(i)[0] * edge(i + 1)[1] - edge(i)[1] * edge(i + 1)[0]).sum();
    let outside = -0.5 * turn.signum();
    std::array::from_fn(|i| {
        let (a, b) = (edge(i + N - 1), edge(i));
        let scale = outside / (1.0 + a[0] * b[0] + a[1] * b[1]).max(SHARPEST);
        [corners[i][0] - scale * (a[1] + b[1]), corners[i][1] + scale * (a[0] + b[0])]
    })
}

/// A rectangle with its outline, between two opposite corners.
pub(crate) fn rect(canvas: &mut dyn Canvas, place: Transform, [l, b]: Point, [r, t]: Point, color: Color) {
    polygon(canvas, place, [[l, b], [l, t], [r, t], [r, b]], color);
}

/// A circle with its outline.
pub(crate) fn circle(canvas: &mut dyn Canvas, center: Point, radius: f64, color: Color) {
    let (center, [radius, _]) = (whole(canvas, center), whole(canvas, [radius, 0.0]));
    canvas.circle(center, radius + 0.5, color);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_grow_by_half_a_pixel_whichever_way_they_turn() {
        let square = [[0.0, 0.0], [0.0, 4.0], [2.0, 4.0], [2.0, 0.0]];
        assert_eq!(grown(square), [[-0.5, -0.5], [-0.5, 4.5], [2.5, 4.5], [2.5, -0.5]]);
        let [a, b, c, d] = square;
        assert_eq!(grown([d, c, b, a]), [[2.5, -0.5], [2.5, 4.5], [-0.5, 4.5], [-0.5, -0.5]]);
        assert!(grown([[1.0, 1.0]; 4]).iter().flatten().all(|x| x.is_finite()));
    }
}
