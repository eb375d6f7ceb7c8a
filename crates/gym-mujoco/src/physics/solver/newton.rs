//! Newton's method on accelerations: the cost of constraints is quadratic between the places where rows start or cease to
//! push, so that few steps with exact line search reach the minimum.

use super::line_search::{Point, line_search};
use super::{cost_of_rows, gauss, residuals};
use crate::physics::constraint::{Block, Constraints, put_rows};
use crate::physics::inertia::{mul_m, mul_m_among, solve_among};
use crate::physics::spatial::MINVAL;
use crate::{Data, Model};

/// Buffers of the solver: vectors of the degrees of freedom, of rows, and a matrix.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    ma: Vec<f64>,
    grad: Vec<f64>,
    mgrad: Vec<f64>,
    search: Vec<f64>,
    mv: Vec<f64>,
    /// Lower triangle, row by row, then its factors.
    hessian: Vec<f64>,
    diag_inv: Vec<f64>,
    jar: Vec<f64>,
    jar_smooth: Vec<f64>,
    jv: Vec<f64>,
    row_work: Vec<RowWork>,
    /// Whether each row pushes.
    pushes: Vec<bool>,
}

/// What a line search needs to know about a row.
#[derive(Clone, Copy, Debug, Default)]
struct RowWork {
    jar: f64,
    jv: f64,
    quad: [f64; 3],
}

impl Buffers {
    /// Buffers that need not grow up to so many degrees of freedom and rows.
    pub(crate) fn new(nv: usize, nefc: usize) -> Self {
        let mut buffers = Self::default();
        buffers.fit(nv, nefc);
        buffers.row_work.reserve(nefc);
        buffers
    }

    /// Makes room for so many degrees of freedom and rows.
    fn fit(&mut self, nv: usize, nefc: usize) {
        for vector in [
            &mut self.ma,
            &mut self.grad,
            &mut self.mgrad,
            &mut self.search,
            &mut self.mv,
            &mut self.diag_inv,
        ] {
            vector.resize(nv, 0.0);
        }
        self.hessian.resize(nv * nv, 0.0);
        for vector in [&mut self.jar, &mut self.jar_smooth, &mut self.jv] {
            vector.resize(nefc, 0.0);
        }
        self.pushes.clear();
        self.pushes.resize(nefc, false);
    }
}

/// Solves all islands: MuJoCo's `mj_solNewton`.
pub(super) fn solve(m: &Model, d: &mut Data) {
    let mut b = std::mem::take(&mut d.work.newton);
    b.fit(m.nv(), d.efc.nefc());

    // start where the last step ended, unless that is worse than without constraints
    let all = std::mem::take(&mut d.work.all_dofs);
    residuals(d, &d.qacc_warmstart, &mut b.jar);
    residuals(d, &d.qacc_smooth, &mut b.jar_smooth);
    mul_m(m, d, &d.qacc_warmstart, &mut b.ma);
    let warm = cost_of_rows(&d.efc.d, &b.jar)
        + gauss(&b.ma, &d.qfrc_smooth, &d.qacc_warmstart, &d.qacc_smooth, &all);
    let smooth = cost_of_rows(&d.efc.d, &b.jar_smooth);
    d.qacc.copy_from_slice(&d.qacc_smooth);
    if warm > smooth {
        std::mem::swap(&mut b.jar, &mut b.jar_smooth);
        b.ma.copy_from_slice(&d.qfrc_smooth);
    } else {
        for &i in &d.work.island_dofs {
            d.qacc[i] = d.qacc_warmstart[i];
        }
    }
    d.work.all_dofs = all;

    let (dofs, blocks) = (std::mem::take(&mut d.work.island_dofs), std::mem::take(&mut d.work.island_blocks));
    for index in 0..d.work.islands.len() {
        let island = d.work.islands[index].clone();
        let iterations = solve_island(m, d, &mut b, &dofs[island.dofs], &blocks[island.blocks]);
        d.solver_niter.push(iterations);
    }
    (d.work.island_dofs, d.work.island_blocks) = (dofs, blocks);
    d.work.newton = b;
}

fn solve_island(m: &Model, d: &mut Data, b: &mut Buffers, dofs: &[usize], blocks: &[usize]) -> usize {
    let plan = m.plan();
    let scale = 1.0 / dofs.iter().map(|&i| d.qm[plan.m_rowadr[i + 1] - 1]).sum::<f64>();
    let tolerance = m.opt.tolerance;

    let (mut cost, _) = update(d, b, dofs, blocks);
    let mut gradient = scale * norm(&b.grad, dofs);
    if gradient < tolerance {
        b.mgrad.copy_from_slice(&b.grad);
        solve_among(m, &d.qld, &d.qld_diag_inv, dofs.iter().copied(), &mut b.mgrad);
        if 0.5 * scale * dot(&b.grad, &b.mgrad, dofs) < tolerance {
            return 0;
        }
    }
    hessian(m, d, b, dofs, blocks);
    let decrement = direction(b, dofs);
    if gradient < tolerance && 0.5 * scale * decrement < tolerance {
        return 0;
    }

    for iteration in 1..=m.opt.iterations {
        let alpha = search(m, d, b, dofs, blocks, scale);
        if alpha == 0.0 {
            return iteration - 1;
        }
        for &i in dofs {
            d.qacc[i] += alpha * b.search[i];
            b.ma[i] += alpha * b.mv[i];
        }
        for &index in blocks {
            let block = &d.efc.blocks[index];
            for row in block.row..block.row + block.rows() {
                b.jar[row] += alpha * b.jv[row];
            }
        }
        let before = cost;
        let changed;
        (cost, changed) = update(d, b, dofs, blocks);
        gradient = scale * norm(&b.grad, dofs);
        let improvement = scale * (before - cost);
        if (improvement > 0.0 && improvement < tolerance)
            || gradient < tolerance
            || iteration == m.opt.iterations
        {
            return iteration;
        }
        if changed {
            hessian(m, d, b, dofs, blocks);
        }
        if 0.5 * scale * direction(b, dofs) < tolerance {
            return iteration;
        }
    }
    0
}

/// Forces of the rows, `qfrc_constraint` and the gradient: MuJoCo's `PrimalUpdateConstraint` and `PrimalUpdateGradient`. Returns
/// the whole cost of the island, and whether other rows push than before.
fn update(d: &mut Data, b: &mut Buffers, dofs: &[usize], blocks: &[usize]) -> (f64, bool) {
    for &i in dofs {
        d.qfrc_constraint[i] = 0.0;
    }
    let mut cost = gauss(&b.ma, &d.qfrc_smooth, &d.qacc, &d.qacc_smooth, dofs);
    let efc = &mut d.efc;
    let mut changed = false;
    for &index in blocks {
        let block = &efc.blocks[index];
        for row in block.row..block.row + block.rows() {
            let (jar, stiffness) = (b.jar[row], efc.d[row]);
            changed |= b.pushes[row] != (jar < 0.0);
            b.pushes[row] = jar < 0.0;
            if jar < 0.0 {
                efc.force[row] = -stiffness * jar;
                cost += 0.5 * stiffness * jar * jar;
            } else {
                efc.force[row] = 0.0;
            }
        }
        efc.add_jac_t(&efc.blocks[index], &efc.force, &mut d.qfrc_constraint);
    }
    for &i in dofs {
        b.grad[i] = b.ma[i] - d.qfrc_smooth[i] - d.qfrc_constraint[i];
    }
    (cost, changed)
}

/// Makes and factors the Hessian of the cost, `M + J' D J` over the rows that push.
fn hessian(m: &Model, d: &Data, b: &mut Buffers, dofs: &[usize], blocks: &[usize]) {
    let (plan, nv) = (m.plan(), m.nv());
    let h = &mut b.hessian;
    for &i in dofs {
        let (row, known) = (&mut h[i * nv..=i * nv + i], plan.m_row(i));
        row.fill(0.0);
        for (&j, value) in plan.m_colind[known.clone()].iter().zip(&d.qm[known]) {
            row[j] = *value;
        }
    }
    for &index in blocks {
        add_block(&d.efc, &d.efc.blocks[index], &b.jar, h, nv);
    }
    factor(h, &mut b.diag_inv, dofs, nv);
}

/// Adds `J' D J` of a block's pushing rows to the lower triangle.
fn add_block(efc: &Constraints, block: &Block, jar: &[f64], h: &mut [f64], nv: usize) {
    let (columns, jac) = efc.jacobian(block);
    let row = block.row;
    if block.dim == 1 {
        if jar[row] < 0.0 {
            for (p, &i) in columns.iter().enumerate() {
                let (s, h) = (efc.d[row] * jac[p], &mut h[i * nv..=i * nv + i]);
                for (&j, jac) in columns[..=p].iter().zip(jac) {
                    h[j] += s * jac;
                }
            }
        }
        return;
    }
    // the four rows in terms of normal and tangents
    let weight = |k: usize| if jar[row + k] < 0.0 { efc.d[row + k] } else { 0.0 };
    let w = [0, 1, 2, 3].map(weight);
    let nn = (w[0] + w[1]) + (w[2] + w[3]);
    if nn == 0.0 {
        return;
    }
    let mu = block.mu;
    let (n1, n2) = ((w[0] - w[1]) * mu, (w[2] - w[3]) * mu);
    let (t1, t2) = ((w[0] + w[1]) * mu * mu, (w[2] + w[3]) * mu * mu);
    let (jn, rest) = jac.split_at(block.width);
    let (j1, j2) = rest.split_at(block.width);
    for (p, &i) in columns.iter().enumerate() {
        let (a, b, c) =
            (nn * jn[p] + n1 * j1[p] + n2 * j2[p], n1 * jn[p] + t1 * j1[p], n2 * jn[p] + t2 * j2[p]);
        let h = &mut h[i * nv..=i * nv + i];
        for (((&j, n), t1), t2) in columns[..=p].iter().zip(jn).zip(j1).zip(j2) {
            h[j] += a * n + b * t1 + c * t2;
        }
    }
}

/// Replaces the lower triangle of a positive definite matrix by factors `L' D L`, from the last row on: along a tree this fills
/// in nothing, and what is zero costs nothing.
fn factor(h: &mut [f64], diag_inv: &mut [f64], dofs: &[usize], nv: usize) {
    let first = dofs[0];
    for &k in dofs.iter().rev() {
        let (above, row) = h.split_at_mut(k * nv);
        let row = &mut row[..=k];
        let inv = 1.0 / row[k];
        diag_inv[k] = inv;
        for j in (first..k).rev() {
            if row[j] != 0.0 {
                let factor = row[j] * inv;
                for (a, b) in above[j * nv + first..=j * nv + j].iter_mut().zip(&row[first..=j]) {
                    *a -= factor * b;
                }
                row[j] = factor;
            }
        }
    }
}

/// The search direction, `-H^-1 grad`, and `grad' H^-1 grad`.
fn direction(b: &mut Buffers, dofs: &[usize]) -> f64 {
    let (nv, first) = (b.grad.len(), dofs[0]);
    let x = &mut b.search;
    for &i in dofs {
        x[i] = -b.grad[i];
    }
    for &i in dofs.iter().rev() {
        let (below, rest) = x.split_at_mut(i);
        for (x, l) in below[first..].iter_mut().zip(&b.hessian[i * nv + first..i * nv + i]) {
            *x -= l * rest[0];
        }
    }
    for &i in dofs {
        let mut sum = x[i] * b.diag_inv[i];
        for (x, l) in x[first..i].iter().zip(&b.hessian[i * nv + first..i * nv + i]) {
            sum -= l * x;
        }
        x[i] = sum;
    }
    -dot(&b.grad, x, dofs)
}

/// The length of the step along the search direction; leaves `M search` and `J search` behind.
fn search(m: &Model, d: &Data, b: &mut Buffers, dofs: &[usize], blocks: &[usize], scale: f64) -> f64 {
    let length = norm(&b.search, dofs);
    if length < MINVAL {
        return 0.0;
    }
    mul_m_among(m, d, dofs.iter().copied(), &b.search, &mut b.mv);
    let efc = &d.efc;
    b.row_work.clear();
    for &index in blocks {
        let block = &efc.blocks[index];
        put_rows(block, efc.along(block, &b.search), &mut b.jv);
        for row in block.row..block.row + block.rows() {
            let (jar, jv, stiffness) = (b.jar[row], b.jv[row], efc.d[row]);
            let quad = [0.5 * stiffness * jar * jar, stiffness * jv * jar, 0.5 * stiffness * jv * jv];
            b.row_work.push(RowWork { jar, jv, quad });
        }
    }
    let (mut linear, mut quadratic) = (0.0, 0.0);
    for &i in dofs {
        linear += b.search[i] * (b.ma[i] - d.qfrc_smooth[i]);
        quadratic += 0.5 * b.search[i] * b.mv[i];
    }
    let flat = m.opt.tolerance * m.opt.ls_tolerance * length / scale;
    let evaluate = |alpha: f64| {
        let mut quad = [0.0, linear, quadratic];
        for row in &b.row_work {
            let pushed = if row.jar < 0.0 { row.quad[0] } else { 0.0 };
            if row.jar + alpha * row.jv < 0.0 {
                quad[0] += row.quad[0] - pushed;
                quad[1] += row.quad[1];
                quad[2] += row.quad[2];
            } else {
                quad[0] -= pushed;
            }
        }
        Point {
            alpha,
            cost: alpha * alpha * quad[2] + alpha * quad[1] + quad[0],
            slope: 2.0 * alpha * quad[2] + quad[1],
            curvature: if quad[2] > 0.0 { 2.0 * quad[2] } else { MINVAL },
        }
    };
    line_search(evaluate, flat, m.opt.ls_iterations)
}

fn dot(a: &[f64], b: &[f64], dofs: &[usize]) -> f64 {
    dofs.iter().map(|&i| a[i] * b[i]).sum()
}

fn norm(a: &[f64], dofs: &[usize]) -> f64 {
    dot(a, a, dofs).sqrt()
}
