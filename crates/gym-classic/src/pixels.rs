//! Drawing in the pixels of Gymnasium's pictures.
//!
//! Gymnasium draws with pygame, y up, and flips the surface. pygame's coordinates name the centres of
//! pixels, and its filled shapes include the pixels of their outline; so here the origin lies in the
//! middle of the bottom left pixel, and a filled shape is half a pixel larger on each side.

use gym_core::canvas::{Canvas, Color, Point, Transform};

/// The coordinates of a picture of that height.
pub(crate) const fn flipped(height: f64) -> Transform {
    Transform { origin: [0.5, height - 0.5], ..Transform::y_up(0.0) }
}

/// A filled rectangle, outline included.
pub(crate) fn rect(canvas: &mut dyn Canvas, min: Point, size: Point, color: Color) {
    canvas.rect(min.map(|x| x - 0.5), size.map(|x| x + 1.0), color);
}

/// A filled circle, outline included.
pub(crate) fn circle(canvas: &mut dyn Canvas, center: Point, radius: f64, color: Color) {
    canvas.circle(center, radius + 0.5, color);
}
