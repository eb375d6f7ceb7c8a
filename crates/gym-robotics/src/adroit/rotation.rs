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

/// The Euler angles of a quaternion, in rad: `quat2euler`.
pub(crate) fn quat_to_euler([w, x, y, z]: [f64; 4]) -> [f64; 3] {
    let length = w * w + x * x + y * y + z * z;
    // (the same for each element of the rotation matrix that the angles need)
    let s = 2.0 / length;
    let [xs, ys, zs] = [x * s, y * s, z * s];
    let identity = length.is_nan() || length <= f64::EPSILON;
    let of = |diagonal: bool, element: f64| match identity {
        true => f64::from(diagonal),
        false => element,
    };
    let m00 = of(true, 1.0 - (y * ys + z * zs));
    let m01 = of(false, x * ys - w * zs);
    let m02 = of(false, x * zs + w * ys);
    let m10 = of(false, x * ys + w * zs);
    let m11 = of(true, 1.0 - (x * xs + z * zs));
    let m12 = of(false, y * zs - w * xs);
    let m22 = of(true, 1.0 - (x * xs + y * ys));
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
