//! The inertia matrix of the joints, and its factors along the tree.
//!
//! A degree of freedom couples only with its ancestors and descendants. So each row of the lower
//! triangle stores only the columns of its ancestors, root first, and the diagonal last. The
//! columns of an ancestor are then the first columns of a descendant, and factors `L' D L`, made
//! from the last row on, fill in nothing.

use super::passive::polynomials;
use std::ops::Range;

use crate::math::dense::{self, Lanes, minus, plus, times};
use crate::math::number::{Number, get, put};
use crate::math::spatial::{Vec6, dot6, mul_inertia};
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
    let (plan, axes, cdof) = (m.plan(), &mut d.work.axes[..], &d.cdof[..m.nv()]);
    let composite = Composite {
        cinert: &d.cinert,
        cdof,
        crb: &mut d.work.crb,
        qm: &mut d.qm,
    };
    // `axes` holds the motion axes on the way from the root to degree of freedom `known - 1`
    let mut known = 0;
    crb_of::<f64>(
        m,
        (),
        composite,
        #[inline(always)]
        |i, force, row| {
            if i >= known {
                known = i + read_axes(&cdof[i..], &plan.depths[i..], axes);
            }
            let (fours, _) = row.as_chunks_mut();
            for (four, axes) in fours.iter_mut().zip(&axes[..=plan.depths[i] / 4]) {
                *four = dot6_of_four(axes, force);
            }
            true
        },
    );
    if m.plan().tendon_armature {
        add_tendon_armature(m, d);
    }
}

/// Adds the inertia along tendons, where the matrix has elements: MuJoCo's `mj_tendonArmature`.
#[cold]
fn add_tendon_armature(m: &Model, d: &mut Data) {
    let plan = m.plan();
    for (t, armature) in m.tendon_armature.iter().enumerate() {
        if *armature == 0.0 {
            continue;
        }
        let row = plan.paths.rows[t].clone();
        let columns = &plan.paths.columns[row.clone()];
        let arms = &d.ten_j[row];
        for (&i, &arm) in columns.iter().zip(arms) {
            if arm == 0.0 {
                continue;
            }
            let factor = armature * arm;
            let within = if m.dof_simplenum[i] > 0 {
                plan.m_diagonal(i)..plan.m_diagonal(i) + 1
            } else {
                plan.m_row(i)
            };
            for k in within {
                if let Some(at) = columns.iter().position(|c| *c == plan.m_colind[k]) {
                    d.qm[k] += arms[at] * factor;
                }
            }
        }
    }
}

/// Reads the motion axes of the first degrees of freedom, each the parent of the next one. Returns
/// their number.
#[inline(always)]
fn read_axes(cdof: &[Vec6], depths: &[usize], axes: &mut [[Lanes; 6]]) -> usize {
    let start = depths[0];
    let mut count = 0;
    for (place, (axis, depth)) in (start..).zip(cdof.iter().zip(depths)) {
        if place != *depth {
            break;
        }
        let four = &mut axes[place / 4];
        if place % 4 == 0 {
            *four = [[0.0; 4]; 6];
        }
        for (four, x) in four.iter_mut().zip(axis) {
            four[place % 4] = *x;
        }
        count += 1;
    }
    count
}

/// [`crb`] for one world or several. `begin` may compute a row, and the elements that are stored
/// after the end of the row, from the force of the row's degree of freedom. `begin` returns true if
/// it computed the row.
#[inline(always)]
pub(crate) fn crb_of<N: Number>(
    m: &Model,
    at: N::At,
    composite: Composite<'_, N::Cell>,
    mut begin: impl FnMut(usize, &[N; 6], &mut [N::Cell]) -> bool,
) {
    let (n, nv, plan) = (m.nbody(), m.nv(), m.plan());
    let (crb, parents) = (&mut composite.crb[..n], &m.body_parentid[..n]);
    crb.copy_from_slice(&composite.cinert[..n]);
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
    let (cdof, qm) = (&composite.cdof[..nv], composite.qm);
    let (bodies, armatures) = (&m.dof_bodyid[..nv], &m.dof_armature[..nv]);
    for i in 0..nv {
        let places = plan.m_row(i);
        let last = places.len() - 1;
        let row = &mut qm[places.start..];
        if m.dof_simplenum[i] > 0 {
            row[..last]
                .iter_mut()
                .for_each(|value| N::of(at, 0.0).put(at, value));
            N::of(at, m.dof_m0[i]).put(at, &mut row[last]);
            continue;
        }
        let inertia = get::<N, 10>(at, &crb[bodies[i]]);
        let force = mul_inertia(&inertia, &get(at, &cdof[i]));
        if !begin(i, &force, row) {
            for (value, &j) in row.iter_mut().zip(&plan.m_colind[places]) {
                dot6(&get(at, &cdof[j]), &force).put(at, value);
            }
        }
        (N::get(at, &row[last]) + armatures[i]).put(at, &mut row[last]);
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
    if m.plan().polynomials {
        for i in 0..m.nv() {
            let slope = polynomials::slope(m.dof_damping[i], m.dof_dampingpoly[i], d.qvel[i]);
            work.qh[m.plan().m_diagonal(i)] += m.opt.timestep * slope;
        }
        return;
    }
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
    // ancestors, from the nearest to the root; an ancestor's row ends in the group of four that has
    // the ancestor's own column
    if per_row > 1 {
        subtract::<C, C>(above, row, columns, 0, inv);
    } else {
        if C > 3 {
            subtract::<C, 4>(above, row, columns, 12, inv);
        }
        if C > 2 {
            subtract::<C, 3>(above, row, &columns[..columns.len().min(12)], 8, inv);
        }
        if C > 1 {
            subtract::<C, 2>(above, row, &columns[..columns.len().min(8)], 4, inv);
        }
        subtract::<C, 1>(above, row, &columns[..columns.len().min(4)], 0, inv);
    }
    for group in row.as_flattened_mut() {
        *group = times(*group, inv);
    }
    row.as_flattened_mut().as_flattened_mut()[columns.len()] = diagonal;
    inv
}

/// Subtracts multiples of a row from the first `G` groups in each chunk of the rows of its
/// ancestors, from the last down to number `first`.
#[inline(always)]
fn subtract<const C: usize, const G: usize>(
    above: &mut [[Lanes; C]],
    row: &[[Lanes; C]],
    columns: &[usize],
    first: usize,
    inv: f64,
) {
    for c in (first..columns.len()).rev() {
        let factor = row.as_flattened().as_flattened()[c] * inv;
        let ancestor = &mut above[columns[c] * row.len()..][..row.len()];
        for (a, b) in ancestor.iter_mut().zip(row) {
            for g in 0..G.min(C) {
                a[g] = minus(a[g], b[g], factor);
            }
        }
    }
}

/// Two vectors with one element for each degree of freedom on the path from the root of a tree to a
/// degree of freedom, in the order of a row of the inertia matrix.
///
/// A degree of freedom comes after its parent, or after a descendant of its parent. So from one
/// degree of freedom to the next, only the end of the path changes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Way {
    x: Vec<Lanes>,
    y: Vec<Lanes>,
}

impl Way {
    pub(crate) fn new(m: &Model) -> Self {
        let zeros = vec![[0.0; 4]; m.plan().m_groups];
        Self {
            x: zeros.clone(),
            y: zeros,
        }
    }

    #[cfg(test)]
    pub(crate) fn poison(&mut self) {
        for vector in [&mut self.x, &mut self.y] {
            crate::physics::work::Poison::poison(vector);
        }
    }
}

/// Replaces `x` by `M^-1 x`: MuJoCo's `mj_solveM`.
pub fn solve_m(m: &Model, d: &Data, x: &mut [f64]) {
    solve(m, &d.qld, &d.qld_diag_inv, &mut Way::new(m), x);
}

/// Replaces `x` by `(L' D L)^-1 x`.
#[inline(always)]
pub(crate) fn solve(m: &Model, factors: &[f64], diag_inv: &[f64], way: &mut Way, x: &mut [f64]) {
    for tree in &m.plan().trees {
        solve_tree(m, factors, diag_inv, tree, way, &mut x[tree.clone()]);
    }
}

/// [`solve`] for the degrees of freedom of one tree: MuJoCo's `mj_solveLD`.
#[inline(never)]
pub(crate) fn solve_tree(
    m: &Model,
    factors: &[f64],
    diag_inv: &[f64],
    tree: &Range<usize>,
    way: &mut Way,
    x: &mut [f64],
) {
    let (inverses, way) = (&diag_inv[tree.clone()], &mut way.x[..]);
    match m.plan().m_groups {
        1 => solve_chunks::<1>(Rows::new(m, factors, tree, 1), inverses, way, x),
        2 => solve_chunks::<2>(Rows::new(m, factors, tree, 1), inverses, way, x),
        3 => solve_chunks::<3>(Rows::new(m, factors, tree, 1), inverses, way, x),
        4 => solve_chunks::<4>(Rows::new(m, factors, tree, 1), inverses, way, x),
        more => solve_chunks::<4>(Rows::new(m, factors, tree, more / 4), inverses, way, x),
    }
}

/// [`solve_tree`] for rows in chunks of `C` groups of four.
#[inline(always)]
fn solve_chunks<const C: usize>(
    rows: Rows<'_, C>,
    inverses: &[f64],
    way: &mut [Lanes],
    x: &mut [f64],
) {
    let n = rows.depths.len();
    let (x, way) = (&mut x[..n], rows.way(way));
    let mut known = 0;
    for i in (0..n).rev() {
        let depth = rows.depths[i];
        if known <= depth {
            for (place, &column) in rows.columns(i).iter().enumerate().skip(known) {
                way.as_flattened_mut().as_flattened_mut()[place] = x[column];
            }
        }
        known = depth;
        let xi = way.as_flattened().as_flattened()[depth];
        x[i] = xi;
        if xi != 0.0 {
            // numbers after the end of the way change too
            for (way, l) in way.iter_mut().zip(rows.get(i)) {
                for g in 0..C {
                    way[g] = minus(way[g], l[g], xi);
                }
            }
        }
    }
    for (x, inverse) in x.iter_mut().zip(inverses) {
        *x *= inverse;
    }
    for i in 0..n {
        let (depth, row) = (rows.depths[i], rows.get(i).as_flattened());
        x[i] -= dense::dot_one_by_one(row, way.as_flattened(), depth);
        way.as_flattened_mut().as_flattened_mut()[depth] = x[i];
    }
}

/// Writes `M x` to `y`: MuJoCo's `mj_mulM`.
pub fn mul_m(m: &Model, d: &Data, x: &[f64], y: &mut [f64]) {
    multiply(m, &d.qm, &mut Way::new(m), x, y);
}

/// Writes `M x` to `y`, for a matrix with the sparsity of the inertia matrix.
#[inline(always)]
pub(crate) fn multiply(m: &Model, qm: &[f64], way: &mut Way, x: &[f64], y: &mut [f64]) {
    for tree in &m.plan().trees {
        mul_m_tree(m, qm, tree, way, &x[tree.clone()], &mut y[tree.clone()]);
    }
}

/// [`multiply`] for the degrees of freedom of one tree: MuJoCo's `mju_mulSymVecSparse`, ancestors
/// from the nearest to the root.
#[inline(never)]
pub(crate) fn mul_m_tree(
    m: &Model,
    qm: &[f64],
    tree: &Range<usize>,
    way: &mut Way,
    x: &[f64],
    y: &mut [f64],
) {
    match m.plan().m_groups {
        1 => mul_m_chunks::<1>(Rows::new(m, qm, tree, 1), way, x, y),
        2 => mul_m_chunks::<2>(Rows::new(m, qm, tree, 1), way, x, y),
        3 => mul_m_chunks::<3>(Rows::new(m, qm, tree, 1), way, x, y),
        4 => mul_m_chunks::<4>(Rows::new(m, qm, tree, 1), way, x, y),
        more => mul_m_chunks::<4>(Rows::new(m, qm, tree, more / 4), way, x, y),
    }
}

/// [`mul_m_tree`] for rows in chunks of `C` groups of four.
#[inline(always)]
fn mul_m_chunks<const C: usize>(rows: Rows<'_, C>, way: &mut Way, x: &[f64], y: &mut [f64]) {
    let n = rows.depths.len();
    let (x, y) = (&x[..n], &mut y[..n]);
    let (way_x, way_y) = (rows.way(&mut way.x), rows.way(&mut way.y));
    for i in 0..n {
        let (depth, row, xi) = (rows.depths[i], rows.get(i), x[i]);
        let elements = &row.as_flattened().as_flattened()[..=depth];
        let known = &way_x.as_flattened().as_flattened()[..depth];
        let mut sum = elements[depth] * xi;
        for k in (0..depth).rev() {
            sum += elements[k] * known[k];
        }
        // numbers after the end of the way change too
        for (y, values) in way_y.iter_mut().zip(row) {
            for g in 0..C {
                y[g] = plus(y[g], values[g], xi);
            }
        }
        way_x.as_flattened_mut().as_flattened_mut()[depth] = xi;
        way_y.as_flattened_mut().as_flattened_mut()[depth] = sum;
        let kept = rows.depths.get(i + 1).copied().unwrap_or(0);
        if kept <= depth {
            for (place, &column) in rows.columns(i).iter().enumerate().skip(kept) {
                y[column] = way_y.as_flattened().as_flattened()[place];
            }
        }
    }
}

/// The rows of a tree's degrees of freedom, in chunks of `C` groups of four.
#[derive(Clone, Copy)]
struct Rows<'a, const C: usize> {
    plan: &'a Plan,
    first: usize,
    depths: &'a [usize],
    chunks: &'a [[Lanes; C]],
    per_row: usize,
}

impl<'a, const C: usize> Rows<'a, C> {
    #[inline(always)]
    fn new(m: &'a Model, elements: &'a [f64], tree: &Range<usize>, per_row: usize) -> Self {
        let chunks = elements.as_chunks().0.as_chunks().0;
        Self {
            plan: m.plan(),
            first: tree.start,
            depths: &m.plan().depths[tree.clone()],
            chunks: &chunks[tree.start * per_row..tree.end * per_row],
            per_row,
        }
    }

    /// The elements of a row.
    #[inline(always)]
    fn get(&self, i: usize) -> &'a [[Lanes; C]] {
        &self.chunks[i * self.per_row..][..self.per_row]
    }

    /// The columns of a row, counted from the start of the tree.
    #[inline(always)]
    fn columns(&self, i: usize) -> &'a [usize] {
        &self.plan.m_local[self.plan.m_row(self.first + i)]
    }

    /// The numbers of a way, in chunks.
    #[inline(always)]
    fn way<'b>(&self, numbers: &'b mut [Lanes]) -> &'b mut [[Lanes; C]] {
        &mut numbers.as_chunks_mut().0[..self.per_row]
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
            let mut way = Way::new(&m);
            multiply(&m, &d.qm, &mut way, &x, &mut damped);
            damped
                .iter_mut()
                .zip(&x)
                .for_each(|(y, x)| *y += m.opt.timestep * x);
            solve(&m, &d.work.qh, &d.work.qh_diag_inv, &mut way, &mut damped);
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
