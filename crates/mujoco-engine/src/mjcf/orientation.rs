//! Orientations: the forms in which MJCF gives them, as quaternions `w, x, y, z`.

use super::spec::{Compiler, Frame};
use super::xml::Element;
use crate::Result;
use crate::math::libm;
use crate::math::spatial::{EPS, InTurn, Order, Quat, add, axis_angle, cross, rotate, rotate_quat};

/// The orientation of a frame that is not turned.
pub(crate) const IDENTITY: Quat = [1.0, 0.0, 0.0, 0.0];

/// An orientation as the text gives it. Other forms take precedence over `quat`, even if a default
/// class gives them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Orientation {
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
        Self {
            quat: IDENTITY,
            other: None,
        }
    }
}

impl Orientation {
    /// The orientation given by Euler angles.
    pub(crate) fn of_euler(angles: [f64; 3]) -> Self {
        Self {
            other: Some(Form::Euler(angles)),
            ..Self::default()
        }
    }

    /// Reads the forms of an orientation. An element may have at most one.
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        let (place, mut given) = (element.place(), Vec::new());
        let zero = |v: &[f64]| norm(v) < EPS;
        if let Some(quat) = element.numbers("quat")? {
            if zero(&quat) {
                return Err(place.attribute("quat", "the quaternion is zero"));
            }
            self.quat = quat;
            given.push("quat");
        }
        if let Some(axis_angle) = element.numbers::<4>("axisangle")? {
            if zero(&axis_angle[..3]) {
                return Err(place.attribute("axisangle", "the axis is zero"));
            }
            self.other = Some(Form::AxisAngle(axis_angle));
            given.push("axisangle");
        }
        if let Some(euler) = element.numbers("euler")? {
            self.other = Some(Form::Euler(euler));
            given.push("euler");
        }
        if let Some(xyaxes) = element.numbers("xyaxes")? {
            if plane_of(&xyaxes).is_none() {
                return Err(place.attribute("xyaxes", "the axes are zero or parallel"));
            }
            self.other = Some(Form::XyAxes(xyaxes));
            given.push("xyaxes");
        }
        if let Some(zaxis) = element.numbers("zaxis")? {
            if zero(&zaxis) {
                return Err(place.attribute("zaxis", "the axis is zero"));
            }
            self.other = Some(Form::ZAxis(zaxis));
            given.push("zaxis");
        }
        match given[..] {
            [_, second, ..] => {
                Err(place.attribute(second, format!("only one of {}", given.join(", "))))
            }
            _ => Ok(()),
        }
    }

    /// The quaternion, with the unit and the order of angles of `compiler`.
    pub(crate) fn resolve(&self, compiler: &Compiler) -> Quat {
        let degree = compiler.degree;
        let radians = |angle: f64| {
            if degree {
                angle / 180.0 * std::f64::consts::PI
            } else {
                angle
            }
        };
        match &self.other {
            None => unit(self.quat).0,
            Some(Form::AxisAngle([x, y, z, angle])) => {
                axis_angle((), unit([*x, *y, *z]).0, radians(*angle))
            }
            Some(Form::Euler(angles)) => {
                let mut quat = IDENTITY;
                for ((axis, fixed), angle) in compiler.euler.into_iter().zip(angles) {
                    let mut direction = [0.0; 3];
                    direction[axis] = 1.0;
                    let turn = axis_angle((), direction, radians(*angle));
                    quat = if fixed {
                        compose(turn, quat)
                    } else {
                        compose(quat, turn)
                    };
                }
                unit(quat).0
            }
            Some(Form::XyAxes(axes)) => {
                plane_of(axes).map_or(IDENTITY, |[x, y, z]| from_columns(x, y, z))
            }
            Some(Form::ZAxis(axis)) => from_z(unit(*axis).0),
        }
    }
}

/// Normalises a vector; returns it with its length: MuJoCo's `mjuu_normvec`, which returns a vector
/// of length 0 or nearly 1 unchanged.
pub(crate) fn unit<const N: usize>(v: [f64; N]) -> ([f64; N], f64) {
    let square: f64 = v.iter().map(|x| x * x).sum();
    if square < EPS {
        return (v, 0.0);
    }
    let length = square.sqrt();
    (
        if (length - 1.0).abs() > EPS {
            v.map(|x| x / length)
        } else {
            v
        },
        length,
    )
}

/// Converts a frame within `frame` to the outer frame: MuJoCo's `mjuu_frameaccumChild`.
pub(crate) fn within(frame: Option<Frame>, (pos, quat): Frame) -> Frame {
    let Some((origin, turn)) = frame else {
        return (pos, quat);
    };
    let moved = add(origin, rotate(&InTurn::quat_to_mat(turn), pos));
    (moved, compose(turn, quat))
}

/// Turns a direction from `frame` to its body's frame.
pub(crate) fn turned(frame: Option<Frame>, direction: [f64; 3]) -> [f64; 3] {
    match frame {
        Some((_, quat)) if quat != IDENTITY => rotate_quat(direction, quat),
        _ => direction,
    }
}

/// The rotation `b` followed by `a`, where `b` is given in the frame of `a`: MuJoCo's
/// `mjuu_mulquat`.
pub(crate) fn compose(a: Quat, b: Quat) -> Quat {
    unit(InTurn::mul_quat(a, b)).0
}

/// The shortest rotation from the z axis to a unit vector; for -z, half a turn about x.
pub(crate) fn from_z(direction: [f64; 3]) -> Quat {
    let (axis, sin) = unit(cross([0.0, 0.0, 1.0], direction));
    let axis = if sin < 1e-10 { [1.0, 0.0, 0.0] } else { axis };
    let (s, c) = libm::sin_cos(libm::atan2(sin, direction[2]) / 2.0);
    [c, axis[0] * s, axis[1] * s, axis[2] * s]
}

/// Right-handed unit axes from an x axis and a vector in the xy plane; `None` if the two are
/// parallel or zero.
fn plane_of(axes: &[f64; 6]) -> Option<[[f64; 3]; 3]> {
    let long = |(v, length): ([f64; 3], f64)| (length >= EPS).then_some(v);
    let x = long(unit([axes[0], axes[1], axes[2]]))?;
    let along = x[0] * axes[3] + x[1] * axes[4] + x[2] * axes[5];
    let y = long(unit([
        axes[3] - x[0] * along,
        axes[4] - x[1] * along,
        axes[5] - x[2] * along,
    ]))?;
    Some([x, y, long(unit(cross(x, y)))?])
}

/// The quaternion of a rotation matrix with these columns: MuJoCo's `mjuu_frame2quat`.
fn from_columns(x: [f64; 3], y: [f64; 3], z: [f64; 3]) -> Quat {
    let half = |square: f64| 0.5 * square.sqrt();
    let quarter = |difference: f64| 0.25 * difference;
    let [a, b, c] = [y[2] - z[1], z[0] - x[2], x[1] - y[0]].map(quarter);
    let [xy, xz, yz] = [y[0] + x[1], z[0] + x[2], z[1] + y[2]].map(quarter);
    let quat = if x[0] + y[1] + z[2] > 0.0 {
        let w = half(1.0 + x[0] + y[1] + z[2]);
        [w, a / w, b / w, c / w]
    } else if x[0] > y[1] && x[0] > z[2] {
        let i = half(1.0 + x[0] - y[1] - z[2]);
        [a / i, i, xy / i, xz / i]
    } else if y[1] > z[2] {
        let j = half(1.0 - x[0] + y[1] - z[2]);
        [b / j, xy / j, j, yz / j]
    } else {
        let k = half(1.0 - x[0] - y[1] + z[2]);
        [c / k, xz / k, yz / k, k]
    };
    unit(quat).0
}

pub(crate) fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rotations by about half a turn have a negative trace; then the quaternion is computed from
    /// its largest component.
    #[test]
    fn axes_of_every_turn_have_their_quaternion() {
        for axis in [[1.0, 0.2, -0.3], [0.1, -1.0, 0.2], [-0.2, 0.3, 1.0]] {
            for angle in [0.0, 0.4, 2.0, 3.0, 3.1, -3.0, -1.0] {
                let length = norm(&axis);
                let (s, c) = libm::sin_cos(angle / 2.0);
                let quat = [
                    c,
                    s * axis[0] / length,
                    s * axis[1] / length,
                    s * axis[2] / length,
                ];
                let m = InTurn::quat_to_mat(quat);
                let column = |k: usize| [m[k], m[3 + k], m[6 + k]];
                let again = InTurn::quat_to_mat(from_columns(column(0), column(1), column(2)));
                for (a, b) in again.iter().zip(m) {
                    assert!(
                        (a - b).abs() < 1e-12,
                        "{angle} about {axis:?}: {again:?} for {m:?}"
                    );
                }
            }
        }
    }
}
