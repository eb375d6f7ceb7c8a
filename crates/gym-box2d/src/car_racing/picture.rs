//! Draws the observation and the frame: the playfield from above, rotated with the car, and a
//! dashboard.
//!
//! All shapes have the coordinates of Gymnasium's window of 1000x800 pixels, which pygame scales
//! down to the size of the observation or the frame.

use std::f64::consts::SQRT_2;

use gym_core::canvas::{Canvas, Color, Label, Point, Primitive};
use gym_core::pygame::{self, Rotation, UPRIGHT};
use gym_core::spaces::BoxSpace;
use gym_core::{Array, DType, Space};

use super::car::{Car, MARK_POINTS};
use super::{Episode, PLAYFIELD, SCALE, ScoreGlyphs, score};
use crate::shapes;

/// The size of Gymnasium's window.
pub(super) const WINDOW_W: f64 = 1000.0;
pub(super) const WINDOW_H: f64 = 800.0;
const STATE_W: usize = 96;
const STATE_H: usize = 96;
/// Camera zoom.
const ZOOM: f64 = 2.7;
/// Camera zoom at the start of an episode.
const START_ZOOM: f64 = 0.1;
/// The side of a grass patch; patches are two sides apart.
const GRASS_DIM: f64 = PLAYFIELD / 20.0;
/// The difference between two successive of the three shades of tiles.
const TILE_SHADE: f64 = 0.01;
/// The centre of the score, in pixels of the window.
const SCORE_CENTER: Point = [60.0, WINDOW_H - WINDOW_H * 2.5 / 40.0];

/// A bar of the dashboard: its column, in fortieths of the window's width, and its length per unit
/// of the value that it shows, in fortieths of the window.
struct Bar {
    column: f64,
    scale: f64,
    color: Color,
}

const SPEED_BAR: Bar = Bar {
    column: 5.0,
    scale: 0.02,
    color: Color::WHITE,
};
/// The bars of the first to the last wheel.
const WHEEL_BARS: [Bar; 4] = [
    wheel_bar(7.0, Color::rgb(0, 0, 255)),
    wheel_bar(8.0, Color::rgb(0, 0, 255)),
    wheel_bar(9.0, Color::rgb(51, 0, 255)),
    wheel_bar(10.0, Color::rgb(51, 0, 255)),
];
const STEERING_BAR: Bar = Bar {
    column: 20.0,
    scale: -10.0,
    color: Color::rgb(0, 255, 0),
};
const TURN_BAR: Bar = Bar {
    column: 30.0,
    scale: -0.8,
    color: Color::rgb(255, 0, 0),
};

const fn wheel_bar(column: f64, color: Color) -> Bar {
    Bar {
        column,
        scale: 0.01,
        color,
    }
}

/// The longest diagonal of a shape, in pixels of the window. Shapes further outside the window are
/// not drawn.
const MAX_SHAPE_DIM: f64 = GRASS_DIM * SQRT_2 * ZOOM * SCALE;

/// The space of observations: any image.
pub(super) fn space() -> Space {
    let space = BoxSpace::uniform(0.0, 255.0, [STATE_H, STATE_W, 3], DType::U8);
    space.map_or_else(
        |_| unreachable!("0 to 255 are bounds of bytes"),
        Space::from,
    )
}

/// Draws observations; reuses its buffers.
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
    /// Writes the observation of `episode` to `observation`.
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

/// The kind of image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scene {
    /// The observation.
    #[cfg_attr(not(feature = "picture"), expect(dead_code))]
    Observation,
    /// A frame: the observation after the step, with skid marks.
    Frame,
}

/// The transform from the playfield to the window.
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
        let zoom =
            START_ZOOM * SCALE * (1.0 - episode.t).max(0.0) + ZOOM * SCALE * episode.t.min(1.0);
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

    /// Draws the polygon `corners` of the playfield, if one of its corners is close enough to the
    /// window.
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
    /// Draws `scene` on `canvas`, in an image of the given size.
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
        score::draw(canvas, &text, SCORE_CENTER, glyphs);
        canvas.pop();
        canvas.pop();
    }

    /// Draws the background and the grass patches.
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

    /// Draws each tile and its kerb. Tiles vary slightly in shade until the car touches them.
    fn draw_road(&self, canvas: &mut dyn Canvas, view: &View) {
        for (i, tile) in self.tiles.iter().enumerate() {
            let shade = if self.touched[i] {
                0.0
            } else {
                TILE_SHADE * (i % 3) as f64 * 255.0
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
            let (mut corners, count) = shapes::corners(&self.world, wheel.fixture);
            fill(canvas, &mut corners[..count], Color::BLACK);
            if let Some(stripe) = Car::stripe(wheel) {
                let pose = self.world.pose(wheel.body);
                let mut stripe = stripe.map(|[x, y]| {
                    let p = pose.rotation * shapes::vec2(x, y) + pose.translation.vector;
                    [f64::from(p.x), f64::from(p.y)]
                });
                fill(canvas, &mut stripe, Color::rgb(77, 77, 77));
            }
        }
        for fixture in self.car.hull_fixtures {
            let (mut corners, count) = shapes::corners(&self.world, fixture);
            fill(canvas, &mut corners[..count], Color::rgb(204, 0, 0));
        }
    }

    /// Draws the bars of the dashboard: speed, wheel speeds, steering angle, angular velocity.
    fn draw_indicators(&self, canvas: &mut dyn Canvas) {
        const W: f64 = WINDOW_W;
        const H: f64 = WINDOW_H;
        const S: f64 = W / 40.0;
        const T: f64 = H / 40.0;
        let state = self.state();
        let mut draw = |value: f64, corners: [Point; 4], color: Color| {
            // Gymnasium hides the bar of a smaller value
            if value.abs() > 1e-4 {
                canvas.pygame(Primitive::Polygon(&corners), color);
            }
        };
        draw(
            1.0,
            [[W, H], [W, H - 5.0 * T], [0.0, H - 5.0 * T], [0.0, H]],
            Color::BLACK,
        );
        let vertical = |bar: &Bar, value: f64| {
            let top = H - (T + T * (bar.scale * value));
            let [left, right] = [bar.column * S, (bar.column + 1.0) * S];
            [[left, top], [right, top], [right, H - T], [left, H - T]]
        };
        let horizontal = |bar: &Bar, value: f64| {
            let [left, right] = [bar.column * S, (bar.column + bar.scale * value) * S];
            let [top, bottom] = [H - 4.0 * T, H - 2.0 * T];
            [[left, top], [right, top], [right, bottom], [left, bottom]]
        };
        let [_, _, _, vx, vy, w] = state.hull;
        let speed = (vx * vx + vy * vy).sqrt();
        draw(speed, vertical(&SPEED_BAR, speed), SPEED_BAR.color);
        for (bar, [_, omega, _]) in WHEEL_BARS.iter().zip(state.wheels) {
            draw(omega, vertical(bar, omega), bar.color);
        }
        let [[steering, ..], ..] = state.wheels;
        draw(
            steering,
            horizontal(&STEERING_BAR, steering),
            STEERING_BAR.color,
        );
        draw(w, horizontal(&TURN_BAR, w), TURN_BAR.color);
    }
}
