//! Drawings as pixels.

use gym_core::canvas::{self, Align, Canvas, Color, Image, Point, Primitive, Shape, Transform};
use gym_core::pygame::{self, UPRIGHT};
use gym_core::render::{Frame, Painter, PainterProvider};
use gym_core::{Result, inventory};

use crate::downscale::{DownscaledSurface, MAX_FACTOR};
use crate::pixels;
use crate::pygame::{RgbPixels, is_in_reach, paint};
use crate::skia::{self, Skia};
use crate::transforms::Transforms;

inventory::submit! {
    PainterProvider { new: || Box::new(Raster::new()) }
}

/// Draws into [`Frame`]s of any size; the coordinates of the drawing are stretched to fill them.
///
/// At the drawing's own size, pygame's calls give pygame's pixels, and drawing allocates nothing
/// once the buffers have grown: use one painter for many frames. At any other size, and for all
/// other shapes, `tiny-skia` draws antialiased shapes. A shape that extends beyond 32768 pixels
/// from the frame's corner is not drawn, unless it is an axis-aligned rectangle.
#[derive(Debug)]
pub struct Raster {
    transforms: Transforms,
    downscaled: DownscaledSurface,
    skia: Skia,
}

impl Raster {
    /// Makes a painter without buffers.
    pub fn new() -> Self {
        Self {
            transforms: Transforms::new(),
            downscaled: DownscaledSurface::default(),
            skia: Skia::default(),
        }
    }
}

impl Default for Raster {
    fn default() -> Self {
        Self::new()
    }
}

impl Painter for Raster {
    fn paint(
        &mut self,
        size: (u32, u32),
        draw: &mut dyn FnMut(&mut dyn Canvas),
        frame: &mut Frame,
    ) {
        let (width, height) = (frame.width(), frame.height());
        let scale = |pixels: u32, units: u32| f64::from(pixels) / f64::from(units.max(1));
        self.transforms.restart(Transform::scale(
            scale(width, size.0),
            scale(height, size.1),
        ));
        let is_own_size = (width, height) == size;
        let mut surface = Surface {
            raster: self,
            frame,
            is_own_size,
            is_stale: true,
            downscaling: None,
        };
        draw(&mut surface);
        surface.finish();
    }
}

/// Draws one frame at the drawing's own size.
///
/// # Errors
/// [`Error::Custom`](gym_core::Error::Custom) if the frame does not fit in memory.
pub fn frame(size: (u32, u32), draw: impl FnOnce(&mut dyn Canvas)) -> Result<Frame> {
    let mut frame = Frame::new(size.0, size.1)?;
    let mut draw = Some(draw);
    let mut once = |canvas: &mut dyn Canvas| {
        if let Some(draw) = draw.take() {
            draw(canvas);
        }
    };
    Raster::new().paint(size, &mut once, &mut frame);
    Ok(frame)
}

/// A frame that is being drawn.
struct Surface<'a> {
    raster: &'a mut Raster,
    frame: &'a mut Frame,
    /// Whether a unit of the drawing is a pixel of the frame.
    is_own_size: bool,
    /// Whether the frame still has the content of an earlier drawing.
    is_stale: bool,
    /// While a [`DownscaledSurface`] is drawn: the depth of transforms at which it began.
    downscaling: Option<usize>,
}

impl Surface<'_> {
    /// Makes the frame black before the first drawing.
    fn start(&mut self) {
        if std::mem::take(&mut self.is_stale) {
            self.frame.pixels_mut().fill(0);
        }
    }

    /// Prepares for a shape that `tiny-skia` draws. Writes the downscaled surface, if there is one,
    /// to the frame; `tiny-skia` draws all later shapes too.
    fn start_smooth(&mut self) {
        self.start();
        if let Some(depth) = self.downscaling.take() {
            self.raster.downscaled.finish(self.frame);
            let scale = |to: u32, from: usize| f64::from(to) / from as f64;
            let (width, height) = self.raster.downscaled.size();
            let scale = Transform::scale(
                scale(self.frame.width(), width),
                scale(self.frame.height(), height),
            );
            self.raster.transforms.rebase(depth, scale);
        }
    }

    fn finish(&mut self) {
        self.start();
        if self.downscaling.take().is_some() {
            self.raster.downscaled.finish(self.frame);
        }
    }

    /// Returns the number of the surface's columns left of the frame, and whether row 0 is the
    /// bottom row. `None` if a unit of the drawing is not a pixel: pygame's calls then need
    /// `tiny-skia`.
    fn placed(&self) -> Option<(i32, bool)> {
        let height = match self.downscaling {
            Some(_) => self.raster.downscaled.size().1 as f64,
            None if self.is_own_size => f64::from(self.frame.height()),
            None => return None,
        };
        let Transform { x, y, origin } = self.raster.transforms.current();
        let left = UPRIGHT.origin[0] - origin[0];
        let flipped = y == pygame::flipped(height).y;
        let bottom = if flipped {
            pygame::flipped(height)
        } else {
            UPRIGHT
        };
        let placed = x == UPRIGHT.x && y == bottom.y && origin[1] == bottom.origin[1];
        let whole = left >= 0.0 && left <= f64::from(i16::MAX) && left.fract() == 0.0;
        (placed && whole && (left == 0.0 || self.downscaling.is_none()))
            .then_some((left as i32, flipped))
    }
}

impl Canvas for Surface<'_> {
    fn clear(&mut self, color: Color) {
        if self.downscaling.is_some() && color.a == 255 {
            self.raster.downscaled.clear(color);
        } else if color.a == 255 {
            self.is_stale = false;
            pixels::clear(self.frame, color);
        } else {
            self.start_smooth();
            pixels::clear(self.frame, color);
        }
    }

    fn fill(&mut self, shape: Shape<'_>, color: Color) {
        self.start_smooth();
        let transform = self.raster.transforms.current();
        let upright = transform.x[1] == 0.0 && transform.y[0] == 0.0;
        if let Shape::Rect {
            min,
            size,
            corner: 0.0,
        } = shape
            && upright
        {
            let max = [min[0] + size[0], min[1] + size[1]];
            pixels::fill_box(
                self.frame,
                transform.apply(min),
                transform.apply(max),
                color,
            );
        } else {
            self.raster.skia.fill(self.frame, shape, transform, color);
        }
    }

    fn stroke(&mut self, shape: Shape<'_>, width: f64, color: Color) {
        self.start_smooth();
        let Raster {
            transforms, skia, ..
        } = &mut *self.raster;
        skia.stroke(self.frame, shape, width, transforms.current(), color);
    }

    fn text(&mut self, text: &str, position: Point, size: f64, align: Align, color: Color) {
        self.start_smooth();
        let Raster {
            transforms, skia, ..
        } = &mut *self.raster;
        skia.text(
            self.frame,
            (text, position, size, align),
            transforms.current(),
            color,
        );
    }

    fn image(&mut self, image: Image<'_>) {
        self.start_smooth();
        pixels::draw_image(self.frame, image, self.raster.transforms.current());
    }

    fn resolution(&self) -> f64 {
        skia::scale(self.raster.transforms.current())
    }

    fn push(&mut self, transform: Transform) {
        self.raster.transforms.push(transform);
    }

    fn pop(&mut self) {
        if self
            .downscaling
            .is_some_and(|depth| self.raster.transforms.depth() == depth)
        {
            self.finish();
        }
        self.raster.transforms.pop();
    }

    fn pygame(&mut self, primitive: Primitive<'_>, color: Color) {
        match self.placed() {
            Some((left, flipped)) if color.a == 255 && is_in_reach(&primitive) => {
                self.start();
                if self.downscaling.is_some() {
                    self.raster.downscaled.push(&primitive, color, flipped);
                } else {
                    paint(
                        &mut RgbPixels::new(self.frame, left, flipped),
                        &primitive,
                        color,
                    );
                }
            }
            _ => match primitive {
                // pygame's polygons include the pixels on their edges, so that adjacent polygons
                // leave no gap: draw the edges too
                Primitive::Polygon(points) => {
                    self.fill(Shape::Polygon(points), color);
                    let pixel = 1.0 / skia::scale(self.raster.transforms.current());
                    self.stroke(Shape::Polygon(points), pixel.max(1.0), color);
                }
                _ => canvas::smooth(self, primitive, color),
            },
        }
    }

    fn push_smoothscaled(&mut self, from: (u32, u32), to: (u32, u32)) {
        const LARGEST: u32 = 16_384;
        let shrinks = to.0 < from.0 && to.1 < from.1 && from.0.max(from.1) <= LARGEST;
        let shrinks = shrinks && to == (self.frame.width(), self.frame.height());
        let most = |to: u32| to as usize * MAX_FACTOR;
        let shrinks = shrinks && from.0 as usize <= most(to.0) && from.1 as usize <= most(to.1);
        let is_exact = self.is_own_size
            && self.downscaling.is_none()
            && shrinks
            && self.raster.transforms.current() == Transform::IDENTITY;
        if is_exact {
            self.raster.transforms.push_anew(Transform::IDENTITY);
            self.downscaling = Some(self.raster.transforms.depth());
            self.raster.downscaled.begin(from);
        } else {
            let scale = |from: u32, to: u32| f64::from(to) / f64::from(from.max(1));
            self.push(Transform::scale(scale(from.0, to.0), scale(from.1, to.1)));
        }
    }
}

#[cfg(test)]
mod tests {
    use gym_core::canvas::{Segment, TURN};

    use super::*;

    fn frame(size: (u32, u32), draw: impl FnOnce(&mut dyn Canvas)) -> Frame {
        super::frame(size, draw).unwrap()
    }

    const RED: Color = Color::rgb(200, 0, 0);

    /// Returns the red of each pixel of a row.
    fn row(frame: &Frame, y: u32) -> Vec<u8> {
        let width = frame.width() as usize * 3;
        frame.pixels()[y as usize * width..][..width]
            .iter()
            .step_by(3)
            .copied()
            .collect()
    }

    fn pixel(frame: &Frame, x: u32, y: u32) -> [u8; 3] {
        let at = (y * frame.width() + x) as usize * 3;
        [
            frame.pixels()[at],
            frame.pixels()[at + 1],
            frame.pixels()[at + 2],
        ]
    }

    #[test]
    fn shapes_are_solid_inside_and_leave_the_rest_alone() {
        let square = [[10.0, 10.0], [30.0, 10.0], [30.0, 30.0], [10.0, 30.0]];
        let shapes: [Shape<'_>; 3] = [
            Shape::Polygon(&square),
            Shape::Circle {
                center: [20.0, 20.0],
                radius: 10.0,
            },
            Shape::Rect {
                min: [10.0, 10.0],
                size: [20.0, 20.0],
                corner: 3.0,
            },
        ];
        for shape in shapes {
            let frame = frame((40, 40), |canvas| {
                canvas.clear(Color::WHITE);
                canvas.fill(shape, RED);
            });
            for (x, y) in [(20, 20), (20, 10), (11, 20), (29, 20), (15, 24)] {
                assert_eq!(pixel(&frame, x, y), [200, 0, 0], "{shape:?} {x} {y}");
            }
            for (x, y) in [(20, 9), (9, 20), (30, 20), (20, 30), (0, 0), (39, 39)] {
                assert_eq!(pixel(&frame, x, y), [255; 3], "{shape:?} {x} {y}");
            }
        }
    }

    #[test]
    fn edges_are_anti_aliased() {
        let frame = frame((6, 3), |canvas| {
            canvas.polygon(
                &[[1.5, 0.0], [4.25, 0.0], [4.25, 3.0], [1.5, 3.0]],
                Color::WHITE,
            );
        });
        assert_eq!(row(&frame, 1), [0, 128, 255, 255, 64, 0]);
    }

    #[test]
    fn the_winding_rule_is_nonzero() {
        let square = |min: f64, max: f64| {
            let corners = [[min, min], [max, min], [max, max], [min, max]];
            std::array::from_fn::<_, 4, _>(|i| {
                if i == 0 {
                    Segment::Move(corners[0])
                } else {
                    Segment::Line(corners[i])
                }
            })
        };
        let [outer, inner] = [square(0.0, 9.0), square(3.0, 6.0)];
        let both = [&outer[..], &inner[..]].concat();
        let image = frame((9, 9), |canvas| {
            canvas.fill(Shape::Path(&both), Color::WHITE);
        });
        assert_eq!(row(&image, 4), [255; 9]);
    }

    #[test]
    fn strokes_have_their_width_butt_ends_and_round_joins() {
        let image = frame((20, 20), |canvas| {
            canvas.stroke(
                Shape::Polyline(&[[4.0, 15.0], [12.0, 15.0], [12.0, 4.0]]),
                4.0,
                Color::WHITE,
            );
        });
        assert_eq!(
            [12, 13, 16, 17].map(|y| pixel(&image, 6, y)[0]),
            [0, 255, 255, 0]
        );
        assert_eq!([3, 4].map(|x| pixel(&image, x, 15)[0]), [0, 255]);
        // a round join covers a part of the outer corner, a bevel would cover less
        assert!(pixel(&image, 13, 16)[0] < 128 && pixel(&image, 12, 16)[0] > 200);
    }

    #[test]
    fn thin_lines_fade_instead_of_breaking() {
        let image = frame((8, 3), |canvas| {
            canvas.line([0.0, 1.5], [8.0, 1.5], 0.2, Color::WHITE);
        });
        assert_eq!(row(&image, 1), [51; 8]);
        assert_eq!(row(&image, 0), [0; 8]);
    }

    #[test]
    fn drawings_scale_to_the_frame() {
        let draw = |canvas: &mut dyn Canvas| {
            canvas.rect([1.0, 0.0], [1.0, 1.0], Color::WHITE);
            canvas.polygon(&[[2.0, 0.0], [3.0, 0.0], [3.0, 1.0], [2.0, 1.0]], RED);
        };
        let mut image = Frame::new(12, 2).unwrap();
        Raster::new().paint((4, 1), &mut |canvas| draw(canvas), &mut image);
        assert_eq!(
            row(&image, 1),
            [0, 0, 0, 255, 255, 255, 200, 200, 200, 0, 0, 0]
        );
    }

    #[test]
    fn transforms_nest() {
        let image = frame((20, 20), |canvas| {
            canvas.push(Transform::y_up(20.0));
            canvas.push(Transform::translate(10.0, 5.0));
            canvas.push(Transform::rotate(TURN / 4.0));
            // this rectangle extends along x, which points up in the image
            canvas.polygon(
                &[[0.0, -1.0], [8.0, -1.0], [8.0, 1.0], [0.0, 1.0]],
                Color::WHITE,
            );
            canvas.pop();
            canvas.rect([0.0, -2.0], [3.0, 1.0], RED);
            canvas.pop();
            canvas.pop();
            canvas.rect([0.0, 0.0], [1.0, 1.0], RED);
        });
        assert_eq!(
            [6, 7, 14, 15].map(|y| pixel(&image, 10, y)[0]),
            [0, 255, 255, 0]
        );
        assert_eq!(
            row(&image, 16),
            [[0; 10].as_slice(), &[200; 3], &[0; 7]].concat()
        );
        assert_eq!(pixel(&image, 0, 0), [200, 0, 0]);
    }

    #[test]
    fn text_stands_on_its_baseline() {
        let image = frame((40, 40), |canvas| {
            canvas.text("I", [20.0, 30.0], 16.0, Align::Center, Color::WHITE);
        });
        assert_eq!(
            [12, 15, 29, 32].map(|y| pixel(&image, 20, y)[0]),
            [0, 255, 255, 0]
        );
        assert_eq!(
            [18, 19, 20, 21].map(|x| pixel(&image, x, 20)[0]),
            [0, 255, 255, 0]
        );
    }

    #[test]
    fn translucent_shapes_mix_once() {
        let image = frame((10, 10), |canvas| {
            canvas.clear(Color::WHITE);
            // the stroke overlaps itself
            let zigzag = [[0.0, 5.0], [10.0, 5.0], [0.0, 5.0], [10.0, 5.0]];
            canvas.stroke(Shape::Polyline(&zigzag), 4.0, Color::BLACK.alpha(51));
        });
        assert_eq!(pixel(&image, 5, 5), [204; 3]);
    }

    #[test]
    fn a_used_painter_gives_the_same_picture() {
        let draw = |canvas: &mut dyn Canvas| {
            canvas.clear(Color::WHITE);
            canvas.circle([3.3, 4.1], 2.7, RED);
            canvas.text("a", [1.0, 9.0], 5.0, Align::Left, Color::BLACK);
            canvas.push(Transform::scale(2.0, 2.0));
        };
        let mut raster = Raster::new();
        for size in [(10, 10), (7, 30), (10, 10)] {
            let mut image = Frame::new(size.0, size.1).unwrap();
            raster.paint((10, 10), &mut |canvas| draw(canvas), &mut image);
            let mut fresh = Frame::new(size.0, size.1).unwrap();
            Raster::new().paint((10, 10), &mut |canvas| draw(canvas), &mut fresh);
            assert_eq!(image.pixels(), fresh.pixels());
        }
    }

    /// A checksum of an image with all kinds of shapes. The checksum must be the same on every CPU.
    #[test]
    fn the_bytes_are_the_same_everywhere() {
        let image = frame((64, 48), |canvas| {
            canvas.clear(Color::rgb(240, 240, 250));
            canvas.push(Transform {
                x: [0.8, 0.6],
                y: [-0.6, 0.8],
                origin: [20.0, 5.0],
            });
            canvas.rect([1.0, 2.0], [20.0, 9.0], RED.alpha(100));
            canvas.stroke(
                Shape::Circle {
                    center: [15.0, 15.0],
                    radius: 9.5,
                },
                2.5,
                Color::BLACK,
            );
            canvas.pop();
            let curve = [
                Segment::Move([2.0, 40.0]),
                Segment::Cubic([20.0, 0.0], [30.0, 60.0], [60.0, 8.0]),
            ];
            canvas.stroke(Shape::Path(&curve), 0.7, Color::rgb(0, 90, 0));
            canvas.text(
                "Gym 0.1",
                [4.0, 44.0],
                8.0,
                Align::Left,
                Color::BLACK.alpha(200),
            );
        });
        let hash =
            |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        assert_eq!(
            image.pixels().iter().fold(0xcbf2_9ce4_8422_2325, hash),
            0xe042_ae4f_d295_ac5b
        );
    }

    #[test]
    fn odd_numbers_draw_nothing_and_do_not_fail() {
        for odd in [f64::NAN, f64::INFINITY, 1e30, 1e9, -1e6] {
            let image = frame((8, 8), |canvas| {
                canvas.circle([4.0, 4.0], odd, RED);
                canvas.circle([odd, 4.0], 1.0, RED);
                canvas.polygon(&[[0.0, 0.0], [odd, 8.0], [8.0, 0.0]], RED);
                canvas.line([0.0, 0.0], [odd, 0.0], 1.0, RED);
                canvas.text("a", [4.0, odd], 5.0, Align::Left, RED);
                canvas.push(Transform::translate(odd, 0.0));
                canvas.circle([4.0, 4.0], 1.0, RED);
                canvas.line([0.0, 0.0], [8.0, 8.0], 1.0, RED);
            });
            assert!(image.pixels().iter().all(|&byte| byte == 0), "{odd}");
        }
        let image = frame((8, 8), |canvas| {
            canvas.line([0.0, 0.0], [8.0, 8.0], -1.0, RED);
            canvas.line([0.0, 0.0], [8.0, 8.0], f64::NAN, RED);
            canvas.line([0.0, 0.0], [8.0, 8.0], 1e30, RED);
            canvas.text("a", [4.0, 4.0], 1e30, Align::Left, RED);
            canvas.polygon(&[], RED);
            canvas.polygon(&[[1.0, 1.0]], RED);
            canvas.pop();
            canvas.push(Transform::scale(0.0, 0.0));
            canvas.line([0.0, 0.0], [8.0, 8.0], 1.0, RED);
        });
        assert!(image.pixels().iter().all(|&byte| byte == 0));
        assert_eq!(frame((0, 5), |canvas| canvas.clear(RED)).pixels().len(), 0);
    }

    #[test]
    fn the_painter_is_registered() {
        assert!(gym_core::render::painter().is_some());
    }
}
