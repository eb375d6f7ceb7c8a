//! The inertia matrix of the joints, and its factors along the tree.
//!
//! A degree of freedom couples with those on its way to the root alone. So the matrix is kept as the rows of its lower
//! triangle, each with the columns of that way, root first and diagonal last. The columns of an ancestor are then the first
//! columns of a descendant, and factors `L' D L`, made from the last row on, fill in nothing.

use std::ops::Range;

use super::dense;
use super::spatial::{dot6, mul_inertia};
use crate::{Data, Model};

/// The inertia matrix by composite rigid bodies: MuJoCo's `mj_crb`.
#[inline(always)]
pub fn crb(m: &Model, d: &mut Data) {
    let (n, nv) = (m.nbody(), m.nv());
    let (crb, parents) = (&mut d.work.crb[..n], &m.body_parentid[..n]);
    crb.copy_from_slice(&d.cinert);
    for b in (1..n).rev() {
        let parent = parents[b];
        if parent > 0 {
            let child = crb[b];
            for (sum, part) in crb[parent].iter_mut().zip(child) {
                *sum += part;
            }
        }
    }
    let (plan, cdof) = (m.plan(), &d.cdof[..nv]);
    for i in 0..nv {
        let row = plan.m_row(i);
        let (columns, row) = (&plan.m_colind[row.clone()], &mut d.qm[row]);
        let last = row.len() - 1;
        if m.dof_simplenum[i] > 0 {
            row.fill(0.0);
            row[last] = m.dof_m0[i];
            continue;
        }
        let force = mul_inertia(&crb[m.dof_bodyid[i]], &cdof[i]);
        for (value, &j) in row.iter_mut().zip(columns) {
            *value = dot6(&cdof[j], &force);
        }
        row[last] += m.dof_armature[i];
    }
}

/// Factors the inertia matrix: MuJoCo's `mj_factorM`.
#[inline(always)]
pub fn factor_m(m: &Model, d: &mut Data) {
    d.qld.copy_from_slice(&d.qm);
    factor(m, &mut d.qld, &mut d.qld_diag_inv);
}

/// Replaces a matrix of the inertia matrix's structure by `L' D L`: MuJoCo's `mj_factorI`.
#[inline(always)]
pub(crate) fn factor(m: &Model, matrix: &mut [f64], diag_inv: &mut [f64]) {
    let plan = m.plan();
    for k in (0..m.nv()).rev() {
        let (start, end) = (plan.m_rowadr[k], plan.m_rowadr[k + 1]);
        let (above, row) = matrix[..end].split_at_mut(start);
        let last = row.len() - 1;
        let inv = 1.0 / row[last];
        diag_inv[k] = inv;
        // ancestors, the nearest first
        for c in (0..last).rev() {
            let i = plan.m_colind[start + c];
            let factor = row[c] * inv;
            let ancestor = plan.m_rowadr[i];
            for (a, b) in above[ancestor..=ancestor + c].iter_mut().zip(&row[..=c]) {
                *a -= factor * b;
            }
            row[c] = factor;
        }
    }
}

/// `x = M^-1 x`: MuJoCo's `mj_solveM`.
pub fn solve_m(m: &Model, d: &Data, x: &mut [f64]) {
    solve(m, &d.qld, &d.qld_diag_inv, x);
}

/// `x = (L' D L)^-1 x`.
#[inline(always)]
pub(crate) fn solve(m: &Model, factors: &[f64], diag_inv: &[f64], x: &mut [f64]) {
    for tree in &m.plan().trees {
        solve_tree(m, factors, diag_inv, tree, &mut x[tree.clone()]);
    }
}

/// The same for the degrees of freedom of one tree: MuJoCo's `mj_solveLD`.
#[inline(always)]
pub(crate) fn solve_tree(m: &Model, factors: &[f64], diag_inv: &[f64], tree: &Range<usize>, x: &mut [f64]) {
    let plan = m.plan();
    let diag_inv = &diag_inv[tree.clone()];
    let rows = &plan.m_rowadr[tree.start..=tree.end];
    for i in (1..x.len()).rev() {
        let xi = x[i];
        if xi != 0.0 {
            let row = rows[i]..rows[i + 1] - 1;
            for (&j, l) in plan.m_local[row.clone()].iter().zip(&factors[row]) {
                x[j] -= l * xi;
            }
        }
    }
    for (x, inv) in x.iter_mut().zip(diag_inv) {
        *x *= inv;
    }
    for i in 1..x.len() {
        let row = rows[i]..rows[i + 1] - 1;
        x[i] -= dense::dot_sparse(&factors[row.clone()], &plan.m_local[row], x);
    }
}

/// `y = M x`: MuJoCo's `mj_mulM`.
#[inline(always)]
pub fn mul_m(m: &Model, d: &Data, x: &[f64], y: &mut [f64]) {
    for tree in &m.plan().trees {
        mul_m_tree(m, &d.qm, tree, &x[tree.clone()], &mut y[tree.clone()]);
    }
}

/// The same for the degrees of freedom of one tree: MuJoCo's `mju_mulSymVecSparse`, ancestors from the nearest to the root.
#[inline(always)]
pub(crate) fn mul_m_tree(m: &Model, qm: &[f64], tree: &Range<usize>, x: &[f64], y: &mut [f64]) {
    let plan = m.plan();
    let rows = &plan.m_rowadr[tree.start..=tree.end];
    for (i, &xi) in x.iter().enumerate() {
        let diagonal = rows[i + 1] - 1;
        let row = rows[i]..diagonal;
        let mut sum = qm[diagonal] * xi;
        for (&j, value) in plan.m_local[row.clone()].iter().zip(&qm[row]).rev() {
            sum += value * x[j];
            y[j] += value * xi;
        }
        y[i] = sum;
    }
}

/// The whole inertia matrix, row by row (nv * nv numbers): MuJoCo's `mj_fullM`.
#[must_use]
pub fn full_m(m: &Model, d: &Data) -> Vec<f64> {
    let nv = m.nv();
    let mut full = vec![0.0; nv * nv];
    for i in 0..nv {
        for k in m.plan().m_row(i) {
            let j = m.plan().m_colind[k];
            (full[i * nv + j], full[j * nv + i]) = (d.qm[k], d.qm[k]);
        }
    }
    full
}
