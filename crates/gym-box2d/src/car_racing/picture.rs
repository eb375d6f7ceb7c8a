//! The driver's view: the field from above, turned with the car, and a dashboard.
//!
//! All is drawn in the coordinates of Gymnasium's window of 1000x800 pixels, which pygame shrinks
//! to the observation and to the frame.

use std::f64::consts::SQRT_2;

use gym_core::canvas::{Canvas, Color, Label, Point, Primitive};
use gym_core::pygame::{self, Rotation, UPRIGHT};
use gym_core::spaces::BoxSpace;
use gym_core::{Array, DType, Space};

use super::car::{Car, MARK_POINTS};
use super::{Episode, PLAYFIELD, SCALE, ScoreGlyphs, score};
use crate::common;

/// The size of Gymnasium's window.
pub(super) const WINDOW_W: f64 = 1000.0;
pub(super) const WINDOW_H: f64 = 800.0;
const STATE_W: usize = 96;
const STATE_H: usize = 96;
/// Camera zoom.
const ZOOM: f64 = 2.7;
/// Side of a grass patch, and half the distance of two.
const GRASS_DIM: f64 = PLAYFIELD / 20.0;
/// Longest diagonal of a shape, in pixels of the window: shapes so far outside are not drawn.
const MAX_SHAPE_DIM: f64 = GRASS_DIM * SQRT_2 * ZOOM * SCALE;

/// The space of observations: any image.
pub(super) fn space() -> Space {
    let space = BoxSpace::uniform(0.0, 255.0, [STATE_H, STATE_W, 3], DType::U8);
    space.map_or_else(
        |_| unreachable!("0 to 255 are bounds of bytes"),
        Space::from,
    )
}

/// Draws observations, and keeps the buffers.
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
    /// Writes an image of the episode to `observation`.
    pub(super) fn take(
        &mut self,
        episode: &Episode,
        glyphs: Option<&ScoreGlyphs>,
        observation: &mut Array,
    ) {
        if observation.shape() != [STATE_H, STATE_W, 3] || observation.dtype() != DType::U8 {
            *observation = Array::zeros(DType::U8, [STATE_H, STATE_W, 3]).unwrap_or_default();
        }
        #[cfg(feature = "picture")]
        {
            use gym_core::render::{Frame, Painter};

            if self.frame.width() == 0 {
                self.frame = Frame::new(STATE_W as u32, STATE_H as u32).unwrap_or_default();
            }
            let size = (STATE_W as u32, STATE_H as u32);
            self.raster.paint(
                size,
                &mut |canvas| episode.draw(canvas, size, Scene::Observation, glyphs),
                &mut self.frame,
            );
            if let Some(pixels) = observation.as_mut_slice::<u8>() {
                pixels.copy_from_slice(self.frame.pixels());
            }
        }
        #[cfg(not(feature = "picture"))]
        let _ = (episode, glyphs);
    }
}

fn color([r, g, b]: [f64; 3]) -> Color {
    Color::rgb(r as u8, g as u8, b as u8)
}

/// The kinds of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scene {
    /// The observation.
    #[cfg_attr(not(feature = "picture"), expect(dead_code))]
    Observation,
    /// The same at the end of the step, with skid marks.
    Frame,
}

/// From the field to the window.
struct View {
    zoom: f64,
    rotation: Rotation,
    translation: Point,
}

impl View {
    fn new(episode: &Episode) -> Self {
        let (world, hull) = (&episode.world, episode.car.hull);
        let rotation = Rotation::new(-f64::from(world.angle(hull)));
        // the camera zooms in during the first second
        let zoom = 0.1 * SCALE * (1.0 - episode.t).max(0.0) + ZOOM * SCALE * episode.t.min(1.0);
        let position = world.position(hull);
        let scroll = [-f64::from(position.x) * zoom, -f64::from(position.y) * zoom];
        let [x, y] = rotation.apply(scroll);
        Self {
            zoom,
            rotation,
            translation: [WINDOW_W / 2.0 + x, WINDOW_H / 4.0 + y],
        }
    }

    fn apply(&self, point: Point) -> Point {
        let [x, y] = self.rotation.apply(point);
        [
            x * self.zoom + self.translation[0],
            y * self.zoom + self.translation[1],
        ]
    }

    /// Draws a shape of the field, if a corner of it is near enough to the window.
    fn draw(&self, canvas: &mut dyn Canvas, corners: [Point; 4], color: Color) {
        let near = |x: f64, size: f64| (-MAX_SHAPE_DIM..=size + MAX_SHAPE_DIM).contains(&x);
        let corners = corners.map(|corner| self.apply(corner));
        if corners
            .iter()
            .any(|[x, y]| near(*x, WINDOW_W) && near(*y, WINDOW_H))
        {
            pygame::gfx_polygon(canvas, &corners, color);
        }
    }
}

impl Episode {
    /// Draws a scene in an image of that size.
    pub(super) fn draw(
        &self,
        canvas: &mut dyn Canvas,
        size: (u32, u32),
        scene: Scene,
        glyphs: Option<&ScoreGlyphs>,
    ) {
        canvas.push_smoothscaled((WINDOW_W as u32, WINDOW_H as u32), size);
        canvas.clear(Color::BLACK);
        canvas.push(pygame::flipped(WINDOW_H));
        let view = View::new(self);
        self.draw_grass(canvas, &view);
        self.draw_road(canvas, &view);
        if scene == Scene::Frame {
            self.draw_skid_marks(canvas, &view);
        }
        self.draw_car(canvas, &view);
        canvas.pop();
        canvas.push(UPRIGHT);
        let score = if scene == Scene::Frame {
            self.reward
        } else {
            self.observed_reward
        };
        self.draw_indicators(canvas);
        let text = Label::new(format_args!("{score:04.0}"));
        score::draw(
            canvas,
            &text,
            [60.0, WINDOW_H - WINDOW_H * 2.5 / 40.0],
            glyphs,
        );
        canvas.pop();
        canvas.pop();
    }

    /// The field in its colour, with patches.
    fn draw_grass(&self, canvas: &mut dyn Canvas, view: &View) {
        const B: f64 = PLAYFIELD;
        let field = [[B, B], [B, -B], [-B, -B], [-B, B]].map(|corner| view.apply(corner));
        pygame::gfx_polygon(canvas, &field, color(self.colors.background));
        for x in (-20..20).step_by(2).map(|x| GRASS_DIM * f64::from(x)) {
            for y in (-20..20).step_by(2).map(|y| GRASS_DIM * f64::from(y)) {
                let patch = [
                    [x + GRASS_DIM, y + 0.0],
                    [x + 0.0, y + 0.0],
                    [x + 0.0, y + GRASS_DIM],
                    [x + GRASS_DIM, y + GRASS_DIM],
                ];
                view.draw(canvas, patch, color(self.colors.grass));
            }
        }
    }

    /// Each tile and its kerb. Tiles differ a little in shade until the car has been there.
    fn draw_road(&self, canvas: &mut dyn Canvas, view: &View) {
        for (i, tile) in self.tiles.iter().enumerate() {
            let shade = if self.touched[i] {
                0.0
            } else {
                0.01 * (i % 3) as f64 * 255.0
            };
            view.draw(
                canvas,
                tile.road,
                color(self.colors.road.map(|c| c + shade)),
            );
            if let Some(border) = tile.border {
                let color = if i % 2 == 0 {
                    Color::WHITE
                } else {
                    Color::rgb(255, 0, 0)
                };
                view.draw(canvas, border, color);
            }
        }
    }

    fn draw_skid_marks(&self, canvas: &mut dyn Canvas, view: &View) {
        for mark in &self.car.marks {
            let mut points = [[0.0; 2]; MARK_POINTS];
            let points = &mut points[..mark.points.len().min(MARK_POINTS)];
            for (point, place) in points.iter_mut().zip(&mark.points) {
                *point = view.apply(*place);
            }
            let color = if mark.on_grass {
                Color::rgb(102, 102, 0)
            } else {
                Color::BLACK
            };
            canvas.pygame(
                Primitive::Lines {
                    points,
                    closed: false,
                    width: 2,
                },
                color,
            );
        }
    }

    fn draw_car(&self, canvas: &mut dyn Canvas, view: &View) {
        let fill = |canvas: &mut dyn Canvas, corners: &mut [Point], color| {
            corners
                .iter_mut()
                .for_each(|corner| *corner = view.apply(*corner));
            canvas.pygame(Primitive::Polygon(corners), color);
        };
        for wheel in &self.car.wheels {
            let (mut corners, count) = common::corners(&self.world, wheel.fixture);
            fill(canvas, &mut corners[..count], Color::BLACK);
            if let Some(stripe) = Car::stripe(wheel) {
                let pose = self.world.pose(wheel.body);
                let mut stripe = stripe.map(|[x, y]| {
                    let p = pose.rotation * common::vec2(x, y) + pose.translation.vector;
                    [f64::from(p.x), f64::from(p.y)]
                });
                fill(canvas, &mut stripe, Color::rgb(77, 77, 77));
            }
        }
        for fixture in self.car.hull_fixtures {
            let (mut corners, count) = common::corners(&self.world, fixture);
            fill(canvas, &mut corners[..count], Color::rgb(204, 0, 0));
        }
    }

    /// Speed, wheels, steering, and turning.
    fn draw_indicators(&self, canvas: &mut dyn Canvas) {
        const W: f64 = WINDOW_W;
        const H: f64 = WINDOW_H;
        const S: f64 = W / 40.0;
        const T: f64 = H / 40.0;
        let state = self.state();
        let mut bar = |value: f64, corners: [Point; 4], color: Color| {
            if value.abs() > 1e-4 {
                canvas.pygame(Primitive::Polygon(&corners), color);
            }
        };
        bar(
            1.0,
            [[W, H], [W, H - 5.0 * T], [0.0, H - 5.0 * T], [0.0, H]],
            Color::BLACK,
        );
        let vertical = |place: f64, value: f64| {
            let top = H - (T + T * value);
            [
                [place * S, top],
                [(place + 1.0) * S, top],
                [(place + 1.0) * S, H - T],
                [place * S, H - T],
            ]
        };
        let horizontal = |place: f64, value: f64| {
            let (left, right) = (place * S, (place + value) * S);
            [
                [left, H - 4.0 * T],
                [right, H - 4.0 * T],
                [right, H - 2.0 * T],
                [left, H - 2.0 * T],
            ]
        };
        let [_, _, _, vx, vy, w] = state.hull;
        let true_speed = (vx * vx + vy * vy).sqrt();
        bar(true_speed, vertical(5.0, 0.02 * true_speed), Color::WHITE);
        let (front, rear) = (Color::rgb(0, 0, 255), Color::rgb(51, 0, 255));
        for (place, (wheel, color)) in [7.0, 8.0, 9.0, 10.0]
            .into_iter()
            .zip(state.wheels.iter().zip([front, front, rear, rear]))
        {
            bar(wheel[1], vertical(place, 0.01 * wheel[1]), color);
        }
        let steering = state.wheels[0][0];
        bar(
            steering,
            horizontal(20.0, -10.0 * steering),
            Color::rgb(0, 255, 0),
        );
        bar(w, horizontal(30.0, -0.8 * w), Color::rgb(255, 0, 0));
    }
}
