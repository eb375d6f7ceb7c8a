//! Depth images.

use std::ops::Range;

use super::camera::{Camera, NEAR};
use super::{View, floor_of, is_shown, is_wall, meshes};
use mujoco_engine::math::{Vec3, add_scaled, dot, sub};
use mujoco_engine::model::GeomType;
use mujoco_engine::physics::ray_shape;
use mujoco_engine::{Data, Model};

/// The far plane, in extents of the model: MuJoCo's `zfar`. Surfaces beyond it are not shown.
const FAR: f64 = 50.0;

impl View {
    /// The depth of each pixel, row by row from the top: the distance in metres, along the viewing
    /// direction, of the surface that the pixel shows. A pixel without a surface has 50 times the
    /// model's extent, MuJoCo's far plane.
    ///
    /// The surfaces are those of the geoms that [`draw`](Self::draw) shows, without the markers of
    /// sites.
    #[must_use]
    pub fn depth(&self, model: &Model, data: &Data, size: (u32, u32)) -> Vec<f32> {
        self.depth_of(model, data, size, size)
    }

    /// The depths for a picture of size `picture`, sampled at `width` by `height` pixels.
    pub(crate) fn depth_of(
        &self,
        model: &Model,
        data: &Data,
        picture: (u32, u32),
        (width, height): (u32, u32),
    ) -> Vec<f32> {
        let camera = self.camera(data, picture);
        let far = (FAR * model.stat.extent) as f32;
        let (columns, rows) = (width as usize, height as usize);
        // the width and height of a result pixel, in pixels of the picture
        let step = [
            camera.size[0] / f64::from(width),
            camera.size[1] / f64::from(height),
        ];
        let back = camera.back as f32;
        let mut depths = vec![far + back; columns * rows];
        let floor = floor_of(model, data, self.max_geom);
        for g in (0..model.ngeom()).take(self.max_geom) {
            let plane = model.geom_type[g] == GeomType::Plane;
            let unseen = plane && floor != Some(g) && !is_wall(model, g);
            if unseen || !is_shown(model, g) || meshes::is_mesh(model, g) {
                continue;
            }
            let [across, down] = if plane {
                [0..columns, 0..rows]
            } else {
                bounds(&camera, data.geom_xpos[g], model.geom_rbound[g], step)
            };
            let place = (data.geom_xpos[g], &data.geom_xmat[g]);
            for y in down {
                for x in across.clone() {
                    let middle = [(x as f64 + 0.5) * step[0], (y as f64 + 0.5) * step[1]];
                    let along = direction(&camera, middle);
                    let kind = model.geom_type[g].into();
                    let depth = ray_shape(kind, place, model.geom_size[g], camera.pos, along);
                    let least = &mut depths[y * columns + x];
                    if depth > NEAR && (depth as f32) < *least {
                        *least = depth as f32;
                    }
                }
            }
        }
        if meshes::has_any(model, self.max_geom) {
            let scene = self.scene(model, data, picture);
            let focal = step.map(|step| camera.focal / step);
            meshes::depths(&scene, self.max_geom, ([columns, rows], focal), &mut depths);
        }
        for depth in &mut depths {
            *depth = if *depth < far + back {
                *depth - back
            } else {
                far
            };
        }
        depths
    }
}

/// The direction from the camera to a point of the picture, scaled to a depth of one metre.
fn direction(camera: &Camera, [x, y]: [f64; 2]) -> Vec3 {
    let [width, height] = camera.size;
    let right = (x - width / 2.0) / camera.focal;
    let up = (height / 2.0 - y) / camera.focal;
    add_scaled(add_scaled(camera.ahead, camera.right, right), camera.up, up)
}

/// The columns and rows of pixels that a ball can cover. A pixel is `step` pixels of the picture
/// wide and high.
fn bounds(camera: &Camera, centre: Vec3, radius: f64, step: [f64; 2]) -> [Range<usize>; 2] {
    let from = sub(centre, camera.pos);
    let ahead = dot(from, camera.ahead);
    let range = |along: f64, length: f64, step: f64| {
        let pixel = |x: f64| (x.clamp(0.0, length) / step).round() as usize;
        if ahead - radius <= NEAR {
            return 0..pixel(length);
        }
        let slope = along / ahead;
        let middle = length / 2.0 + camera.focal * slope;
        let reach = camera.focal * radius * (1.0 + slope.abs()) / (ahead - radius) + step;
        pixel(middle - reach)..pixel(middle + reach)
    };
    [
        range(dot(from, camera.right), camera.size[0], step[0]),
        range(-dot(from, camera.up), camera.size[1], step[1]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::CameraConfig;
    use mujoco_engine::forward;

    /// A pixel of an orthographic camera's picture is as wide near the camera as far from it.
    #[test]
    fn an_orthographic_camera_sees_lengths() {
        let text = r#"<mujoco><worldbody><geom type="plane" size="0 0 1"/>
            <camera pos="0 0 5" projection="orthographic" fovy="4"/>
            <geom type="box" size="0.31 0.31 0.1" pos="-1 0 4"/><geom type="box" size="0.31 0.31 0.1" pos="1 0 1"/></worldbody></mujoco>"#;
        let model = Model::from_xml(text).unwrap();
        let mut data = Data::new(&model);
        forward(&model, &mut data);
        let depths = View::of_camera(&model, 0).depth(&model, &data, (200, 100));
        let row: Vec<f64> = depths[50 * 200..51 * 200]
            .iter()
            .map(|x| f64::from(*x))
            .collect();
        for (x, depth) in row.iter().enumerate() {
            // 25 pixels are 1 m, and the camera is above the middle
            let at = (x as f64 + 0.5 - 100.0) / 25.0;
            let within = |middle: f64| (at - middle).abs() < 0.31;
            let expected = if within(-1.0) {
                0.9
            } else if within(1.0) {
                3.9
            } else {
                5.0
            };
            assert!(
                (depth - expected).abs() < 1e-3,
                "{at}: {depth} for {expected}"
            );
        }
    }

    #[test]
    fn depths_are_distances_ahead() {
        let text = r#"<mujoco><worldbody><geom type="plane" size="0 0 1"/>
            <geom type="sphere" size="0.5" pos="0 0 2"/><geom type="box" size="0.2 0.2 0.2" pos="1.5 0 1"/></worldbody></mujoco>"#;
        let model = Model::from_xml(text).unwrap();
        let mut data = Data::new(&model);
        forward(&model, &mut data);
        // from above
        let camera = CameraConfig::at([0.0, 0.0, 0.0], 6.0, 90.0, -90.0);
        let view = View::new(&model, &camera).unwrap();
        let (width, height) = (201, 101);
        let depths = view.depth(&model, &data, (width, height));
        let at = |x: u32, y: u32| f64::from(depths[(y * width + x) as usize]);
        assert!((at(100, 50) - 3.5).abs() < 1e-6, "the top of the sphere");
        assert!((at(2, 2) - 6.0).abs() < 1e-5, "the floor, in a corner too");
        // half of the picture's height spans 22.5 degrees, whose tangent is sqrt(2) - 1
        let focal = 50.5 / (2f64.sqrt() - 1.0);
        let right = 100.0 + focal * 1.5 / 4.8;
        assert!(
            (at(right as u32, 50) - 4.8).abs() < 1e-5,
            "the top of the box"
        );
        let ahead = CameraConfig::at([0.0, 0.0, 1.0], 6.0, 90.0, 0.0);
        let view = View::new(&model, &ahead).unwrap();
        let depths = view.depth(&model, &data, (width, height));
        assert_eq!(
            f64::from(depths[0]),
            f64::from((50.0 * model.stat.extent) as f32),
            "the sky"
        );
    }
}
