//! Newton's method on accelerations: the cost of constraints is quadratic between the places where rows start or cease to
//! push, so that few steps with exact line search reach the minimum.
//!
//! Each island is solved for itself, on vectors of its own degrees of freedom and rows: where its numbers stand decides in which
//! order they are summed.

use std::ops::Range;

use super::line_search::{Along, Row, line_search};
use super::{cholesky, cost_of_rows, residuals};
use crate::physics::constraint::{Block, mul_jacobian};
use crate::physics::dense::{self, Lanes, add_scaled, dot, norm};
use crate::physics::inertia::{mul_m, mul_m_tree, solve_tree};
use crate::physics::spatial::MINVAL;
use crate::{Data, Model};

/// Buffers of the solver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    // vectors of degrees of freedom: of the island, but for the first, which is of all
    ma_start: Vec<f64>,
    acc: Vec<Lanes>,
    smooth: Vec<Lanes>,
    constraint: Vec<Lanes>,
    ma: Vec<Lanes>,
    grad: Vec<Lanes>,
    mgrad: Vec<Lanes>,
    search: Vec<Lanes>,
    mv: Vec<Lanes>,
    row_update: Vec<Lanes>,
    /// The number of degrees of freedom that these are for.
    last: usize,
    /// The Hessian's lower triangle by columns, then its factor.
    hessian: Vec<Lanes>,
    // vectors of rows: of all, then of the island
    jar_start: Vec<f64>,
    jar: Vec<f64>,
    jv: Vec<f64>,
    aref: Vec<f64>,
    d: Vec<f64>,
    force: Vec<f64>,
    /// Whether each row pushes.
    pushes: Vec<bool>,
    rows: Vec<Row>,
    /// The Jacobian of an island that is not the whole model, and its blocks.
    jac: Vec<Lanes>,
    blocks: Vec<Block>,
}

impl Buffers {
    /// Buffers that need not grow up to so many degrees of freedom, rows and blocks.
    pub(crate) fn new(nv: usize, rows: usize, blocks: usize) -> Self {
        let mut buffers = Self::default();
        buffers.ma_start.resize(nv, 0.0);
        let groups = dense::groups(nv);
        for vector in [
            &mut buffers.acc,
            &mut buffers.smooth,
            &mut buffers.constraint,
            &mut buffers.ma,
            &mut buffers.grad,
            &mut buffers.mgrad,
            &mut buffers.search,
            &mut buffers.mv,
            &mut buffers.row_update,
        ] {
            vector.resize(groups, [0.0; 4]);
        }
        buffers.hessian.reserve(nv * groups);
        for vector in [
            &mut buffers.jar_start,
            &mut buffers.jar,
            &mut buffers.jv,
            &mut buffers.aref,
            &mut buffers.d,
            &mut buffers.force,
        ] {
            vector.reserve(rows);
        }
        buffers.pushes.reserve(rows);
        buffers.rows.reserve(rows);
        buffers.jac.reserve(rows * groups);
        buffers.blocks.reserve(blocks);
        buffers
    }

    /// Makes the vectors as long as an island needs them; what is beyond the last element is zero.
    fn fit(&mut self, n: usize) {
        for vector in [
            &mut self.acc,
            &mut self.smooth,
            &mut self.constraint,
            &mut self.ma,
            &mut self.grad,
            &mut self.mgrad,
            &mut self.search,
            &mut self.mv,
            &mut self.row_update,
        ] {
            if vector.len() != dense::groups(n) || (!n.is_multiple_of(4) && self.last != n) {
                vector.clear();
                vector.resize(dense::groups(n), [0.0; 4]);
            }
        }
        self.last = n;
    }
}

/// Solves all islands: MuJoCo's `mj_solNewton_island`.
#[inline(always)]
pub(super) fn solve(m: &Model, d: &mut Data) {
    let mut b = std::mem::take(&mut d.work.newton);

    // start where the last step ended, unless that is worse than without constraints
    let mut x = std::mem::take(&mut d.work.dofs);
    b.jar_start.resize(d.efc.nefc(), 0.0);
    residuals(m, &d.efc, &d.qacc_warmstart, &mut x, &mut b.jar_start);
    mul_m(m, d, &d.qacc_warmstart, &mut b.ma_start);
    let mut warm = cost_of_rows(&d.efc.d, &b.jar_start);
    for i in 0..m.nv() {
        let (force, a) = (b.ma_start[i] - d.qfrc_smooth[i], d.qacc_warmstart[i] - d.qacc_smooth[i]);
        warm += 0.5 * force * a;
    }
    let cold = warm > cost_of_rows(&d.efc.d, &d.efc.b);
    d.work.dofs = x;
    let start = if cold { &d.qacc_smooth } else { &d.qacc_warmstart };
    d.qacc.copy_from_slice(start);

    let islands = std::mem::take(&mut d.work.islands);
    let lists = (std::mem::take(&mut d.work.island_trees), std::mem::take(&mut d.work.island_blocks));
    for tree in (0..m.ntree()).filter(|&tree| d.work.tree_island[tree] == usize::MAX) {
        let dofs = m.plan().trees[tree].clone();
        d.qacc[dofs.clone()].copy_from_slice(&d.qacc_smooth[dofs]);
    }
    for island in &islands {
        let (trees, blocks) = (&lists.0[island.trees.clone()], &lists.1[island.blocks.clone()]);
        let iterations = if trees.len() == m.ntree() {
            // the island is the whole model
            b.d.clear();
            b.d.extend_from_slice(&d.efc.d);
            b.aref.clear();
            b.aref.extend_from_slice(&d.efc.aref);
            b.jar.clear();
            b.jar.extend_from_slice(if cold { &d.efc.b } else { &b.jar_start });
            let efc = std::mem::take(&mut d.efc);
            let jacobian = Jacobian { blocks: &efc.blocks, jac: efc.jacobian(), stride: efc.stride() };
            let iterations = solve_island(m, d, &mut b, trees, &jacobian, true);
            d.efc = efc;
            d.efc.force.copy_from_slice(&b.force);
            iterations
        } else {
            gather(m, d, &mut b, trees, blocks);
            let (jac, island_blocks) = (std::mem::take(&mut b.jac), std::mem::take(&mut b.blocks));
            let stride = dense::groups(dofs_of(m, trees));
            let jacobian = Jacobian { blocks: &island_blocks, jac: &jac, stride };
            let iterations = solve_island(m, d, &mut b, trees, &jacobian, false);
            (b.jac, b.blocks) = (jac, island_blocks);
            let mut forces = b.force.iter();
            for &index in blocks {
                let block = &d.efc.blocks[index];
                for (to, from) in d.efc.force[block.row..block.row + block.rows].iter_mut().zip(&mut forces) {
                    *to = *from;
                }
            }
            iterations
        };
        d.solver_niter.push(iterations);
    }
    (d.work.island_trees, d.work.island_blocks) = lists;
    d.work.islands = islands;
    d.work.newton = b;
}

/// The number of degrees of freedom of some trees.
fn dofs_of(m: &Model, trees: &[usize]) -> usize {
    trees.iter().map(|&tree| m.plan().trees[tree].len()).sum()
}

/// The degrees of freedom of some trees: where they stand in the model, and in the island.
fn places<'a>(m: &'a Model, trees: &'a [usize]) -> impl Iterator<Item = (Range<usize>, Range<usize>)> + 'a {
    let mut next = 0;
    trees.iter().map(move |&tree| {
        let dofs = m.plan().trees[tree].clone();
        let place = next..next + dofs.len();
        next = place.end;
        (dofs, place)
    })
}

/// Copies the numbers of an island from those of all.
fn gather(m: &Model, d: &Data, b: &mut Buffers, trees: &[usize], blocks: &[usize]) {
    let (efc, stride) = (&d.efc, dense::groups(dofs_of(m, trees)));
    b.blocks.clear();
    b.jac.clear();
    b.d.clear();
    b.aref.clear();
    for &index in blocks {
        let block = &efc.blocks[index];
        b.blocks.push(Block { row: b.d.len(), groups: stride, ..block.clone() });
        for row in block.row..block.row + block.rows {
            let from = efc.jacobian()[row * efc.stride()..(row + 1) * efc.stride()].as_flattened();
            let start = b.jac.len();
            b.jac.resize(start + stride, [0.0; 4]);
            let to = b.jac[start..].as_flattened_mut();
            for (dofs, place) in places(m, trees) {
                to[place].copy_from_slice(&from[dofs]);
            }
        }
        let rows = block.row..block.row + block.rows;
        b.d.extend_from_slice(&efc.d[rows.clone()]);
        b.aref.extend_from_slice(&efc.aref[rows]);
    }
}

/// The rows of an island.
struct Jacobian<'a> {
    blocks: &'a [Block],
    jac: &'a [Lanes],
    stride: usize,
}

impl Jacobian<'_> {
    #[inline]
    fn row(&self, row: usize) -> &[Lanes] {
        &self.jac[row * self.stride..(row + 1) * self.stride]
    }

    #[inline]
    fn mul(&self, x: &[Lanes], n: usize, out: &mut [f64]) {
        mul_jacobian(self.blocks, self.jac, self.stride, x, n, out);
    }
}

/// Solves one island: MuJoCo's `mj_solPrimal`. Returns the number of iterations, and leaves forces behind.
#[inline(always)]
fn solve_island(
    m: &Model,
    d: &mut Data,
    b: &mut Buffers,
    trees: &[usize],
    jacobian: &Jacobian<'_>,
    whole: bool,
) -> usize {
    let (n, nefc) = (dofs_of(m, trees), b.d.len());
    b.fit(n);
    let mut inertia = 0.0;
    for (dofs, place) in places(m, trees) {
        b.acc.as_flattened_mut()[place.clone()].copy_from_slice(&d.qacc[dofs.clone()]);
        b.smooth.as_flattened_mut()[place].copy_from_slice(&d.qfrc_smooth[dofs.clone()]);
        for i in dofs {
            inertia += d.qm[m.plan().m_rowadr[i + 1] - 1];
        }
    }
    let (scale, tolerance) = (1.0 / inertia, m.opt.tolerance);
    mul_m_island(m, d, trees, &b.acc, &mut b.ma);
    if !whole {
        b.jar.resize(nefc, 0.0);
        jacobian.mul(&b.acc, n, &mut b.jar);
        b.jar.iter_mut().zip(&b.aref).for_each(|(jar, aref)| *jar -= aref);
    }
    b.jv.resize(nefc, 0.0);
    b.force.resize(nefc, 0.0);
    b.pushes.clear();
    b.pushes.extend(b.jar.iter().map(|jar| *jar < 0.0));
    update(b, jacobian);
    let iterations = iterate(m, d, b, trees, jacobian, scale, tolerance);
    for (dofs, place) in places(m, trees) {
        d.qacc[dofs.clone()].copy_from_slice(&b.acc.as_flattened()[place.clone()]);
        d.qfrc_constraint[dofs].copy_from_slice(&b.constraint.as_flattened()[place]);
    }
    iterations
}

#[inline(always)]
fn iterate(
    m: &Model,
    d: &Data,
    b: &mut Buffers,
    trees: &[usize],
    jacobian: &Jacobian<'_>,
    scale: f64,
    tolerance: f64,
) -> usize {
    let n = dofs_of(m, trees);
    let decrement = |b: &Buffers| f64::max(0.0, 0.5 * scale * dot(&b.grad, &b.mgrad, n));
    let level = scale * norm(&b.grad, n) < tolerance;
    if level {
        // half of the gradient's square is more than can be gained
        b.mgrad.copy_from_slice(&b.grad);
        for (dofs, place) in places(m, trees) {
            solve_tree(m, &d.qld, &d.qld_diag_inv, &dofs, &mut b.mgrad.as_flattened_mut()[place]);
        }
        if decrement(b) < tolerance {
            return 0;
        }
    }
    hessian(m, d, b, trees, jacobian);
    newton_direction(b, n, jacobian.stride);
    if level && decrement(b) < tolerance {
        return 0;
    }

    for iteration in 1..=m.opt.iterations {
        for (search, mgrad) in b.search.as_flattened_mut().iter_mut().zip(b.mgrad.as_flattened()) {
            *search = -mgrad;
        }
        let (alpha, improvement) = search(m, d, b, trees, jacobian, scale);
        if alpha == 0.0 {
            return iteration - 1;
        }
        add_scaled(&mut b.acc, &b.search, alpha);
        add_scaled(&mut b.ma, &b.mv, alpha);
        for (jar, jv) in b.jar.iter_mut().zip(&b.jv) {
            *jar += jv * alpha;
        }
        update(b, jacobian);
        let improvement = scale * improvement;
        if (improvement > 0.0 && improvement < tolerance) || scale * norm(&b.grad, n) < tolerance {
            return iteration;
        }
        update_hessian(m, d, b, trees, jacobian);
        newton_direction(b, n, jacobian.stride);
        if decrement(b) < tolerance {
            return iteration;
        }
    }
    m.opt.iterations
}

/// `M x` for an island.
#[inline(always)]
fn mul_m_island(m: &Model, d: &Data, trees: &[usize], x: &[Lanes], y: &mut [Lanes]) {
    for (dofs, place) in places(m, trees) {
        mul_m_tree(m, &d.qm, &dofs, &x.as_flattened()[place.clone()], &mut y.as_flattened_mut()[place]);
    }
}

/// Forces of the rows, what they are to the joints, and the gradient: MuJoCo's `PrimalUpdateConstraint` and `PrimalUpdateGrad`.
#[inline(always)]
fn update(b: &mut Buffers, jacobian: &Jacobian<'_>) {
    b.constraint.fill([0.0; 4]);
    for block in jacobian.blocks {
        for row in block.row..block.row + block.rows {
            let jar = b.jar[row];
            let force = if jar < 0.0 { -b.d[row] * jar } else { 0.0 };
            b.force[row] = force;
            if force != 0.0 {
                add_scaled(&mut b.constraint, &jacobian.row(row)[..block.groups], force);
            }
        }
    }
    for (((grad, ma), smooth), constraint) in b.grad.iter_mut().zip(&b.ma).zip(&b.smooth).zip(&b.constraint) {
        for k in 0..4 {
            grad[k] = ma[k] - smooth[k] - constraint[k];
        }
    }
}

/// `H^-1 grad`.
#[inline(always)]
fn newton_direction(b: &mut Buffers, n: usize, stride: usize) {
    b.mgrad.copy_from_slice(&b.grad);
    cholesky::solve(&b.hessian, n, stride, &mut b.mgrad);
}

/// Makes and factors the Hessian of the cost, `M + J' D J` over the rows that push: MuJoCo's `MakeHessian`.
#[inline(always)]
fn hessian(m: &Model, d: &Data, b: &mut Buffers, trees: &[usize], jacobian: &Jacobian<'_>) {
    let (n, stride) = (dofs_of(m, trees), jacobian.stride);
    let h = &mut b.hessian;
    h.clear();
    h.resize(n * stride, [0.0; 4]);
    for block in jacobian.blocks {
        for row in (block.row..block.row + block.rows).filter(|&row| b.pushes[row] && b.d[row] != 0.0) {
            let jac = &jacobian.row(row)[..block.groups];
            let pushed = &mut b.row_update[..block.groups];
            for (pushed, jac) in pushed.iter_mut().zip(jac) {
                *pushed = jac.map(|j| j * b.d[row]);
            }
            for (i, &j) in jac.as_flattened().iter().enumerate().filter(|(_, j)| **j != 0.0) {
                let first = i / 4;
                add_scaled(&mut h[i * stride + first..i * stride + block.groups], &pushed[first..], j);
            }
        }
    }
    let plan = m.plan();
    for (dofs, place) in places(m, trees) {
        for i in dofs.clone() {
            let row = place.start + i - dofs.start;
            for k in plan.m_row(i) {
                h[(place.start + plan.m_local[k]) * stride + row / 4][row % 4] += d.qm[k];
            }
        }
    }
    cholesky::factor(h, n, stride);
}

/// Changes the factor by the rows that began or ceased to push: MuJoCo's `HessianIncremental`.
#[inline(always)]
fn update_hessian(m: &Model, d: &Data, b: &mut Buffers, trees: &[usize], jacobian: &Jacobian<'_>) {
    let n = dofs_of(m, trees);
    let mut definite = true;
    for row in 0..b.jar.len() {
        let pushes = b.jar[row] < 0.0;
        if pushes == b.pushes[row] {
            continue;
        }
        b.pushes[row] = pushes;
        if definite {
            let root = b.d[row].sqrt();
            for (x, jac) in b.row_update.iter_mut().zip(jacobian.row(row)) {
                *x = jac.map(|j| j * root);
            }
            definite = cholesky::update(&mut b.hessian, n, jacobian.stride, &mut b.row_update, pushes);
        }
    }
    if !definite {
        hessian(m, d, b, trees, jacobian);
    }
}

/// The length of the step along the search direction, and the improvement; leaves `M search` and `J search` behind.
#[inline(always)]
fn search(
    m: &Model,
    d: &Data,
    b: &mut Buffers,
    trees: &[usize],
    jacobian: &Jacobian<'_>,
    scale: f64,
) -> (f64, f64) {
    let n = dofs_of(m, trees);
    let length = norm(&b.search, n);
    if length < MINVAL {
        return (0.0, 0.0);
    }
    mul_m_island(m, d, trees, &b.search, &mut b.mv);
    jacobian.mul(&b.search, n, &mut b.jv);
    b.rows.clear();
    b.rows.extend(b.jar.iter().zip(&b.jv).zip(&b.d).map(|((&jar, &jv), &d)| Row::new(jar, jv, d)));
    let along = Along {
        rows: &b.rows,
        linear: dot(&b.search, &b.ma, n) - dot(&b.smooth, &b.search, n),
        quadratic: 0.5 * dot(&b.search, &b.mv, n),
        evaluations: 0,
    };
    line_search(along, m.opt.tolerance * m.opt.ls_tolerance * length / scale, m.opt.ls_iterations)
}
