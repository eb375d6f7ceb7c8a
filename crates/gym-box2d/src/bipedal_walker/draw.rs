//! The picture of an episode.

use gym_core::canvas::{Canvas, Color, Primitive, Transform};
use gym_core::pygame;

use super::{
    Episode, LIDAR_CYCLE, LIDAR_RAYS, SCALE, TERRAIN_HEIGHT, TERRAIN_LENGTH, TERRAIN_STEP,
    VIEWPORT_H, VIEWPORT_W,
};
use crate::physics::FixtureId;
use crate::shapes::{self, vec2};

impl Episode {
    /// Draws sky, ground, lidar, walker and the flag at the start.
    pub(super) fn draw(&self, canvas: &mut dyn Canvas) {
        let scroll = self.scroll();
        canvas.clear(Color::BLACK);
        // Gymnasium draws a wider image, from the start of the ground, and crops the image to its
        // right end
        let left = (VIEWPORT_W + scroll.max(0.0) * SCALE).trunc() - VIEWPORT_W;
        canvas.push(Transform::translate(-left, 0.0));
        canvas.push(pygame::flipped(VIEWPORT_H));
        // truncate to whole pixels as pygame does, so that the sky begins at the edge at any size
        let sky_left = (scroll * SCALE).trunc();
        let sky = pygame::corners([sky_left, 0.0], [sky_left + VIEWPORT_W, VIEWPORT_H]);
        let [a, b, c, d] = sky;
        canvas.pygame(Primitive::Polygon(&[a, d, c, b]), Color::rgb(215, 215, 255));
        for cloud in &self.clouds {
            let (left, right) = cloud
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), [x, _]| {
                    (low.min(*x), high.max(*x))
                });
            // clouds scroll at half speed
            if right >= scroll / 2.0 && left <= scroll / 2.0 + VIEWPORT_W / SCALE {
                let cloud = cloud.map(|[x, y]| [x * SCALE + scroll * SCALE / 2.0, y * SCALE]);
                shapes::draw_polygon(canvas, &cloud, Color::WHITE);
            }
        }
        self.draw_ground(canvas);
        self.draw_lidar(canvas);
        self.draw_terrain(canvas);
        self.draw_walker(canvas);
        let (x, bottom) = (TERRAIN_STEP * 3.0 * SCALE, TERRAIN_HEIGHT * SCALE);
        let top = bottom + 50.0;
        let pole = Primitive::AaLines {
            points: &[[x, bottom], [x, top]],
            closed: false,
        };
        canvas.pygame(pole, Color::BLACK);
        let flag = [[x, top], [x, top - 10.0], [x + 25.0, top - 5.0]];
        canvas.pygame(Primitive::Polygon(&flag), Color::rgb(230, 51, 0));
        canvas.pygame(
            Primitive::Lines {
                points: &flag,
                closed: true,
                width: 1,
            },
            Color::BLACK,
        );
        canvas.pop();
        canvas.pop();
    }

    /// The scroll position of the frame, in m.
    fn scroll(&self) -> f64 {
        f64::from(self.world.position(self.hull).x) - VIEWPORT_W / SCALE / 5.0
    }

    fn draw_ground(&self, canvas: &mut dyn Canvas) {
        let scroll = self.scroll();
        let point = |i: usize| [i as f64 * TERRAIN_STEP, self.terrain_y[i]];
        for i in 0..TERRAIN_LENGTH - 1 {
            let ([x1, y1], [x2, y2]) = (point(i), point(i + 1));
            if x2 >= scroll && x1 <= scroll + VIEWPORT_W / SCALE {
                let ground =
                    [[x1, y1], [x2, y2], [x2, 0.0], [x1, 0.0]].map(|p| p.map(|x| x * SCALE));
                shapes::draw_polygon(canvas, &ground, Color::rgb(102, 153, 76));
            }
        }
    }

    /// Draws one lidar ray per frame: first to last, then last to first, then none until the end of
    /// the cycle.
    fn draw_lidar(&self, canvas: &mut dyn Canvas) {
        let i = (self.pictures + 1) % LIDAR_CYCLE;
        if i >= 2 * LIDAR_RAYS {
            return;
        }
        let i = if i < LIDAR_RAYS {
            i
        } else {
            2 * LIDAR_RAYS - 1 - i
        };
        let (p1, end, fraction) = (
            self.world.position(self.hull),
            self.ray_end(i),
            self.lidar[i],
        );
        let p2 = if fraction < 1.0 {
            // the point at which the engine's ray meets the ground
            let end = vec2(end[0], end[1]);
            [
                (1.0 - fraction) * p1.x + fraction * end.x,
                (1.0 - fraction) * p1.y + fraction * end.y,
            ]
            .map(f64::from)
        } else {
            end
        };
        let points = [[p1.x, p1.y].map(f64::from), p2].map(|p| p.map(|x| x * SCALE));
        canvas.pygame(
            Primitive::Lines {
                points: &points,
                closed: false,
                width: 1,
            },
            Color::rgb(255, 0, 0),
        );
    }

    /// Draws the edges of the ground and the obstacles on it, last first.
    fn draw_terrain(&self, canvas: &mut dyn Canvas) {
        for i in (0..TERRAIN_LENGTH - 1).rev() {
            // rounded to `f32`, as in the world
            let point = |i: usize| {
                let at = vec2(i as f64 * TERRAIN_STEP, self.terrain_y[i]);
                [at.x, at.y].map(|x| f64::from(x * SCALE as f32))
            };
            let green = if i % 2 == 0 { 255 } else { 204 };
            let points = [point(i), point(i + 1)];
            canvas.pygame(
                Primitive::AaLines {
                    points: &points,
                    closed: false,
                },
                Color::rgb(76, green, 76),
            );
        }
        for fixture in self.obstacles.iter().rev() {
            self.draw_body(canvas, *fixture, [(255, 255, 255), (153, 153, 153)]);
        }
    }

    fn draw_body(&self, canvas: &mut dyn Canvas, fixture: FixtureId, colors: [(u8, u8, u8); 2]) {
        let (mut corners, count) = shapes::pixel_corners(&self.world, fixture, SCALE);
        let [fill, outline] = colors.map(|(r, g, b)| Color::rgb(r, g, b));
        shapes::draw_polygon(canvas, &corners[..count], fill);
        canvas.pygame(
            Primitive::Lines {
                points: &corners[..count],
                closed: true,
                width: 1,
            },
            outline,
        );
        // repeat the first corner: pygame then draws its pixel in full colour
        corners[count] = corners[0];
        canvas.pygame(Primitive::AaPolygon(&corners[..=count]), outline);
    }

    fn draw_walker(&self, canvas: &mut dyn Canvas) {
        let colors = [
            (178, 101, 152),
            (178, 101, 152),
            (128, 51, 102),
            (128, 51, 102),
            (127, 51, 229),
        ];
        let outlines = [
            (127, 76, 101),
            (127, 76, 101),
            (77, 26, 51),
            (77, 26, 51),
            (76, 76, 127),
        ];
        for ((fixture, fill), outline) in self.fixtures.iter().zip(colors).zip(outlines) {
            self.draw_body(canvas, *fixture, [fill, outline]);
        }
    }
}
