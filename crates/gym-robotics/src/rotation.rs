//! Euler angles, in the order of operations of Gymnasium-Robotics' `utils/rotations.py`.

use gym_core::math::{numpy_atan2, sin_cos};

/// The quaternion of Euler angles in rad: `euler2quat`.
pub(crate) fn euler_to_quat(euler: [f64; 3]) -> [f64; 4] {
    let [(si, ci), (sj, cj), (sk, ck)] =
        [euler[2] / 2.0, -euler[1] / 2.0, euler[0] / 2.0].map(sin_cos);
    let (cc, cs) = (ci * ck, ci * sk);
    let (sc, ss) = (si * ck, si * sk);
    [
        cj * cc + sj * ss,
        cj * cs - sj * sc,
        -(cj * ss + sj * cc),
        cj * sc - sj * cs,
    ]
}

/// The rotation matrix of a quaternion, by its rows: `quat2mat`.
pub(crate) fn quat_to_mat([w, x, y, z]: [f64; 4]) -> [f64; 9] {
    let length = w * w + x * x + y * y + z * z;
    if length.is_nan() || length <= f64::EPSILON {
        return [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    }
    let s = 2.0 / length;
    let [xs, ys, zs] = [x * s, y * s, z * s];
    [
        1.0 - (y * ys + z * zs),
        x * ys - w * zs,
        x * zs + w * ys,
        x * ys + w * zs,
        1.0 - (x * xs + z * zs),
        y * zs - w * xs,
        x * zs - w * ys,
        y * zs + w * xs,
        1.0 - (x * xs + y * ys),
    ]
}

/// The Euler angles of a rotation matrix, in rad: `mat2euler`.
pub(crate) fn mat_to_euler(m: &[f64; 9]) -> [f64; 3] {
    let [m00, m01, m02, m10, m11, m12, _, _, m22] = *m;
    let cy = (m22 * m22 + m12 * m12).sqrt();
    let straight = cy > 4.0 * f64::EPSILON;
    [
        if straight {
            -numpy_atan2(m12, m22)
        } else {
            0.0
        },
        -numpy_atan2(-m02, cy),
        if straight {
            -numpy_atan2(m01, m00)
        } else {
            -numpy_atan2(-m10, m11)
        },
    ]
}

/// The Euler angles of a quaternion, in rad: `quat2euler`.
pub(crate) fn quat_to_euler(quat: [f64; 4]) -> [f64; 3] {
    mat_to_euler(&quat_to_mat(quat))
}
