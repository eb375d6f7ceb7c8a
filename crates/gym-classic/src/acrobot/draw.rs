//! The picture of the two links.

use std::f64::consts::PI;

use gym_core::canvas::{Canvas, Color, Primitive};
use gym_core::math::{numpy_sin_cos_f32, sin_cos};
use gym_core::pygame;

use super::{AcrobotDynamics, State};

impl AcrobotDynamics {
    /// Draws the line of the goal and the links.
    pub(super) fn draw_links(&self, state: &State, canvas: &mut dyn Canvas) {
        const MIDDLE: f64 = 250.0;
        let lengths = [self.config.LINK_LENGTH_1, self.config.LINK_LENGTH_2];
        let scale = 500.0 / ((lengths[0] + lengths[1] + 0.2) * 2.0); // pixels per m
        let radius = 0.1 * scale;

        canvas.clear(Color::WHITE);
        canvas.push(pygame::flipped(500.0));
        let goal = [-2.2, 2.2].map(|x| [x * scale + MIDDLE, scale + MIDDLE]);
        canvas.pygame(
            Primitive::Lines {
                points: &goal,
                closed: false,
                width: 1,
            },
            Color::BLACK,
        );
        // the first state is `float32`, and numpy's results computed from this state are `float32`
        // too
        let number = |x: f64| if state.fresh { f64::from(x as f32) } else { x };
        let (sin, cos) = if state.fresh {
            let (sin, cos) = numpy_sin_cos_f32(state.theta1 as f32);
            (f64::from(sin), f64::from(cos))
        } else {
            sin_cos(state.theta1)
        };
        let elbow = [sin, -cos].map(|x| number(number(number(lengths[0]) * x) * number(scale)));
        let angle = |theta: f64| number(theta - number(PI / 2.0));
        let links = [
            ([0.0, 0.0], angle(state.theta1), lengths[0]),
            (
                elbow,
                angle(number(state.theta1 + state.theta2)),
                lengths[1],
            ),
        ];
        for (joint, angle, length) in links {
            let [x, y] = joint.map(|x| x + MIDDLE);
            let link = pygame::corners([0.0, -radius], [length * scale, radius]).map(|corner| {
                let corner = pygame::rotate_rad(corner, angle);
                [corner[0] + x, corner[1] + y]
            });
            pygame::gfx_polygon(canvas, &link, Color::rgb(0, 204, 204));
            pygame::gfx_circle(canvas, [x, y], radius, Color::rgb(204, 204, 0));
        }
        canvas.pop();
    }
}
