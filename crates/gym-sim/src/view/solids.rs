//! Shaded boxes and ellipsoids.

use gym_core::canvas::{Canvas, Color, Point};

use super::Scene;
use super::camera::NEAR;
use super::light::{LAYERS, LIGHT, lit, shade};
use gym_core::math;
use mujoco_engine::math::{
    Vec3, add, add_scaled, column, cross, dot, normalize, rotate, rotate_back, scale, sub,
};

/// Draws a box: its visible faces, shaded by their direction to the light.
pub(super) fn cuboid(scene: &Scene<'_>, g: usize, color: Color, canvas: &mut dyn Canvas) {
    let (camera, size) = (&scene.camera, scene.model.geom_size[g]);
    let (center, mat) = (scene.data.geom_xpos[g], &scene.data.geom_xmat[g]);
    let half: [Vec3; 3] = std::array::from_fn(|k| scale(column(mat, k), size[k]));
    for axis in 0..3 {
        for side in [1.0, -1.0] {
            let normal = scale(column(mat, axis), side);
            let middle = add_scaled(center, half[axis], side);
            if dot(normal, sub(camera.pos, middle)) <= 0.0 {
                continue;
            }
            let (u, v) = (half[(axis + 1) % 3], half[(axis + 2) % 3]);
            let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
                .map(|(s, t)| add_scaled(add_scaled(middle, u, s), v, t));
            if corners.iter().all(|corner| camera.depth(*corner) >= NEAR) {
                let points = corners.map(|corner| camera.project(corner));
                canvas.polygon(&points, lit(color, normal));
            }
        }
    }
}

/// Draws an ellipsoid as nested outlines, as for round shapes.
pub(super) fn ellipsoid(scene: &Scene<'_>, g: usize, color: Color, canvas: &mut dyn Canvas) {
    const CORNERS: usize = 28;
    let (camera, size) = (&scene.camera, scene.model.geom_size[g]);
    let (center, mat) = (scene.data.geom_xpos[g], &scene.data.geom_xmat[g]);
    if camera.depth(center) < NEAR + size[0].max(size[1]).max(size[2]) {
        return;
    }
    // scaled to a ball, the outline is the circle perpendicular to the viewing direction
    let view = rotate_back(mat, sub(camera.pos, center));
    let (towards, _) = normalize(std::array::from_fn(|k| view[k] / size[k]));
    let near = if towards[0].abs() < 0.6 {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    let (u, _) = normalize(cross(towards, near));
    let v = cross(towards, u);
    let rim: [Vec3; CORNERS] = std::array::from_fn(|i| {
        let (sin, cos) = math::sin_cos(i as f64 * std::f64::consts::TAU / CORNERS as f64);
        let ball = add(scale(u, cos), scale(v, sin));
        rotate(mat, std::array::from_fn(|k| ball[k] * size[k]))
    });
    let light = rotate_back(mat, LIGHT);
    let light = rotate(mat, std::array::from_fn(|k| light[k] * size[k]));
    for number in 0..LAYERS {
        let t = number as f64 / (LAYERS - 1) as f64;
        let middle = add_scaled(center, light, 0.46 * t);
        let shrink = 1.0 - 0.86 * t;
        let points: [Point; CORNERS] = rim.map(|at| camera.project(add_scaled(middle, at, shrink)));
        canvas.polygon(&points, shade(color, t));
    }
}
