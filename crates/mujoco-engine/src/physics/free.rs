//! Bodies with a free joint and no child joints, with the integrator `implicitfast`. The
//! derivatives of their gyroscopic forces are not symmetric, so each body's six equations are
//! solved separately.

use std::ops::Range;

use super::implicit::Mat6;
use crate::math::dense::dot_slices;
use crate::math::spatial::{
    MINVAL, Mat3, Vec3, Vec6, column, cross, dot, rotate, rotate_back, sub,
};
use crate::{Data, Model};

/// The equations of a free body.
#[derive(Clone, Debug)]
pub(super) struct Free {
    body: usize,
    dofs: Range<usize>,
    /// The derivatives of the forces of actuators and of passive forces.
    slopes: Mat6,
    /// The accelerations; `None` if the equations are singular.
    solution: Option<Vec6>,
}

impl Free {
    /// The free bodies of a model.
    pub(super) fn all(m: &Model) -> impl Iterator<Item = Self> + '_ {
        m.plan().free_bodies.iter().map(|&body| {
            let first = m.body_dofadr[body] as usize;
            Self {
                body,
                dofs: first..first + 6,
                slopes: [[0.0; 6]; 6],
                solution: None,
            }
        })
    }

    pub(super) fn clear(&mut self) {
        self.slopes = [[0.0; 6]; 6];
    }

    pub(super) fn has(&self, dof: usize) -> bool {
        self.dofs.contains(&dof)
    }

    /// Adds `value` to a derivative if the degree of freedom `column` belongs to the same body.
    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        if self.has(column) {
            self.slopes[row - self.dofs.start][column - self.dofs.start] += value;
        }
    }

    /// Solves the equations for the forces `acc_sum`.
    pub(super) fn solve(&mut self, m: &Model, d: &Data) {
        let mut x = [0.0; 6];
        x.copy_from_slice(&d.work.acc_sum[self.dofs.clone()]);
        self.solution = eliminate(self.matrix(m, d), x);
    }

    /// Writes the forces of the accelerations `x`.
    pub(super) fn multiply(&self, m: &Model, d: &Data, x: &[f64], forces: &mut [f64]) {
        let own = &x[self.dofs.clone()];
        let rows = self.matrix(m, d);
        for (force, row) in forces[self.dofs.clone()].iter_mut().zip(&rows) {
            *force = dot_slices(row, own);
        }
    }

    /// The matrix of the equations: MuJoCo's `mjd_freeMhat`.
    fn matrix(&self, m: &Model, d: &Data) -> Mat6 {
        let (plan, h, first) = (m.plan(), m.opt.timestep, self.dofs.start);
        let mut a: Mat6 = [[0.0; 6]; 6];
        let rows = self.dofs.clone().map(|dof| plan.m_row(dof));
        for (r, row) in rows.enumerate() {
            for (&c, value) in plan.m_colind[row.clone()].iter().zip(&d.qm[row]) {
                (a[r][c - first], a[c - first][r]) = (*value, *value);
            }
        }
        for (row, slopes) in a.iter_mut().zip(&self.slopes) {
            for (x, slope) in row.iter_mut().zip(slopes) {
                *x -= h * slope;
            }
        }
        let mass = m.body_mass[self.body];
        let (linear, turning) = gyroscopic(m, d, self.body, first);
        for (r, (linear, turning)) in linear.iter().zip(&turning).enumerate() {
            for (c, (linear, turning)) in linear.iter().zip(turning).enumerate() {
                a[r][3 + c] += -h * mass * linear;
                a[3 + r][3 + c] += h * turning;
            }
        }
        a
    }

    /// Writes the accelerations.
    pub(super) fn put(&self, accelerations: &mut [f64]) {
        if let Some(x) = &self.solution {
            accelerations[self.dofs.clone()].copy_from_slice(x);
        }
    }
}

/// The derivatives of the gyroscopic force and torque by the angular velocity: MuJoCo's
/// `freeBias_vel_blocks`. The mass is left out of the force.
fn gyroscopic(m: &Model, d: &Data, body: usize, first: usize) -> ([Vec3; 3], [Vec3; 3]) {
    let (mat, frame) = (&d.xmat[body], &d.ximat[body]);
    let com = if m.revision.takes_centre_of_tree() {
        d.subtree_com[body]
    } else {
        d.xipos[body]
    };
    let s = sub(com, d.xpos[body]);
    let w = rotate(mat, [3, 4, 5].map(|k| d.qvel[first + k]));
    let row = |mat: &Mat3, i: usize| [mat[3 * i], mat[3 * i + 1], mat[3 * i + 2]];
    let scaled = [0, 1, 2].map(|i| {
        let (row, inertia) = (row(frame, i), m.body_inertia[body]);
        [0, 1, 2].map(|k| row[k] * inertia[k])
    });
    let [xx, yy, zz, xy, xz, yz, ..] = d.cinert[body];
    let inertia: Mat3 = if m.revision.takes_centre_of_tree() {
        [xx, xy, xz, xy, yy, yz, xz, yz, zz]
    } else {
        std::array::from_fn(|n| {
            let (i, j) = (n / 3, n % 3);
            dot(scaled[i.min(j)], row(frame, i.max(j)))
        })
    };
    let (moves, momentum) = (cross(w, s), rotate(&inertia, w));
    let along = w[0] * s[0] + w[1] * s[1] + w[2] * s[2];
    let mut k: Mat3 = std::array::from_fn(|n| s[n / 3] * w[n % 3]);
    for (n, moved) in moves.into_iter().enumerate() {
        k[4 * n] -= along;
        let [i, j] = [(n + 1) % 3, (n + 2) % 3];
        k[3 * j + i] += moved;
        k[3 * i + j] -= moved;
    }
    let mass = m.body_mass[body];
    // the columns of the torque's derivative in the world
    let torques = [0, 1, 2].map(|c| {
        let arm = cross(s, column(&k, c));
        let turned = cross(w, column(&inertia, c));
        let mut unit = [0.0; 3];
        unit[c] = 1.0;
        let own = cross(unit, momentum);
        [0, 1, 2].map(|r| -mass * arm[r] + turned[r] + own[r])
    });
    let torque: Mat3 = std::array::from_fn(|n| torques[n % 3][n / 3]);
    let columns = [0, 1, 2].map(|c| column(mat, c));
    let linear = columns.map(|axis| rotate(&k, axis));
    // `R' C` first, then `R`
    let back = [0, 1, 2].map(|c| rotate_back(mat, column(&torque, c)));
    let back: Mat3 = std::array::from_fn(|n| back[n % 3][n / 3]);
    let turning = columns.map(|axis| rotate(&back, axis));
    let rows = |of: [Vec3; 3]| [0, 1, 2].map(|r| [of[0][r], of[1][r], of[2][r]]);
    (rows(linear), rows(turning))
}

/// Solves six equations by elimination with pivots: MuJoCo's `mju_factorLU6` and `mju_solveLU6`.
fn eliminate(mut a: Mat6, mut x: Vec6) -> Option<Vec6> {
    let mut pivots = [0; 6];
    for (k, place) in pivots.iter_mut().enumerate() {
        let better = |best: usize, i: usize| {
            if a[i][k].abs() > a[best][k].abs() {
                i
            } else {
                best
            }
        };
        let pivot = (k + 1..6).fold(k, better);
        if a[pivot][k].abs() < MINVAL {
            return None;
        }
        *place = pivot;
        a.swap(k, pivot);
        let inverse = 1.0 / a[k][k];
        let (above, below) = a.split_at_mut(k + 1);
        for row in below {
            row[k] *= inverse;
            let share = row[k];
            for (x, y) in row[k + 1..].iter_mut().zip(&above[k][k + 1..]) {
                *x -= share * y;
            }
        }
    }
    for (i, (row, pivot)) in a.iter().zip(pivots).enumerate() {
        x.swap(i, pivot);
        for (j, share) in row[..i].iter().enumerate() {
            x[i] -= share * x[j];
        }
    }
    for i in (0..6).rev() {
        for j in i + 1..6 {
            x[i] -= a[i][j] * x[j];
        }
        x[i] /= a[i][i];
    }
    Some(x)
}
