//! The picture of an episode.

use gym_core::canvas::{Canvas, Color, Primitive};
use gym_core::pygame;

use super::exhaust::{self, Exhaust};
use super::{CHUNKS, Episode, H, HELIPAD_Y, SCALE, VIEWPORT_H, chunk_x};
use crate::shapes;

impl Episode {
    /// Draws sky, exhaust and lander.
    pub(super) fn draw(&self, canvas: &mut dyn Canvas) {
        canvas.clear(Color::WHITE);
        canvas.push(pygame::flipped(VIEWPORT_H));
        for i in 0..CHUNKS - 1 {
            let (x1, x2) = (chunk_x(i), chunk_x(i + 1));
            let sky = [
                [x1, self.smooth_y[i]],
                [x2, self.smooth_y[i + 1]],
                [x2, H],
                [x1, H],
            ];
            shapes::draw_polygon(
                canvas,
                &sky.map(|corner| corner.map(|x| x * SCALE)),
                Color::BLACK,
            );
        }
        for (position, ttl) in self.exhaust.iter().flat_map(Exhaust::visible) {
            let shade = |x: f64| (x.max(0.2) * 255.0) as u8;
            let color = Color::rgb(shade(0.15 + ttl), shade(0.5 * ttl), shade(0.5 * ttl));
            let center = [position.x, position.y].map(|x| f64::from(x * SCALE as f32));
            let radius = f64::from(exhaust::RADIUS) * SCALE;
            canvas.pygame(Primitive::Circle { center, radius }, color);
            draw_flags(canvas);
        }
        for fixture in self.fixtures {
            let (corners, count) = shapes::pixel_corners(&self.world, fixture, SCALE);
            let corners = &corners[..count];
            shapes::draw_polygon(canvas, corners, Color::rgb(128, 102, 230));
            canvas.pygame(
                Primitive::AaLines {
                    points: corners,
                    closed: true,
                },
                Color::rgb(77, 77, 128),
            );
            draw_flags(canvas);
        }
        canvas.pop();
    }
}

/// Draws both flags; Gymnasium draws them again after each body.
fn draw_flags(canvas: &mut dyn Canvas) {
    for x in [chunk_x(CHUNKS / 2 - 1), chunk_x(CHUNKS / 2 + 1)] {
        let [x, y] = [x * SCALE, HELIPAD_Y * SCALE];
        let top = y + 50.0;
        let pole = Primitive::Lines {
            points: &[[x, y], [x, top]],
            closed: false,
            width: 1,
        };
        canvas.pygame(pole, Color::WHITE);
        let flag = [[x, top], [x, top - 10.0], [x + 25.0, top - 5.0]];
        shapes::draw_polygon(canvas, &flag, Color::rgb(204, 204, 0));
    }
}
