//! The principal axes of a symmetric matrix: Jacobi's method on a quaternion, in the order of
//! `mju_eig3`, because axes are only determined up to the choices made on the way.

use super::spatial::{InTurn, Mat3, Order, Quat};

/// The method. MuJoCo's compiler and its engine round quaternions differently.
pub(crate) struct Axes<U, P> {
    /// From MuJoCo 3.14 on, the iteration stops when the largest off-diagonal element is small
    /// relative to the largest element of the matrix, no longer by absolute limits, and computes
    /// half the turn from its tangent.
    pub(crate) half_tangents: bool,
    /// That relative limit.
    pub(crate) rest: f64,
    /// A quaternion scaled to length 1.
    pub(crate) unit: U,
    /// The product of two quaternions, scaled to length 1.
    pub(crate) product: P,
}

impl<U: Fn(Quat) -> Quat, P: Fn(Quat, Quat) -> Quat> Axes<U, P> {
    /// The principal values, falling, and the orientation of their axes.
    pub(crate) fn of(&self, full: &Mat3) -> ([f64; 3], Quat) {
        const EIG_EPS: f64 = 1e-12;
        const MAX_ITERATIONS: usize = 500;
        // the square root of one half, with the digits of libmujoco
        #[expect(
            clippy::approx_constant,
            reason = "the last digits of the moments' axes depend on it"
        )]
        const QUARTER_TURN: f64 = 0.707106781186548;
        let largest = full.iter().fold(0.0, |most, x| f64::max(most, x.abs()));
        let (least, rising) = if self.half_tangents {
            // a number equal to the limit counts as small
            (
                (self.rest * largest).next_up(),
                f64::max(self.rest, EIG_EPS) * largest,
            )
        } else {
            (EIG_EPS, EIG_EPS)
        };
        let mut quat = [1.0, 0.0, 0.0, 0.0];
        let mut moments = [0.0; 3];
        for _ in 0..MAX_ITERATIONS {
            let d = in_axes(full, &InTurn::quat_to_mat(quat));
            moments = [d[0][0], d[1][1], d[2][2]];
            // the largest entry off the diagonal, and the axis of the rotation that removes it
            let (row, column, axis) =
                if d[0][1].abs() > d[0][2].abs() && d[0][1].abs() > d[1][2].abs() {
                    (0, 1, 2)
                } else if d[0][2].abs() > d[1][2].abs() {
                    (0, 2, 1)
                } else {
                    (1, 2, 0)
                };
            let off = d[row][column];
            if off.abs() < least {
                break;
            }
            let tau = (d[column][column] - d[row][row]) / (2.0 * off);
            let root = (1.0 + tau * tau).sqrt();
            let tan = if tau >= 0.0 {
                1.0 / (tau + root)
            } else {
                -1.0 / (root - tau)
            };
            let (cos, sin) = if self.half_tangents {
                let tan = tan / (1.0 + (1.0 + tan * tan).sqrt());
                let cos = 1.0 / (1.0 + tan * tan).sqrt();
                (cos, tan * cos)
            } else {
                let cos = 1.0 / (1.0 + tan * tan).sqrt();
                if cos > 1.0 - EIG_EPS {
                    break;
                }
                let sin = (0.5 - 0.5 * cos).sqrt();
                ((1.0 - sin * sin).sqrt(), sin.copysign(tan))
            };
            let mut turn = [cos, 0.0, 0.0, 0.0];
            turn[axis + 1] = if axis == 1 { sin } else { -sin };
            if !self.half_tangents {
                turn = (self.unit)(turn);
            }
            quat = (self.product)(quat, turn);
        }
        for pair in [0, 1, 0] {
            if moments[pair] + rising < moments[pair + 1] {
                moments.swap(pair, pair + 1);
                let mut quarter = [QUARTER_TURN, 0.0, 0.0, 0.0];
                quarter[(pair + 2) % 3 + 1] = quarter[0];
                quat = (self.product)(quat, quarter);
            }
        }
        (moments, quat)
    }
}

/// `axes' full axes`.
fn in_axes(full: &Mat3, axes: &Mat3) -> [[f64; 3]; 3] {
    let half = |i: usize, j: usize| {
        (0..3)
            .map(|k| axes[3 * k + i] * full[3 * k + j])
            .sum::<f64>()
    };
    std::array::from_fn(|i| {
        std::array::from_fn(|j| (0..3).map(|k| half(i, k) * axes[3 * k + j]).sum())
    })
}
