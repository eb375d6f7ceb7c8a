//! What a person does with a view: aims the camera, and points at a pixel.
//!
//! The free camera moves as that of MuJoCo's viewer: `mjv_moveCamera` in
//! `src/engine/engine_vis_interact.c` of MuJoCo (Apache-2.0).

use gym_core::canvas::Point;
use gym_core::math;

use super::camera::NEAR;
use super::{CameraConfig, FOVY, Mount, View, is_shown};
use mujoco_engine::math::{Vec3, add_scaled, dot, sub};
use mujoco_engine::physics::ray_among;
use mujoco_engine::{Data, Model};

/// The least and the greatest distance of the free camera, in extents of the model.
const DISTANCES: [f64; 2] = [0.01, 100.0];

/// The point of a geom that a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The geom.
    pub geom: usize,
    /// The geom's body; 0 is the world.
    pub body: usize,
    /// The point, in m.
    pub point: [f64; 3],
}

impl View {
    /// The free camera, with all of its values; `None` if the view is that of a camera of the model.
    #[must_use]
    pub fn free_camera(&self) -> Option<CameraConfig> {
        let Mount::Free { config, follows } = &self.mount else {
            return None;
        };
        let camera = CameraConfig::at(
            config.lookat,
            config.distance,
            config.azimuth,
            config.elevation,
        );
        Some(CameraConfig {
            trackbodyid: follows.map(|body| body as i32),
            ..camera
        })
    }

    /// Turns the free camera around the point that it looks at, by a movement of the pointer to the
    /// right and down, in heights of the picture: half a turn for a height.
    pub fn turn_by(&mut self, [right, down]: Point) {
        if let Mount::Free { config, .. } = &mut self.mount
            && right.is_finite()
            && down.is_finite()
        {
            let azimuth = (config.azimuth - 180.0 * right) % 360.0;
            config.azimuth = match azimuth {
                x if x > 180.0 => x - 360.0,
                x if x < -180.0 => x + 360.0,
                x => x,
            };
            config.elevation = (config.elevation - 180.0 * down).clamp(-89.0, 89.0);
        }
    }

    /// Moves the point that the free camera looks at, so that the picture moves with the pointer: by
    /// heights of the picture, to the right and down. Down is along the vertical, or, if `level`,
    /// along the ground. A camera that follows a body does not move.
    pub fn move_by(&mut self, [right, down]: Point, level: bool) {
        if let Mount::Free {
            config,
            follows: None,
        } = &mut self.mount
            && right.is_finite()
            && down.is_finite()
        {
            let (sin, cos) = math::sin_cos(config.azimuth.to_radians());
            let (sin_half, cos_half) = math::sin_cos((FOVY / 2.0).to_radians());
            // the height that the picture shows at the point
            let height = 2.0 * config.distance * sin_half / cos_half;
            let ahead = [cos, sin, 0.0];
            let (to_the_right, up) = ([sin, -cos, 0.0], [0.0, 0.0, 1.0]);
            let lookat = add_scaled(config.lookat, to_the_right, -right * height);
            let upwards = if level { ahead } else { up };
            config.lookat = add_scaled(lookat, upwards, down * height);
        }
    }

    /// Moves the free camera away from the point that it looks at, or, with a negative number,
    /// nearer, by a movement of the pointer in heights of the picture; a step of a wheel is 0.05. The
    /// distance stays within 0.01 to 100 extents of the model.
    pub fn zoom_by(&mut self, heights: f64, model: &Model) {
        if let Mount::Free { config, .. } = &mut self.mount
            && heights.is_finite()
        {
            let extent = model.stat.extent.max(1e-6);
            let slope = 9.0 * extent * math::ln(1.0 + config.distance / extent / 3.0);
            let [least, most] = DISTANCES.map(|x| x * extent);
            config.distance = (config.distance + slope * heights).clamp(least, most);
        }
    }

    /// Lets the free camera follow a body in x and y, or stay where it is.
    pub fn follow(&mut self, body: Option<usize>, data: &Data) {
        if let Mount::Free { config, follows } = &mut self.mount {
            if let Some(body) = *follows {
                let [x, y, _] = data.xpos[body];
                config.lookat = [x, y, config.lookat[2]];
            }
            *follows = body.filter(|body| (1..data.xpos.len()).contains(body));
        }
    }

    /// The ray through a point of the picture, which has the size `size`: where it starts, and its
    /// direction, with a length of 1 along the viewing direction.
    #[must_use]
    pub fn ray(&self, data: &Data, size: (u32, u32), [x, y]: Point) -> [Vec3; 2] {
        let camera = self.camera(data, size);
        let right = (x - camera.size[0] / 2.0) / camera.focal;
        let up = (camera.size[1] / 2.0 - y) / camera.focal;
        let along = add_scaled(add_scaled(camera.ahead, camera.right, right), camera.up, up);
        [camera.pos, along]
    }

    /// What a point of the picture shows; `None` for the sky. Sites and tendons are transparent.
    #[must_use]
    pub fn at(&self, model: &Model, data: &Data, size: (u32, u32), at: Point) -> Option<Hit> {
        let [from, along] = self.ray(data, size, at);
        let is_seen = |g: usize| g < self.max_geom && is_shown(model, g);
        let from = add_scaled(from, along, NEAR);
        let (distance, geom) = ray_among(model, data, from, along, is_seen)?;
        Some(Hit {
            geom,
            body: model.geom_bodyid[geom],
            point: add_scaled(from, along, distance),
        })
    }

    /// The distance of a point along the viewing direction.
    pub(crate) fn depth_at(&self, data: &Data, point: Vec3) -> f64 {
        let camera = self.camera(data, (1, 1));
        dot(sub(point, camera.pos), camera.ahead)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mujoco_engine::forward;

    const SIZE: (u32, u32) = (640, 480);

    fn model() -> (Model, Data, View) {
        let text = r#"<mujoco><worldbody><geom type="plane" size="5 5 1"/>
            <body name="ball" pos="0 0 1"><freejoint/><geom size="0.25"/></body>
            <body name="hidden" pos="0 -1 1"><geom size="0.3" group="3"/></body></worldbody></mujoco>"#;
        let model = Model::from_xml(text).unwrap();
        let mut data = Data::new(&model);
        forward(&model, &mut data);
        let camera = CameraConfig::at([0.0, 0.0, 1.0], 4.0, 90.0, 0.0);
        let view = View::new(&model, &camera).unwrap();
        (model, data, view)
    }

    #[test]
    fn a_pixel_shows_the_nearest_visible_geom() {
        let (model, data, view) = model();
        let hit = view.at(&model, &data, SIZE, [320.0, 240.0]).unwrap();
        assert_eq!((hit.geom, hit.body), (1, 1));
        assert!((hit.point[1] + 0.25).abs() < 1e-9, "{:?}", hit.point);
        // 480 pixels are 2 tan(22.5 degrees) times the distance
        let edge = 240.0 / 0.414_213_562 * 0.25 / 4.0;
        for (x, body) in [(edge * 0.97, Some(1)), (edge * 1.03, None)] {
            let hit = view.at(&model, &data, SIZE, [320.0 + x, 240.0]);
            assert_eq!(hit.map(|hit| hit.body), body, "{x}");
        }
        let floor = view.at(&model, &data, SIZE, [320.0, 470.0]).unwrap();
        assert_eq!((floor.body, floor.geom), (0, 0));
        assert!(floor.point[2].abs() < 1e-9 && view.at(&model, &data, SIZE, [9.0, 9.0]).is_none());
    }

    /// What is under the pointer stays under it.
    #[test]
    fn the_picture_moves_with_the_pointer() {
        let (_, data, mut view) = model();
        let before = view.camera(&data, SIZE).project([0.0, 0.0, 1.0]);
        view.move_by([0.1, 0.25], false);
        let after = view.camera(&data, SIZE).project([0.0, 0.0, 1.0]);
        for (k, moved) in [48.0, 120.0].into_iter().enumerate() {
            assert!(
                (after[k] - before[k] - moved).abs() < 1e-9,
                "{before:?} {after:?}"
            );
        }
        let camera = view.free_camera().unwrap();
        view.move_by([0.0, 0.1], true);
        let [x, y, z] = view.free_camera().unwrap().lookat.unwrap();
        let [x0, y0, z0] = camera.lookat.unwrap();
        assert!(
            (x - x0).abs() < 1e-12 && y > y0 && z == z0,
            "along the ground"
        );
        // following a body, it does not move
        view.follow(Some(1), &data);
        let camera = view.free_camera().unwrap();
        view.move_by([0.3, 0.3], false);
        assert_eq!(view.free_camera().unwrap(), camera);
        assert_eq!(camera.trackbodyid, Some(1));
        view.follow(None, &data);
        assert_eq!(view.free_camera().unwrap().lookat.unwrap()[..2], [0.0; 2]);
    }

    #[test]
    fn turns_and_distances_have_bounds() {
        let (model, _, mut view) = model();
        view.turn_by([0.5, 0.1]);
        let camera = view.free_camera().unwrap();
        assert_eq!((camera.azimuth, camera.elevation), (Some(0.0), Some(-18.0)));
        view.turn_by([1.25, 9.0]);
        let camera = view.free_camera().unwrap();
        assert_eq!(
            (camera.azimuth, camera.elevation),
            (Some(135.0), Some(-89.0))
        );
        view.turn_by([f64::NAN, 0.0]);
        view.zoom_by(f64::INFINITY, &model);
        assert_eq!(view.free_camera().unwrap(), camera);
        let extent = model.stat.extent;
        for (amount, distance) in [(1e9, 100.0 * extent), (-1e9, 0.01 * extent)] {
            view.zoom_by(amount, &model);
            assert_eq!(view.free_camera().unwrap().distance, Some(distance));
        }
    }
}
