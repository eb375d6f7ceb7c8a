//! Orientations: the forms in which MJCF gives them, as quaternions `w, x, y, z`.

use super::xml::Element;
use crate::physics::spatial::{Quat, axis_angle, cross, mul_quat, normalize_quat};
use crate::{Result, libm};

const IDENTITY: Quat = [1.0, 0.0, 0.0, 0.0];

/// Below this length a direction is no direction: `mjEPS`.
pub(super) const EPS: f64 = 1e-14;

/// An orientation as it is written. A form other than `quat` takes precedence, even one of a default class.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Orientation {
    quat: Quat,
    other: Option<Form>,
}

#[derive(Clone, Debug, PartialEq)]
enum Form {
    AxisAngle([f64; 4]),
    Euler([f64; 3]),
    XyAxes([f64; 6]),
    ZAxis([f64; 3]),
}

impl Default for Orientation {
    fn default() -> Self {
        Self { quat: IDENTITY, other: None }
    }
}

impl Orientation {
    /// Reads `quat`, `axisangle` and `euler`.
    pub(super) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.read_forms(element, false)
    }

    /// Reads these and `xyaxes` and `zaxis`, which are for cameras.
    pub(super) fn read_of_camera(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.read_forms(element, true)
    }

    fn read_forms(&mut self, element: &mut Element<'_, '_>, axes: bool) -> Result<()> {
        let mut given = Vec::new();
        if let Some(quat) = element.numbers::<4>("quat")? {
            if norm(&quat) < EPS {
                return Err(element.place().attribute("quat", "the quaternion is zero"));
            }
            self.quat = quat;
            given.push("quat");
        }
        if let Some(axis_angle) = element.numbers::<4>("axisangle")? {
            if norm(&axis_angle[..3]) < EPS {
                return Err(element.place().attribute("axisangle", "the axis is zero"));
            }
            self.other = Some(Form::AxisAngle(axis_angle));
            given.push("axisangle");
        }
        if let Some(euler) = element.numbers("euler")? {
            self.other = Some(Form::Euler(euler));
            given.push("euler");
        }
        if axes {
            if let Some(xyaxes) = element.numbers::<6>("xyaxes")? {
                if plane_of(&xyaxes).is_none() {
                    return Err(element.place().attribute("xyaxes", "the axes are zero or parallel"));
                }
                self.other = Some(Form::XyAxes(xyaxes));
                given.push("xyaxes");
            }
            if let Some(zaxis) = element.numbers::<3>("zaxis")? {
                if norm(&zaxis) < EPS {
                    return Err(element.place().attribute("zaxis", "the axis is zero"));
                }
                self.other = Some(Form::ZAxis(zaxis));
                given.push("zaxis");
            }
        }
        match given[..] {
            [_, second, ..] => {
                Err(element.place().attribute(second, format!("only one of {}", given.join(", "))))
            }
            _ => Ok(()),
        }
    }

    /// The quaternion; angles are in degrees where `degree`.
    pub(super) fn resolve(&self, degree: bool) -> Quat {
        let radians = |angle: f64| if degree { angle / 180.0 * std::f64::consts::PI } else { angle };
        match &self.other {
            None => normalize_quat(self.quat),
            Some(Form::AxisAngle([x, y, z, angle])) => {
                let length = norm(&[*x, *y, *z]);
                normalize_quat(axis_angle([x / length, y / length, z / length], radians(*angle)))
            }
            Some(Form::Euler(angles)) => {
                let mut quat = IDENTITY;
                for (axis, angle) in
                    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into_iter().zip(angles)
                {
                    quat = mul_quat(quat, axis_angle(axis, radians(*angle)));
                }
                normalize_quat(quat)
            }
            Some(Form::XyAxes(axes)) => plane_of(axes).map_or(IDENTITY, |[x, y, z]| from_columns(x, y, z)),
            Some(Form::ZAxis(axis)) => from_z(*axis),
        }
    }
}

/// The shortest rotation that turns the z axis to a direction; by half a turn about x where it is opposite.
pub(super) fn from_z(direction: [f64; 3]) -> Quat {
    let length = norm(&direction);
    let [x, y, z] = direction.map(|c| c / length);
    let sin = norm(&[-y, x]);
    let axis = if sin < 1e-10 { [1.0, 0.0, 0.0] } else { [-y / sin, x / sin, 0.0] };
    axis_angle(axis, libm::atan2(sin, z))
}

/// Right-handed unit axes from an x axis and a vector in the xy plane; `None` where they do not span one.
fn plane_of(axes: &[f64; 6]) -> Option<[[f64; 3]; 3]> {
    let x = unit([axes[0], axes[1], axes[2]])?;
    let along = (0..3).map(|i| x[i] * axes[3 + i]).sum::<f64>();
    let y = unit([axes[3] - along * x[0], axes[4] - along * x[1], axes[5] - along * x[2]])?;
    Some([x, y, cross(x, y)])
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = norm(&v);
    (length >= EPS).then(|| v.map(|x| x / length))
}

/// The quaternion of a rotation matrix with these columns.
fn from_columns(x: [f64; 3], y: [f64; 3], z: [f64; 3]) -> Quat {
    let trace = x[0] + y[1] + z[2];
    let quat = if trace > 0.0 {
        [1.0 + trace, y[2] - z[1], z[0] - x[2], x[1] - y[0]]
    } else if x[0] > y[1] && x[0] > z[2] {
        [y[2] - z[1], 1.0 + x[0] - y[1] - z[2], y[0] + x[1], z[0] + x[2]]
    } else if y[1] > z[2] {
        [z[0] - x[2], y[0] + x[1], 1.0 - x[0] + y[1] - z[2], z[1] + y[2]]
    } else {
        [x[1] - y[0], z[0] + x[2], z[1] + y[2], 1.0 - x[0] - y[1] + z[2]]
    };
    normalize_quat(quat)
}

pub(super) fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::spatial::quat_to_mat;

    /// Turns by about half a turn have no positive trace, and go by the largest of their axes.
    #[test]
    fn axes_of_every_turn_have_their_quaternion() {
        for axis in [[1.0, 0.2, -0.3], [0.1, -1.0, 0.2], [-0.2, 0.3, 1.0]] {
            for angle in [0.0, 0.4, 2.0, 3.0, 3.1, -3.0, -1.0] {
                let length = norm(&axis);
                let (s, c) = f64::sin_cos(angle / 2.0);
                let quat = [c, s * axis[0] / length, s * axis[1] / length, s * axis[2] / length];
                let m = quat_to_mat(quat);
                let column = |k: usize| [m[k], m[3 + k], m[6 + k]];
                let again = quat_to_mat(from_columns(column(0), column(1), column(2)));
                for (a, b) in again.iter().zip(m) {
                    assert!((a - b).abs() < 1e-12, "{angle} about {axis:?}: {again:?} for {m:?}");
                }
            }
        }
    }
}
