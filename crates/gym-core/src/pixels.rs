//! Drawing in the pixels of Gymnasium's pictures, for environments that look like its own.
//!
//! Gymnasium draws with pygame, y up, and flips the surface. pygame's coordinates name the centres of
//! pixels, and its filled shapes include the pixels of their outline; so here the origin lies in the
//! middle of the bottom left pixel, and a filled shape is half a pixel larger on each side. pygame cuts
//! the fractions off coordinates. The same is done here at Gymnasium's size of the picture, where it
//! also keeps edges sharp and GIFs small; at other sizes shapes move smoothly.

use crate::canvas::{Canvas, Color, Point, Transform};

/// The coordinates of a picture of that height, in pixels.
pub const fn flipped(height: f64) -> Transform {
    Transform { origin: [0.5, height - 0.5], ..Transform::y_up(0.0) }
}

/// The whole pixel that pygame takes for a point.
pub fn whole(canvas: &dyn Canvas, point: Point) -> Point {
    if canvas.unit_is_pixel() { point.map(f64::trunc) } else { point }
}

/// Fills a polygon with its outline, placed by `place`. The corners are changed to those that were
/// filled.
pub fn polygon(canvas: &mut dyn Canvas, place: Transform, mut corners: impl AsMut<[Point]>, color: Color) {
    let corners = corners.as_mut();
    for corner in corners.iter_mut() {
        *corner = whole(canvas, place.apply(*corner));
    }
    grow(corners);
    canvas.polygon(corners, color);
}

/// Moves each edge of a polygon outwards by half a pixel.
fn grow(corners: &mut [Point]) {
    const SHARPEST: f64 = 0.5; // keeps the tip of a pointed corner near it
    let edge = |[x0, y0]: Point, [x1, y1]: Point| {
        let length = (x1 - x0).hypot(y1 - y0).max(f64::MIN_POSITIVE);
        [(x1 - x0) / length, (y1 - y0) / length]
    };
    let [first, .., last] = *corners else { return };
    // corners that follow each other clockwise, y up, enclose a negative area and have the outside on
    // their left
    let area = |[x0, y0]: Point, [x1, y1]: Point| {
        (x0 - first[0]) * (y1 - first[1]) - (x1 - first[0]) * (y0 - first[1])
    };
    let twice_area: f64 = corners.windows(2).map(|pair| area(pair[0], pair[1])).sum();
    let outside = -0.5 * twice_area.signum();
    let mut before = last;
    for i in 0..corners.len() {
        let here = corners[i];
        let after = corners.get(i + 1).copied().unwrap_or(first);
        let (a, b) = (edge(before, here), edge(here, after));
        let scale = outside / (1.0 + a[0] * b[0] + a[1] * b[1]).max(SHARPEST);
        corners[i] = [here[0] - scale * (a[1] + b[1]), here[1] + scale * (a[0] + b[0])];
        before = here;
    }
}

/// Fills a rectangle with its outline, between two opposite corners.
pub fn rect(canvas: &mut dyn Canvas, place: Transform, [l, b]: Point, [r, t]: Point, color: Color) {
    polygon(canvas, place, [[l, b], [l, t], [r, t], [r, b]], color);
}

/// Fills a circle with its outline.
pub fn circle(canvas: &mut dyn Canvas, center: Point, radius: f64, color: Color) {
    let (center, [radius, _]) = (whole(canvas, center), whole(canvas, [radius, 0.0]));
    canvas.circle(center, radius + 0.5, color);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_grow_by_half_a_pixel_whichever_way_they_turn() {
        let grown = |mut corners: Vec<Point>| {
            grow(&mut corners);
            corners
        };
        let square = [[0.0, 0.0], [0.0, 4.0], [2.0, 4.0], [2.0, 0.0]];
        assert_eq!(grown(square.to_vec()), [[-0.5, -0.5], [-0.5, 4.5], [2.5, 4.5], [2.5, -0.5]]);
        let [a, b, c, d] = square;
        assert_eq!(grown(vec![d, c, b, a]), [[2.5, -0.5], [2.5, 4.5], [-0.5, 4.5], [-0.5, -0.5]]);
        // an inner corner
        let angle = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 2.0], [2.0, 4.0], [0.0, 4.0]];
        let grown_angle = [[-0.5, -0.5], [4.5, -0.5], [4.5, 2.5], [2.5, 2.5], [2.5, 4.5], [-0.5, 4.5]];
        assert_eq!(grown(angle), grown_angle);
        assert!(grown(vec![[1.0, 1.0]; 4]).iter().flatten().all(|x| x.is_finite()));
        assert_eq!(grown(vec![]), [[0.0; 2]; 0]);
    }
}
