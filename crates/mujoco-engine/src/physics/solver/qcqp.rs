//! The friction of an elliptic cone for a given normal force. It minimises a quadratic form within
//! an ellipsoid.

use crate::Revision;
use crate::math::dense::dot_slices;
use crate::math::spatial::MINVAL;

/// Numbers below this count as zero.
const LEAST: f64 = 1e-10;

/// The largest number of Newton steps.
const STEPS: usize = 20;

/// Sets the friction `force[1..]` for the normal force `force[0]`. The matrix `a` and the vector
/// `b` define the quadratic form: MuJoCo's `solveQCQP`.
pub(super) fn friction(force: &mut [f64], a: &[f64], b: &[f64], mu: &[f64; 5], revision: Revision) {
    let (normal, n) = (force[0], b.len());
    let (v, active) = match n {
        2 => two(a, b, mu, normal),
        3 => three(a, b, mu, normal),
        _ => many(a, b, mu, normal, revision),
    };
    force[1..].copy_from_slice(&v[..n]);
    if active {
        scale(&mut force[1..], normal, mu);
    }
}

/// Scales `friction` onto the ellipsoid of the normal force `normal`, if `friction` is outside:
/// MuJoCo's `projectEllipsoid`.
pub(super) fn limit(friction: &mut [f64], normal: f64, mu: &[f64; 5]) {
    if square(friction, mu) > normal * normal {
        scale(friction, normal, mu);
    }
}

/// Scales `friction` onto the ellipsoid.
fn scale(friction: &mut [f64], normal: f64, mu: &[f64; 5]) {
    let factor = (normal * normal / f64::max(MINVAL, square(friction, mu))).sqrt();
    friction.iter_mut().for_each(|x| *x *= factor);
}

fn square(friction: &[f64], mu: &[f64; 5]) -> f64 {
    let terms = friction.iter().zip(mu).map(|(x, mu)| x * x / (mu * mu));
    terms.fold(0.0, |sum, term| sum + term)
}

/// Runs Newton's method on the Lagrange multiplier of the ellipsoid. For a multiplier, `solve`
/// returns the scaled minimum, the minimum's excess over the ellipsoid, and the derivative of the
/// excess; `None` if the matrix is not definite.
fn search<const N: usize>(
    d: &[f64; 5],
    mut solve: impl FnMut(f64) -> Option<([f64; N], f64, f64)>,
) -> ([f64; 5], bool) {
    let (mut multiplier, mut all) = (0.0, [0.0; 5]);
    for _ in 0..STEPS {
        let Some((v, outside, slope)) = solve(multiplier) else {
            return ([0.0; 5], false);
        };
        all = std::array::from_fn(|k| v.get(k).map_or(0.0, |v| v * d[k]));
        if outside < LEAST {
            break;
        }
        let step = -outside / slope;
        if step < LEAST {
            break;
        }
        multiplier += step;
    }
    (all, multiplier != 0.0)
}

/// MuJoCo's `mju_QCQP2`.
fn two(a: &[f64], b: &[f64], d: &[f64; 5], r: f64) -> ([f64; 5], bool) {
    let (b1, b2) = (b[0] * d[0], b[1] * d[1]);
    let a11 = a[0] * d[0] * d[0];
    let a22 = a[3] * d[1] * d[1];
    let a12 = a[1] * d[0] * d[1];
    search(d, |la| {
        let det = (a11 + la) * (a22 + la) - a12 * a12;
        if det < LEAST {
            return None;
        }
        let inverse = 1.0 / det;
        let (p11, p22, p12) = ((a22 + la) * inverse, (a11 + la) * inverse, -a12 * inverse);
        let [x, y] = [-p11 * b1 - p12 * b2, -p12 * b1 - p22 * b2];
        let outside = x * x + y * y - r * r;
        let slope = -2.0 * (p11 * x * x + 2.0 * p12 * x * y + p22 * y * y);
        Some(([x, y], outside, slope))
    })
}

/// MuJoCo's `mju_QCQP3`.
fn three(a: &[f64], b: &[f64], d: &[f64; 5], r: f64) -> ([f64; 5], bool) {
    let [b1, b2, b3] = [0, 1, 2].map(|k| b[k] * d[k]);
    let a11 = a[0] * d[0] * d[0];
    let a22 = a[4] * d[1] * d[1];
    let a33 = a[8] * d[2] * d[2];
    let a12 = a[1] * d[0] * d[1];
    let a13 = a[2] * d[0] * d[2];
    let a23 = a[5] * d[1] * d[2];
    search(d, |la| {
        let p11 = (a22 + la) * (a33 + la) - a23 * a23;
        let p22 = (a11 + la) * (a33 + la) - a13 * a13;
        let p33 = (a11 + la) * (a22 + la) - a12 * a12;
        let p12 = a13 * a23 - a12 * (a33 + la);
        let p13 = a12 * a23 - a13 * (a22 + la);
        let p23 = a12 * a13 - a23 * (a11 + la);
        let det = (a11 + la) * p11 + a12 * p12 + a13 * p13;
        if det < LEAST {
            return None;
        }
        let inverse = 1.0 / det;
        let [p11, p22, p33, p12, p13, p23] = [p11, p22, p33, p12, p13, p23].map(|p| p * inverse);
        let x = -p11 * b1 - p12 * b2 - p13 * b3;
        let y = -p12 * b1 - p22 * b2 - p23 * b3;
        let z = -p13 * b1 - p23 * b2 - p33 * b3;
        let outside = x * x + y * y + z * z - r * r;
        let slope = -2.0 * (p11 * x * x + p22 * y * y + p33 * z * z)
            - 4.0 * (p12 * x * y + p13 * x * z + p23 * y * z);
        Some(([x, y, z], outside, slope))
    })
}

/// MuJoCo's `mju_QCQP`.
fn many(a: &[f64], b: &[f64], d: &[f64; 5], r: f64, revision: Revision) -> ([f64; 5], bool) {
    const N: usize = 5;
    let scaled: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| a[j + i * N] * d[i] * d[j]));
    let b: [f64; N] = std::array::from_fn(|i| b[i] * d[i]);
    search(d, |la| {
        let mut l = scaled;
        for (i, row) in l.iter_mut().enumerate() {
            row[i] += la;
        }
        for j in 0..N {
            let pivot = l[j][j] - dot_slices(&l[j][..j], &l[j][..j]);
            if pivot < LEAST {
                return None;
            }
            l[j][j] = pivot.sqrt();
            let inverse = 1.0 / l[j][j];
            for i in j + 1..N {
                l[i][j] = (l[i][j] - dot_slices(&l[i][..j], &l[j][..j])) * inverse;
            }
        }
        let x = solve(&l, b, revision).map(|x| -x);
        let outside = dot_slices(&x, &x) - r * r;
        let slope = -2.0 * dot_slices(&x, &solve(&l, x, revision));
        Some((x, outside, slope))
    })
}

/// Solves `L L' x = x`: MuJoCo's `mju_cholSolve`, which from 4.0 on substitutes back by columns.
fn solve<const N: usize>(l: &[[f64; N]; N], mut x: [f64; N], revision: Revision) -> [f64; N] {
    for (i, row) in l.iter().enumerate() {
        x[i] = (x[i] - dot_slices(&row[..i], &x[..i])) / row[i];
    }
    for i in (0..N).rev() {
        let subtract = |sum: f64, j: usize| sum - l[j][i] * x[j];
        let sum = if revision.substitutes_by_columns() {
            (i + 1..N).rev().fold(x[i], subtract)
        } else {
            (i + 1..N).fold(x[i], subtract)
        };
        x[i] = sum / l[i][i];
    }
    x
}
