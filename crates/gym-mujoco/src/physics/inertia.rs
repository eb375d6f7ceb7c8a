//! The inertia matrix of the joints, and its factors along the tree.
//!
//! A degree of freedom couples only with its ancestors and descendants. So each row of the lower
//! triangle stores only the columns of its ancestors, root first, and the diagonal last. The
//! columns of an ancestor are then the first columns of a descendant, and factors `L' D L`, made
//! from the last row on, fill in nothing.

use std::ops::Range;

use super::dense::{self, Lanes, minus, plus, times};
use super::number::{Number, get, put};
use super::spatial::{Vec6, dot6, mul_inertia};
use crate::model::Plan;
use crate::{Data, Model};

/// The arrays of the inertia matrix, of one world or of several.
pub(crate) struct Composite<'a, C> {
    pub(crate) cinert: &'a [[C; 10]],
    pub(crate) cdof: &'a [[C; 6]],
    /// A buffer: composite inertias.
    pub(crate) crb: &'a mut [[C; 10]],
    pub(crate) qm: &'a mut [C],
}

/// Computes the inertia matrix by the composite rigid body algorithm: MuJoCo's `mj_crb`.
#[inline(always)]
pub fn crb(m: &Model, d: &mut Data) {
    let (plan, axes) = (m.plan(), &mut d.work.axes[..]);
    if plan.m_fours {
        for (four, axes) in d.cdof[..m.nv()].chunks(4).zip(&mut *axes) {
            for (lane, axis) in four.iter().enumerate() {
                for k in 0..6 {
                    axes[k][lane] = axis[k];
                }
            }
        }
    }
    let composite = Composite {
        cinert: &d.cinert,
        cdof: &d.cdof,
        crb: &mut d.work.crb,
        qm: &mut d.qm,
    };
    // computes the first elements of a row four at once, if the row is long enough
    crb_of::<f64>(
        m,
        (),
        composite,
        #[inline(always)]
        |i, force, row| {
            if !plan.m_fours {
                return 0;
            }
            let done = 4 * (plan.m_lead(i) / 4);
            for (four, axes) in row[..done].as_chunks_mut().0.iter_mut().zip(&*axes) {
                *four = dot6_of_four(axes, force);
            }
            done
        },
    );
}

/// [`crb`] for one world or several. `begin` may compute the first elements of a row from the force
/// of the row's degree of freedom, and returns the number of computed elements.
#[inline(always)]
pub(crate) fn crb_of<N: Number>(
    m: &Model,
    at: N::Place,
    composite: Composite<'_, N::Cell>,
    mut begin: impl FnMut(usize, &[N; 6], &mut [N::Cell]) -> usize,
) {
    let (n, nv, plan) = (m.nbody(), m.nv(), m.plan());
    let Composite {
        cinert,
        cdof,
        crb,
        qm,
    } = composite;
    let (crb, parents) = (&mut crb[..n], &m.body_parentid[..n]);
    crb.copy_from_slice(&cinert[..n]);
    for b in (1..n).rev() {
        let parent = parents[b];
        if parent > 0 {
            let (mut sum, part) = (get::<N, 10>(at, &crb[parent]), get::<N, 10>(at, &crb[b]));
            for k in 0..10 {
                sum[k] = sum[k] + part[k];
            }
            put(at, sum, &mut crb[parent]);
        }
    }
    let cdof = &cdof[..nv];
    for i in 0..nv {
        let row = plan.m_row(i);
        let (columns, row) = (&plan.m_colind[row.clone()], &mut qm[row]);
        let last = row.len() - 1;
        if m.dof_simplenum[i] > 0 {
            row.iter_mut()
                .for_each(|value| N::of(at, 0.0).put(at, value));
            N::of(at, m.dof_m0[i]).put(at, &mut row[last]);
            continue;
        }
        let inertia = get::<N, 10>(at, &crb[m.dof_bodyid[i]]);
        let force = mul_inertia(&inertia, &get(at, &cdof[i]));
        let done = begin(i, &force, row);
        for (value, &j) in row[done..].iter_mut().zip(&columns[done..]) {
            dot6(&get(at, &cdof[j]), &force).put(at, value);
        }
        (N::get(at, &row[last]) + m.dof_armature[i]).put(at, &mut row[last]);
    }
}

/// The products of four vectors, given by components, with one vector: each product as [`dot6`]
/// computes it.
#[inline(always)]
fn dot6_of_four(a: &[Lanes; 6], b: &Vec6) -> Lanes {
    let even = plus(times(a[0], b[0]), a[2], b[2]);
    let odd = plus(times(a[1], b[1]), a[3], b[3]);
    let last = plus(times(a[4], b[4]), a[5], b[5]);
    plus(plus(even, odd, 1.0), last, 1.0)
}

/// Factors the inertia matrix: MuJoCo's `mj_factorM`. For Euler's method it factors the matrix with
/// damping too.
#[inline(always)]
pub fn factor_m(m: &Model, d: &mut Data) {
    d.qld.copy_from_slice(&d.qm);
    if m.plan().implicit {
        add_damping(m, d);
        let work = &mut d.work;
        // interleaves the factorisations of both matrices: the CPU computes one while the other
        // waits for a division
        let damped = (&mut work.qh[..], &mut work.qh_diag_inv[..]);
        factor(m, [(&mut d.qld, &mut d.qld_diag_inv), damped]);
    } else {
        factor(m, [(&mut d.qld, &mut d.qld_diag_inv)]);
    }
}

/// Computes the inertia matrix with implicit damping.
#[inline(always)]
pub(super) fn add_damping(m: &Model, d: &mut Data) {
    let work = &mut d.work;
    work.qh.copy_from_slice(&d.qm);
    for i in 0..m.nv() {
        work.qh[m.plan().m_diagonal(i)] += m.opt.timestep * m.dof_damping[i];
    }
}

/// Factors the matrix of the implicit integrators.
pub(super) fn factor_damped(m: &Model, d: &mut Data) {
    let work = &mut d.work;
    factor(m, [(&mut work.qh[..], &mut work.qh_diag_inv[..])]);
}

/// Replaces matrices with the sparsity of the inertia matrix by `L' D L`, and computes the inverses
/// of the diagonals: MuJoCo's `mj_factorI`.
#[inline(always)]
fn factor<const N: usize>(m: &Model, matrices: [(&mut [f64], &mut [f64]); N]) {
    match m.plan().m_groups {
        1 => factor_chunks::<1, N>(m, 1, matrices),
        2 => factor_chunks::<2, N>(m, 1, matrices),
        3 => factor_chunks::<3, N>(m, 1, matrices),
        4 => factor_chunks::<4, N>(m, 1, matrices),
        more => factor_chunks::<4, N>(m, more / 4, matrices),
    }
}

/// [`factor`] for rows in chunks of `C` groups of four.
#[inline(always)]
fn factor_chunks<const C: usize, const N: usize>(
    m: &Model,
    per_row: usize,
    mut matrices: [(&mut [f64], &mut [f64]); N],
) {
    for k in (0..m.nv()).rev() {
        for (matrix, diag_inv) in &mut matrices {
            let (groups, _) = matrix.as_chunks_mut();
            let (chunks, _) = groups.as_chunks_mut::<C>();
            diag_inv[k] = eliminate(m.plan(), chunks, per_row, k);
        }
    }
}

/// Computes row `k` of the factor L, and returns the inverse of the row's diagonal element. The
/// rows of the descendants of `k` must be complete. Elements after the end of the row change too.
#[inline(always)]
fn eliminate<const C: usize>(
    plan: &Plan,
    matrix: &mut [[Lanes; C]],
    per_row: usize,
    k: usize,
) -> f64 {
    let (above, row) = matrix.split_at_mut(k * per_row);
    let row = &mut row[..per_row];
    let columns = &plan.m_colind[plan.m_ancestors(k)];
    let diagonal = row.as_flattened().as_flattened()[columns.len()];
    let inv = 1.0 / diagonal;
    // ancestors, from the nearest to the root
    for (c, &ancestor) in columns.iter().enumerate().rev() {
        let factor = row.as_flattened().as_flattened()[c] * inv;
        for (a, b) in above[ancestor * per_row..][..per_row].iter_mut().zip(&*row) {
            for g in 0..C {
                a[g] = minus(a[g], b[g], factor);
            }
        }
    }
    for group in row.as_flattened_mut() {
        *group = times(*group, inv);
    }
    row.as_flattened_mut().as_flattened_mut()[columns.len()] = diagonal;
    inv
}

/// Replaces `x` by `M^-1 x`: MuJoCo's `mj_solveM`.
pub fn solve_m(m: &Model, d: &Data, x: &mut [f64]) {
    solve(m, &d.qld, &d.qld_diag_inv, x);
}

/// Replaces `x` by `(L' D L)^-1 x`.
#[inline(always)]
pub(crate) fn solve(m: &Model, factors: &[f64], diag_inv: &[f64], x: &mut [f64]) {
    for tree in &m.plan().trees {
        solve_tree(m, factors, diag_inv, tree, &mut x[tree.clone()]);
    }
}

/// [`solve`] for the degrees of freedom of one tree: MuJoCo's `mj_solveLD`.
#[inline(never)]
pub(crate) fn solve_tree(
    m: &Model,
    factors: &[f64],
    diag_inv: &[f64],
    tree: &Range<usize>,
    x: &mut [f64],
) {
    let plan = m.plan();
    let diag_inv = &diag_inv[tree.clone()];
    for i in (1..x.len()).rev() {
        let xi = x[i];
        if xi != 0.0 {
            let row = plan.m_ancestors(tree.start + i);
            for (&j, l) in plan.m_local[row.clone()].iter().zip(&factors[row]) {
                x[j] -= l * xi;
            }
        }
    }
    for (x, inv) in x.iter_mut().zip(diag_inv) {
        *x *= inv;
    }
    for i in 1..x.len() {
        let row = plan.m_ancestors(tree.start + i);
        x[i] -= dense::dot_sparse(&factors[row.clone()], &plan.m_local[row], x);
    }
}

/// Writes `M x` to `y`: MuJoCo's `mj_mulM`.
pub fn mul_m(m: &Model, d: &Data, x: &[f64], y: &mut [f64]) {
    multiply(m, &d.qm, x, y);
}

/// Writes `M x` to `y`, for a matrix with the sparsity of the inertia matrix.
#[inline(always)]
pub(crate) fn multiply(m: &Model, qm: &[f64], x: &[f64], y: &mut [f64]) {
    for tree in &m.plan().trees {
        mul_m_tree(m, qm, tree, &x[tree.clone()], &mut y[tree.clone()]);
    }
}

/// [`multiply`] for the degrees of freedom of one tree: MuJoCo's `mju_mulSymVecSparse`, ancestors
/// from the nearest to the root.
#[inline(never)]
pub(crate) fn mul_m_tree(m: &Model, qm: &[f64], tree: &Range<usize>, x: &[f64], y: &mut [f64]) {
    let plan = m.plan();
    for (i, &xi) in x.iter().enumerate() {
        let row = plan.m_ancestors(tree.start + i);
        let mut sum = qm[row.end] * xi;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward;

    /// Returns a model of two chains of `length` hinges, whose axes alternate between x, y and z.
    fn chains(length: usize) -> Model {
        let body = |i: usize| {
            let axis = ["1 0 0", "0 1 0", "0 0 1"][i % 3];
            format!(
                r#"<body pos="0 0 0.2"><joint axis="{axis}" damping="1"/><geom type="sphere" size="0.1" contype="0"/>"#
            )
        };
        let chain = (0..length).map(body).collect::<String>() + &"</body>".repeat(length);
        Model::from_xml(&format!(
            "<mujoco><worldbody>{chain}{chain}</worldbody></mujoco>"
        ))
        .unwrap()
    }

    #[test]
    fn rows_of_all_lengths_are_factored() {
        // one to four groups of four elements, and more
        for length in [1, 4, 7, 10, 16, 17, 33] {
            let m = chains(length);
            let mut d = Data::new(&m);
            for (i, q) in d.qpos.iter_mut().enumerate() {
                *q = 0.1 + 0.01 * i as f64;
            }
            forward(&m, &mut d);
            let x: Vec<f64> = (0..m.nv()).map(|i| 1.0 + i as f64).collect();
            let mut solved = vec![0.0; m.nv()];
            mul_m(&m, &d, &x, &mut solved);
            for (i, row) in full_m(&m, &d).chunks(m.nv()).enumerate() {
                let product: f64 = row.iter().zip(&x).map(|(a, b)| a * b).sum();
                assert!(
                    (product - solved[i]).abs() < 1e-9 * product.abs().max(1.0),
                    "{length} {i}"
                );
            }
            solve_m(&m, &d, &mut solved);
            // the matrix with damping, for Euler's method
            let mut damped: Vec<f64> = x.clone();
            multiply(&m, &d.qm, &x, &mut damped);
            damped
                .iter_mut()
                .zip(&x)
                .for_each(|(y, x)| *y += m.opt.timestep * x);
            solve(&m, &d.work.qh, &d.work.qh_diag_inv, &mut damped);
            for (i, &x) in x.iter().enumerate() {
                assert!(
                    (solved[i] - x).abs() < 1e-4 * x,
                    "{length} {i}: {}",
                    solved[i]
                );
                assert!(
                    (damped[i] - x).abs() < 1e-4 * x,
                    "{length} {i}: {}",
                    damped[i]
                );
            }
        }
    }
}
