//! What the driver sees: the field from above, turned with the car, and a dashboard.
//!
//! All is drawn in the coordinates of Gymnasium's window. Where Gymnasium draws 1000x800 pixels and
//! averages them to 96x96, the observation is drawn at its own size, anti-aliased.

use gym_core::canvas::{Align, Canvas, Color, Label, Point, Segment, Shape, Transform};
use gym_core::spaces::BoxSpace;
use gym_core::{Array, DType, Space};

use super::car::Car;
use super::{Episode, PLAYFIELD, SCALE};
use crate::common;

/// The size of Gymnasium's window.
pub(super) const WINDOW_W: f64 = 1000.0;
pub(super) const WINDOW_H: f64 = 800.0;
const STATE_W: usize = 96;
const STATE_H: usize = 96;
/// Camera zoom.
const ZOOM: f64 = 2.7;
/// Half the distance of the grass patches.
const GRASS_DIM: f64 = PLAYFIELD / 20.0;

/// The space of observations: any picture.
pub(super) fn space() -> Space {
    let space = BoxSpace::uniform(0.0, 255.0, [STATE_H, STATE_W, 3], DType::U8);
    space.map_or_else(|_| unreachable!("0 to 255 are bounds of bytes"), Space::from)
}

/// Draws observations, and keeps what that needs from one to the next.
#[derive(Debug, Default)]
pub(super) struct Camera {
    #[cfg(feature = "picture")]
    raster: gym_render::Raster,
    #[cfg(feature = "picture")]
    frame: gym_core::render::Frame,
}

impl Clone for Camera {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Camera {
    /// Leaves a picture of the episode in `observation`.
    pub(super) fn take(&mut self, episode: &Episode, observation: &mut Array) {
        if observation.shape() != [STATE_H, STATE_W, 3] || observation.dtype() != DType::U8 {
            *observation = Array::zeros(DType::U8, [STATE_H, STATE_W, 3]);
        }
        #[cfg(feature = "picture")]
        {
            use gym_core::render::{Frame, Painter};

            if self.frame.width() == 0 {
                self.frame = Frame::new(STATE_W as u32, STATE_H as u32);
            }
            let size = (WINDOW_W as u32, WINDOW_H as u32);
            self.raster.paint(size, &mut |canvas| episode.draw(canvas, false), &mut self.frame);
            if let Some(pixels) = observation.as_mut_slice::<u8>() {
                pixels.copy_from_slice(self.frame.pixels());
            }
        }
        #[cfg(not(feature = "picture"))]
        let _ = episode;
    }
}

fn color([r, g, b]: [f64; 3]) -> Color {
    Color::rgb(r as u8, g as u8, b as u8)
}

/// Whether some of a polygon can be in the window.
fn is_visible(points: &[Point]) -> bool {
    let beyond = |axis: usize, size: f64| {
        points.iter().all(|p| p[axis] < 0.0) || points.iter().all(|p| p[axis] > size)
    };
    !beyond(0, WINDOW_W) && !beyond(1, WINDOW_H)
}

/// Quadrangles of one colour, filled together; those out of sight are left out.
struct Batch {
    color: Color,
    segments: [Segment; 100],
    len: usize,
}

impl Batch {
    fn new(color: Color) -> Self {
        Self { color, segments: [Segment::Close; 100], len: 0 }
    }

    fn push(&mut self, canvas: &mut dyn Canvas, corners: [Point; 4]) {
        if !is_visible(&corners) {
            return;
        }
        let [a, b, c, d] = corners;
        let outline =
            [Segment::Move(a), Segment::Line(b), Segment::Line(c), Segment::Line(d), Segment::Close];
        self.segments[self.len..self.len + outline.len()].copy_from_slice(&outline);
        self.len += outline.len();
        if self.len == self.segments.len() {
            self.flush(canvas);
        }
    }

    fn flush(&mut self, canvas: &mut dyn Canvas) {
        if self.len > 0 {
            canvas.fill(Shape::Path(&self.segments[..self.len]), self.color);
            self.len = 0;
        }
    }
}

impl Episode {
    /// Pixels of the window per m: the camera comes near in the first second.
    fn zoom(&self) -> f64 {
        0.1 * SCALE * (1.0 - self.t).max(0.0) + ZOOM * SCALE * self.t.min(1.0)
    }

    /// From the field to the window.
    fn view(&self) -> Transform {
        let position = self.world.position(self.car.hull);
        // the world's own sine and cosine: the platform's may differ in the last digit
        let rotation = self.world.pose(self.car.hull).rotation;
        let (sin, cos) = (f64::from(rotation.im), f64::from(rotation.re));
        Transform::y_up(WINDOW_H)
            .then(Transform::translate(WINDOW_W / 2.0, WINDOW_H / 4.0))
            .then(Transform::scale(self.zoom(), self.zoom()))
            .then(Transform { x: [cos, -sin], y: [sin, cos], origin: [0.0; 2] })
            .then(Transform::translate(-f64::from(position.x), -f64::from(position.y)))
    }

    /// Draws everything, with skid marks or without, in the window's coordinates.
    pub(super) fn draw(&self, canvas: &mut dyn Canvas, skid_marks: bool) {
        let view = self.view();
        self.draw_grass(canvas, view);
        self.draw_road(canvas, view);
        canvas.push(view);
        if skid_marks {
            for mark in &self.car.marks {
                let color = if mark.on_grass { Color::rgb(102, 102, 0) } else { Color::BLACK };
                canvas.stroke(Shape::Polyline(&mark.points), 2.0 / self.zoom(), color);
            }
        }
        self.draw_car(canvas);
        canvas.pop();
        self.draw_indicators(canvas);
    }

    /// The field in its colour, with patches, and black around it.
    fn draw_grass(&self, canvas: &mut dyn Canvas, view: Transform) {
        let square =
            |x: f64, y: f64, d: f64| [[x, y], [x + d, y], [x + d, y + d], [x, y + d]].map(|p| view.apply(p));
        let position = self.world.position(self.car.hull);
        let reach = f64::hypot(WINDOW_W, WINDOW_H) / self.zoom();
        if f64::from(position.amax()) + reach < PLAYFIELD {
            canvas.clear(color(self.colors.background));
        } else {
            canvas.clear(Color::BLACK);
            canvas.polygon(&square(-PLAYFIELD, -PLAYFIELD, 2.0 * PLAYFIELD), color(self.colors.background));
        }
        let mut patches = Batch::new(color(self.colors.grass));
        for x in (-20..20).step_by(2) {
            for y in (-20..20).step_by(2) {
                patches.push(canvas, square(GRASS_DIM * f64::from(x), GRASS_DIM * f64::from(y), GRASS_DIM));
            }
        }
        patches.flush(canvas);
    }

    /// The road in one piece, so that no grass shines through between its tiles, then the tiles'
    /// shades and the kerbs.
    fn draw_road(&self, canvas: &mut dyn Canvas, view: Transform) {
        /// Tiles are smaller than a pixel of the observation below this zoom.
        const SHADED_ZOOM: f64 = 3.0;
        const STRETCH: usize = 16;
        let road = |shade: f64| color(self.colors.road.map(|c| c + shade));
        for stretch in self.tiles.chunks(STRETCH) {
            // there on the left, back on the right
            let mut outline = [[0.0; 2]; 2 * (STRETCH + 1)];
            let n = stretch.len();
            for (i, tile) in stretch.iter().enumerate() {
                let [left, right, right_before, left_before] = tile.road.map(|p| view.apply(p));
                if i == 0 {
                    (outline[0], outline[2 * n + 1]) = (left_before, right_before);
                }
                (outline[i + 1], outline[2 * n - i]) = (left, right);
            }
            let outline = &outline[..2 * n + 2];
            if is_visible(outline) {
                canvas.polygon(outline, road(0.01 * 255.0));
                // closes the seam to the stretch before
                canvas.line(outline[0], outline[2 * n + 1], 2.0, road(0.01 * 255.0));
            }
        }
        // tiles differ a little in shade until the car has been there
        if self.zoom() > SHADED_ZOOM {
            let (mut dark, mut bright) = (Batch::new(road(0.0)), Batch::new(road(0.02 * 255.0)));
            for (i, tile) in self.tiles.iter().enumerate() {
                let points = tile.road.map(|p| view.apply(p));
                match if self.touched[i] { 0 } else { i % 3 } {
                    0 => dark.push(canvas, points),
                    2 => bright.push(canvas, points),
                    _ => {}
                }
            }
            dark.flush(canvas);
            bright.flush(canvas);
        }
        let (mut white, mut red) = (Batch::new(Color::WHITE), Batch::new(Color::rgb(255, 0, 0)));
        for (i, tile) in self.tiles.iter().enumerate() {
            if let Some(border) = tile.border {
                let batch = if i % 2 == 0 { &mut white } else { &mut red };
                batch.push(canvas, border.map(|p| view.apply(p)));
            }
        }
        white.flush(canvas);
        red.flush(canvas);
    }

    fn draw_car(&self, canvas: &mut dyn Canvas) {
        for wheel in &self.car.wheels {
            common::draw_fixture(canvas, &self.world, wheel.fixture, Color::BLACK);
            if let Some(stripe) = Car::stripe(wheel) {
                let pose = self.world.pose(wheel.body);
                let stripe = stripe.map(|[x, y]| {
                    let p = pose.rotation * common::vec2(x, y) + pose.translation.vector;
                    [f64::from(p.x), f64::from(p.y)]
                });
                canvas.polygon(&stripe, Color::rgb(77, 77, 77));
            }
        }
        for fixture in self.car.hull_fixtures {
            common::draw_fixture(canvas, &self.world, fixture, Color::rgb(204, 0, 0));
        }
    }

    /// Speed, wheels, steering, turning, and the score.
    fn draw_indicators(&self, canvas: &mut dyn Canvas) {
        const S: f64 = WINDOW_W / 40.0;
        const H: f64 = WINDOW_H / 40.0;
        let state = self.state();
        canvas.rect([0.0, WINDOW_H - 5.0 * H], [WINDOW_W, 5.0 * H], Color::BLACK);
        let mut bar = |from: Point, to: Point, value: f64, color: Color| {
            if value.abs() > 1e-4 {
                let min = [from[0].min(to[0]), from[1].min(to[1])];
                canvas.rect(min, [(to[0] - from[0]).abs(), (to[1] - from[1]).abs()], color);
            }
        };
        let mut vertical = |place: f64, scale: f64, value: f64, color: Color| {
            let top = WINDOW_H - (H + H * scale * value);
            bar([place * S, top], [(place + 1.0) * S, WINDOW_H - H], value, color);
        };
        let [_, _, _, vx, vy, w] = state.hull;
        vertical(5.0, 0.02, (vx * vx + vy * vy).sqrt(), Color::WHITE);
        let (front, rear) = (Color::rgb(0, 0, 255), Color::rgb(51, 0, 255));
        for (place, (wheel, color)) in
            [7.0, 8.0, 9.0, 10.0].into_iter().zip(state.wheels.iter().zip([front, front, rear, rear]))
        {
            vertical(place, 0.01, wheel[1], color);
        }
        let mut horizontal = |place: f64, scale: f64, value: f64, color: Color| {
            let right = (place + scale * value) * S;
            bar([place * S, WINDOW_H - 4.0 * H], [right, WINDOW_H - 2.0 * H], value, color);
        };
        horizontal(20.0, -10.0, state.wheels[0][0], Color::rgb(0, 255, 0));
        horizontal(30.0, -0.8, w, Color::rgb(255, 0, 0));

        let score = Label::new(format_args!("{:04.0}", self.reward));
        canvas.text(
            &score,
            [60.0, WINDOW_H - WINDOW_H * 2.5 / 40.0 + 15.0],
            30.0,
            Align::Center,
            Color::WHITE,
        );
    }
}
