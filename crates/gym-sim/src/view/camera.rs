//! Perspective cameras; an orthographic camera is one that is far away.

use gym_core::canvas::Point;

use gym_core::math;
use mujoco_engine::math::{Mat3, Vec3, add_scaled, column, cross, dot, norm, scale, sub};

/// The near plane in m: points nearer than this are not drawn.
pub(super) const NEAR: f64 = 0.02;

/// A camera: its position, its right, up and forward directions, and its scale.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    pub(super) pos: Vec3,
    pub(super) right: Vec3,
    pub(super) up: Vec3,
    pub(super) ahead: Vec3,
    /// The size in pixels of a length of 1 m at a distance of 1 m.
    pub(super) focal: f64,
    /// Width and height of the picture.
    pub(super) size: [f64; 2],
    /// The point around which details are drawn: the point that the camera looks at, or a point
    /// ahead.
    pub(super) focus: Vec3,
    /// How far the camera stands behind the place that it stands for, in m.
    pub(super) back: f64,
}

impl Camera {
    /// A camera whose axes are the columns of a matrix: right, up, back.
    pub(super) fn new(pos: Vec3, axes: &Mat3, fovy: f64, size: [f64; 2]) -> Self {
        let (sin, cos) = math::sin_cos((fovy / 2.0).to_radians());
        let ahead = scale(column(axes, 2), -1.0);
        Self {
            pos,
            right: column(axes, 0),
            up: column(axes, 1),
            ahead,
            focal: size[1] / 2.0 * cos / sin,
            size,
            focus: add_scaled(pos, ahead, 3.0),
            back: 0.0,
        }
    }

    /// The camera with rays that are nearly parallel, and a view of this height in m: it steps back by
    /// a thousand heights, so that the edge of the view is off by a thousandth of how far a point is
    /// ahead, in heights.
    pub(super) fn orthographic(self, height: f64) -> Self {
        const HEIGHTS: f64 = 1000.0;
        let back = HEIGHTS * height;
        Self {
            pos: add_scaled(self.pos, self.ahead, -back),
            focal: self.size[1] * HEIGHTS,
            back,
            ..self
        }
    }

    /// A camera at a distance from a point, with azimuth and elevation in degrees: MuJoCo's free
    /// camera.
    pub(super) fn around(
        lookat: Vec3,
        distance: f64,
        [azimuth, elevation]: [f64; 2],
        fovy: f64,
        size: [f64; 2],
    ) -> Self {
        let (sin_a, cos_a) = math::sin_cos(azimuth.to_radians());
        let (sin_e, cos_e) = math::sin_cos(elevation.to_radians());
        let ahead = [cos_e * cos_a, cos_e * sin_a, sin_e];
        let right = [sin_a, -cos_a, 0.0];
        let up = cross(right, ahead);
        let axes = [
            right[0], up[0], -ahead[0], right[1], up[1], -ahead[1], right[2], up[2], -ahead[2],
        ];
        Self {
            focus: lookat,
            ..Self::new(add_scaled(lookat, ahead, -distance), &axes, fovy, size)
        }
    }

    /// A camera that looks at a point, with the horizon level.
    pub(super) fn towards(pos: Vec3, target: Vec3, fovy: f64, size: [f64; 2]) -> Self {
        let to = sub(target, pos);
        let distance = norm(to).max(1e-6);
        let azimuth = math::atan2(to[1], to[0]).to_degrees();
        let elevation = math::atan2(to[2], (to[0] * to[0] + to[1] * to[1]).sqrt()).to_degrees();
        Self::around(target, distance, [azimuth, elevation], fovy, size)
    }

    /// The distance of a point along the viewing direction.
    pub(super) fn depth(&self, point: Vec3) -> f64 {
        dot(sub(point, self.pos), self.ahead)
    }

    /// The position in the picture of a point in front of the camera.
    pub(super) fn project(&self, point: Vec3) -> Point {
        let to = sub(point, self.pos);
        let scale = self.focal / dot(to, self.ahead).max(NEAR);
        [
            self.size[0] / 2.0 + dot(to, self.right) * scale,
            self.size[1] / 2.0 - dot(to, self.up) * scale,
        ]
    }

    /// The direction `direction` projected on the picture plane; the length is 1 or less.
    pub(super) fn flat(&self, direction: Vec3) -> Point {
        [dot(direction, self.right), -dot(direction, self.up)]
    }

    /// The size in pixels of a length at a point.
    pub(super) fn pixels(&self, length: f64, at: Vec3) -> f64 {
        self.focal * length / self.depth(at).max(NEAR)
    }

    /// Projects a polygon, clipped at the near plane.
    pub(super) fn project_polygon(&self, corners: &[Vec3], out: &mut Vec<Point>) {
        out.clear();
        for (i, a) in corners.iter().enumerate() {
            let b = &corners[(i + 1) % corners.len()];
            let (near_a, near_b) = (self.depth(*a) - NEAR, self.depth(*b) - NEAR);
            if near_a >= 0.0 {
                out.push(self.project(*a));
            }
            if (near_a >= 0.0) != (near_b >= 0.0) {
                let t = near_a / (near_a - near_b);
                out.push(self.project(add_scaled(*a, sub(*b, *a), t)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lookat, distance, azimuth and elevation, and where libmujoco 3.12.0 shows three points in a
    /// picture of 480x360.
    const SEEN: [(Vec3, [f64; 3], [Point; 3]); 4] = [
        (
            [0.3, -0.2, 0.5],
            [3.2, 90.0, -12.0],
            [
                [214.0875, 149.2663],
                [147.33, 201.9499],
                [324.5585, 231.5445],
            ],
        ),
        (
            [0.0, 0.0, 1.15],
            [3.0, 60.0, -24.0],
            [
                [251.656, 232.593],
                [165.3825, 290.5644],
                [328.5722, 268.1336],
            ],
        ),
        (
            [0.1, 0.2, 0.3],
            [2.5, -112.0, -40.0],
            [
                [226.3486, 102.449],
                [336.8054, 178.6512],
                [88.7772, 247.107],
            ],
        ),
        (
            [0.0, 0.0, 0.0],
            [0.92, 90.0, -90.0],
            [[437.5266, 180.0], [-61.7767, -1.066], [712.3461, 132.7654]],
        ),
    ];

    #[test]
    fn the_free_camera_sees_points_where_mujocos_does() {
        for (lookat, [distance, azimuth, elevation], expected) in SEEN {
            let camera =
                Camera::around(lookat, distance, [azimuth, elevation], 45.0, [480.0, 360.0]);
            for (point, expected) in [[0.1, 0.0, 0.7], [-0.5, 0.3, 0.2], [1.0, 0.1, 0.0]]
                .iter()
                .zip(expected)
            {
                let seen = camera.project(*point);
                let off = (seen[0] - expected[0])
                    .abs()
                    .max((seen[1] - expected[1]).abs());
                // MuJoCo computes its camera in float32
                assert!(off < 2e-3, "{point:?}: {seen:?} for {expected:?}");
            }
        }
    }
}
