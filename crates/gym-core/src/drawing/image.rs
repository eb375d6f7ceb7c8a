//! Images of pixels on a canvas.

use super::canvas::{Canvas, Color, Point};

/// Pixels that a canvas draws, stretched to a rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image<'a> {
    /// The corner of the rectangle with the smallest coordinates.
    pub min: Point,
    /// Its width and height.
    pub size: Point,
    /// The number of pixels in a row.
    pub width: usize,
    /// The colours of the pixels, row by row from the top; a last row that is not complete is not
    /// drawn.
    pub pixels: &'a [Color],
}

impl<'a> Image<'a> {
    /// The rows of pixels from the top.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &'a [Color]> {
        self.pixels.chunks_exact(self.width.max(1))
    }
}

/// Draws an image as rectangles: one for each run of equal pixels in a row.
pub(super) fn rectangles<C: Canvas + ?Sized>(canvas: &mut C, image: Image<'_>) {
    let rows = image.rows();
    let unit = [
        image.size[0] / image.width as f64,
        image.size[1] / rows.len() as f64,
    ];
    for (y, row) in rows.enumerate() {
        let mut x = 0;
        for run in row.chunk_by(|a, b| a == b) {
            if run[0].a > 0 {
                let place = [x as f64 * unit[0], y as f64 * unit[1]];
                let min = [image.min[0] + place[0], image.min[1] + place[1]];
                canvas.rect(min, [run.len() as f64 * unit[0], unit[1]], run[0]);
            }
            x += run.len();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::{Align, Shape, Transform};

    /// The rectangles that are filled.
    #[derive(Default)]
    struct Rects(Vec<(Point, Point, Color)>);

    impl Canvas for Rects {
        fn clear(&mut self, _: Color) {}
        fn fill(&mut self, shape: Shape<'_>, color: Color) {
            if let Shape::Rect { min, size, .. } = shape {
                self.0.push((min, size, color));
            }
        }
        fn stroke(&mut self, _: Shape<'_>, _: f64, _: Color) {}
        fn text(&mut self, _: &str, _: Point, _: f64, _: Align, _: Color) {}
        fn push(&mut self, _: Transform) {}
        fn pop(&mut self) {}
    }

    #[test]
    fn equal_pixels_of_a_row_are_one_rectangle() {
        let (clear, blue) = (Color::WHITE.alpha(0), Color::rgb(0, 0, 255));
        let mut canvas = Rects::default();
        canvas.image(Image {
            min: [10.0, 20.0],
            size: [3.0, 4.0],
            width: 3,
            pixels: &[blue, blue, clear, clear, clear, Color::WHITE, blue],
        });
        let expected = [
            ([10.0, 20.0], [2.0, 2.0], blue),
            ([12.0, 22.0], [1.0, 2.0], Color::WHITE),
        ];
        assert_eq!(canvas.0, expected);
    }
}
