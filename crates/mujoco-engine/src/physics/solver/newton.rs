//! Newton's method on accelerations. The cost of the constraints is a quadratic function as long as
//! the same rows push, so a few steps with exact line search reach the minimum.
//!
//! Each island has vectors of its own degrees of freedom and rows, as in MuJoCo, because an
//! element's position in a vector affects the order of a sum.

use std::ops::Range;

use super::buffers::{Buffers, Gathered};
use super::cones::{Matrix, factor};
use super::line_search::{Along, Row, line_search};
use super::row_costs::{ConeHessian, RowCosts, State};
use super::sparse::Sparse;
use super::{cholesky, conjugate, cost_of_rows, residuals};
use crate::math::dense::{self, Lanes, add_scaled, combine, minus, times};
use crate::math::spatial::MINVAL;
use crate::model::{Disable, Solver};
use crate::physics::constraint::{Block, Constraints, mul_jacobian};
use crate::physics::inertia::{Way, mul_m_tree, multiply, solve_tree};
use crate::{Data, Model};

/// Solves all islands: MuJoCo's `mj_solNewton_island`.
#[inline(always)]
pub(super) fn solve(m: &Model, d: &mut Data) {
    let (efc, work) = (&mut d.efc, &mut d.work);
    let b = &mut work.newton;

    // start at the last step's accelerations, or at the accelerations without constraints if these
    // have a lower cost
    b.jar.resize(efc.nefc(), 0.0);
    residuals(m, efc, &d.qacc_warmstart, &mut work.dofs, &mut b.jar);
    multiply(m, &d.qm, &mut b.way, &d.qacc_warmstart, &mut b.ma_start);
    let general = !m.plan().inequalities_only;
    let row_costs = RowCosts {
        blocks: &efc.blocks,
        d: &efc.d,
        r: &efc.r,
        loss: &efc.loss,
        contacts: &d.contact,
        revision: m.revision,
    };
    let (cost,) = (
        #[inline(always)]
        |b: &mut Buffers, jar: &[f64]| {
            if general {
                b.force.resize(jar.len(), 0.0);
                b.states.resize(jar.len(), State::Satisfied);
                row_costs.update(jar, &mut b.force, &mut b.states, &mut b.cones)
            } else {
                cost_of_rows(&efc.d, jar)
            }
        },
    );
    let jar = std::mem::take(&mut b.jar);
    let mut warm = cost(b, &jar);
    b.jar = jar;
    for i in 0..m.nv() {
        let force = b.ma_start[i] - d.qfrc_smooth[i];
        let a = d.qacc_warmstart[i] - d.qacc_smooth[i];
        warm += 0.5 * force * a;
    }
    let cold = warm > cost(b, &efc.b) || m.opt.disables(Disable::WarmStart);
    let start = if cold {
        &d.qacc_smooth
    } else {
        &d.qacc_warmstart
    };
    d.qacc.copy_from_slice(start);

    for tree in (0..m.ntree()).filter(|&tree| work.tree_island[tree] == usize::MAX) {
        let dofs = m.plan().trees[tree].clone();
        d.qacc[dofs.clone()].copy_from_slice(&d.qacc_smooth[dofs]);
    }
    for island in &work.islands {
        let trees = &work.island_trees[island.trees.clone()];
        let blocks = &work.island_blocks[island.blocks.clone()];
        let n = trees.iter().map(|&tree| m.plan().trees[tree].len()).sum();
        let mut problem = Problem {
            m,
            trees,
            n,
            qm: &d.qm,
            qld: &d.qld,
            qld_diag_inv: &d.qld_diag_inv,
            qfrc_smooth: &d.qfrc_smooth,
            blocks: &efc.blocks,
            jac: efc.jacobian(),
            stride: efc.stride(),
            d: &efc.d,
            aref: &efc.aref,
            cold,
            row_costs: general.then_some(row_costs),
            sparse: m.plan().sparse,
        };
        if problem.sparse {
            b.sparse.gather(&problem, efc, blocks);
        }
        let answer = (&mut *d.qacc, &mut *d.qfrc_constraint);
        let iterations = if trees.len() == m.ntree() {
            // the island is the whole model
            if cold {
                b.jar.copy_from_slice(&efc.b);
            }
            let iterations = solve_island(&problem, b, answer, true);
            efc.force.copy_from_slice(&b.force);
            iterations
        } else {
            let mut rows = std::mem::take(&mut b.gathered);
            gather(&problem, efc, &mut rows, blocks);
            (problem.blocks, problem.jac, problem.stride) =
                (&rows.blocks, &rows.jac, dense::groups(n));
            (problem.d, problem.aref) = (&rows.d, &rows.aref);
            problem.row_costs = general.then_some(RowCosts {
                blocks: &rows.blocks,
                d: &rows.d,
                r: &rows.r,
                loss: &rows.loss,
                contacts: &d.contact,
                revision: m.revision,
            });
            let iterations = solve_island(&problem, b, answer, false);
            b.gathered = rows;
            let mut forces = b.force.iter();
            for &index in blocks {
                let block = &efc.blocks[index];
                for (to, from) in efc.force[block.row..block.row + block.rows]
                    .iter_mut()
                    .zip(&mut forces)
                {
                    *to = *from;
                }
            }
            iterations
        };
        d.solver_niter.push(iterations);
    }
}

/// The optimisation problem of one island, which Newton's method or CG solves.
pub(super) struct Problem<'a> {
    pub(super) m: &'a Model,
    trees: &'a [usize],
    /// The number of degrees of freedom.
    pub(super) n: usize,
    // over all degrees of freedom of the model
    pub(super) qm: &'a [f64],
    qld: &'a [f64],
    qld_diag_inv: &'a [f64],
    qfrc_smooth: &'a [f64],
    // over the island's rows
    blocks: &'a [Block],
    jac: &'a [Lanes],
    stride: usize,
    pub(super) d: &'a [f64],
    aref: &'a [f64],
    /// Whether the start is not that of the last step, for which `M x` is known.
    cold: bool,
    /// For models with equality constraints, dry friction or elliptic cones.
    row_costs: Option<RowCosts<'a>>,
    /// Whether the matrices are those of [`Sparse`](super::sparse::Sparse).
    sparse: bool,
}

impl Problem<'_> {
    /// Iterates over the trees of the island: the range of a tree's degrees of freedom in the
    /// model, and in the island.
    #[inline(always)]
    pub(super) fn places(&self) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
        let mut next = 0;
        self.trees.iter().map(
            #[inline(always)]
            move |&tree| {
                let dofs = self.m.plan().trees[tree].clone();
                let place = next..next + dofs.len();
                next = place.end;
                (dofs, place)
            },
        )
    }

    /// Returns row `row` of the Jacobian.
    #[inline]
    fn row(&self, row: usize) -> &[Lanes] {
        &self.jac[row * self.stride..(row + 1) * self.stride]
    }

    /// Computes `J x`.
    #[inline(always)]
    fn mul_jacobian(&self, sparse: &Sparse, x: &[Lanes], out: &mut [f64]) {
        if self.sparse {
            return sparse.multiply(x, out);
        }
        mul_jacobian(self.blocks, self.jac, self.stride, x, self.n, out);
    }

    /// Replaces the numbers `x` of a tree by `M^-1 x`.
    #[inline(always)]
    pub(super) fn solve_tree(&self, dofs: &Range<usize>, way: &mut Way, x: &mut [f64]) {
        solve_tree(self.m, self.qld, self.qld_diag_inv, dofs, way, x);
    }

    /// Computes `M x`.
    #[inline(always)]
    fn mul_m(&self, way: &mut Way, x: &[Lanes], y: &mut [Lanes]) {
        for (dofs, place) in self.places() {
            let x = &x.as_flattened()[place.clone()];
            let y = &mut y.as_flattened_mut()[place];
            mul_m_tree(self.m, self.qm, &dofs, way, x, y);
        }
    }
}

/// Copies the data of an island's rows from the data of all rows.
fn gather(problem: &Problem<'_>, efc: &Constraints, b: &mut Gathered, blocks: &[usize]) {
    let stride = dense::groups(problem.n);
    b.blocks.clear();
    b.jac.clear();
    b.d.clear();
    b.r.clear();
    b.loss.clear();
    b.aref.clear();
    for &index in blocks {
        let block = &efc.blocks[index];
        b.blocks.push(Block {
            row: b.d.len(),
            groups: stride,
            ..block.clone()
        });
        for row in block.row..block.row + block.rows {
            let from = efc.jacobian()[row * efc.stride()..(row + 1) * efc.stride()].as_flattened();
            let start = b.jac.len();
            b.jac.resize(start + stride, [0.0; 4]);
            let to = b.jac[start..].as_flattened_mut();
            for (dofs, place) in problem.places() {
                to[place].copy_from_slice(&from[dofs]);
            }
        }
        let rows = block.row..block.row + block.rows;
        b.d.extend_from_slice(&efc.d[rows.clone()]);
        if problem.row_costs.is_some() {
            b.r.extend_from_slice(&efc.r[rows.clone()]);
            let loss = |row: usize| efc.loss.get(row).copied().unwrap_or(0.0);
            b.loss.extend(rows.clone().map(loss));
        }
        b.aref.extend_from_slice(&efc.aref[rows]);
    }
}

/// Solves one island: MuJoCo's `mj_solPrimal`. Writes the island's accelerations and constraint
/// forces, and returns the number of iterations. The rows' forces are in `b.force`.
#[inline(always)]
fn solve_island(
    problem: &Problem<'_>,
    b: &mut Buffers,
    (qacc, qfrc_constraint): (&mut [f64], &mut [f64]),
    whole: bool,
) -> usize {
    let (m, n, nefc) = (problem.m, problem.n, problem.d.len());
    b.fit(n);
    let mut inertia = 0.0;
    for (dofs, place) in problem.places() {
        b.acc.as_flattened_mut()[place.clone()].copy_from_slice(&qacc[dofs.clone()]);
        b.ma.as_flattened_mut()[place.clone()].copy_from_slice(&b.ma_start[dofs.clone()]);
        b.smooth.as_flattened_mut()[place].copy_from_slice(&problem.qfrc_smooth[dofs.clone()]);
        for i in dofs {
            inertia += problem.qm[m.plan().m_diagonal(i)];
        }
    }
    let (scale, tolerance) = (1.0 / inertia, m.opt.tolerance);
    if problem.cold {
        problem.mul_m(&mut b.way, &b.acc, &mut b.ma);
    }
    if !whole {
        b.jar.resize(nefc, 0.0);
        problem.mul_jacobian(&b.sparse, &b.acc, &mut b.jar);
        let residuals = b.jar.iter_mut().zip(problem.aref);
        residuals.for_each(|(jar, aref)| *jar -= aref);
    }
    b.jv.resize(nefc, 0.0);
    b.force.resize(nefc, 0.0);
    b.pushes.clear();
    b.pushes.extend(b.jar.iter().map(|jar| *jar < 0.0));
    b.states.resize(nefc, State::Satisfied);
    let iterations = if m.opt.solver == Solver::CG {
        conjugate::iterate(problem, b, scale, tolerance)
    } else {
        iterate(problem, b, scale, tolerance)
    };
    for (dofs, place) in problem.places() {
        qacc[dofs.clone()].copy_from_slice(&b.acc.as_flattened()[place.clone()]);
        qfrc_constraint[dofs].copy_from_slice(&b.constraint.as_flattened()[place]);
    }
    iterations
}

/// Returns [`dense::dot`]. The function is not inlined, so that all callers share one copy of the
/// code.
#[inline(never)]
pub(super) fn dot(a: &[Lanes], b: &[Lanes], n: usize) -> f64 {
    dense::dot(a, b, n)
}

/// Returns the length of a vector of `n` elements: MuJoCo's `mju_norm`.
pub(super) fn norm(a: &[Lanes], n: usize) -> f64 {
    dot(a, a, n).sqrt()
}

/// Takes Newton steps, and returns their number. Each part is called from one place, so that the
/// compiler inlines each part once.
#[inline(always)]
fn iterate(problem: &Problem<'_>, b: &mut Buffers, scale: f64, tolerance: f64) -> usize {
    let (m, n) = (problem.m, problem.n);
    let decrement = |b: &Buffers| f64::max(0.0, 0.5 * scale * dot(&b.grad, &b.mgrad, n));
    let (mut iteration, mut improvement) = (0, 0.0);
    loop {
        update(problem, b);
        let level = scale * norm(&b.grad, n) < tolerance;
        if iteration > 0 && (level || (improvement > 0.0 && improvement < tolerance)) {
            return iteration;
        }
        if level {
            // half of the gradient's square, in the norm of `M^-1`, bounds the possible improvement
            b.mgrad.copy_from_slice(&b.grad);
            for (dofs, place) in problem.places() {
                let x = &mut b.mgrad.as_flattened_mut()[place];
                problem.solve_tree(&dofs, &mut b.way, x);
            }
            if decrement(b) < tolerance {
                return 0;
            }
        }
        if iteration == 0 && problem.row_costs.is_some() {
            let states = b.states.iter().zip(&mut b.pushes);
            states.for_each(|(state, pushes)| *pushes = *state == State::Quadratic);
        }
        if iteration == 0 || !update_hessian(problem, b) {
            hessian(problem, b);
        }
        b.mgrad.copy_from_slice(&b.grad);
        let coned = problem.row_costs.is_some() && !b.cones.is_empty();
        if coned {
            add_cones(problem, b);
        }
        if problem.sparse {
            b.sparse.solve(coned, n, &mut b.mgrad, m.revision);
        } else {
            let factor = if coned { &b.with_cones } else { &b.hessian };
            cholesky::solve(factor, n, problem.stride, &mut b.mgrad, m.revision);
        }
        if iteration == m.opt.iterations || ((level || iteration > 0) && decrement(b) < tolerance) {
            return iteration;
        }

        for (search, mgrad) in b.search.iter_mut().zip(&b.mgrad) {
            *search = times(*mgrad, -1.0);
        }
        let (alpha, gain) = search(problem, b, scale);
        if alpha == 0.0 {
            return iteration;
        }
        improvement = scale * gain;
        iteration += 1;
        add_scaled(&mut b.acc, &b.search, alpha);
        add_scaled(&mut b.ma, &b.mv, alpha);
        for (jar, jv) in b.jar.iter_mut().zip(&b.jv) {
            *jar += jv * alpha;
        }
    }
}

/// Computes the rows' forces, the resulting forces on the joints, and the gradient: MuJoCo's
/// `PrimalUpdateConstraint` and `PrimalUpdateGrad`.
#[inline(always)]
pub(super) fn update(problem: &Problem<'_>, b: &mut Buffers) {
    b.terms.clear();
    if let Some(row_costs) = &problem.row_costs {
        row_costs.update(&b.jar, &mut b.force, &mut b.states, &mut b.cones);
        let forces = b.force.iter().enumerate();
        let forces = forces.filter(|(_, force)| **force != 0.0);
        b.terms
            .extend(forces.map(|(row, force)| (row * problem.stride, *force)));
    } else {
        for (row, ((force, &jar), &stiffness)) in
            b.force.iter_mut().zip(&b.jar).zip(problem.d).enumerate()
        {
            *force = if jar < 0.0 { -stiffness * jar } else { 0.0 };
            if *force != 0.0 {
                b.terms.push((row * problem.stride, *force));
            }
        }
    }
    if problem.sparse {
        b.sparse.apply(&b.force, &mut b.constraint);
    } else {
        combine(
            &mut b.constraint,
            problem.jac,
            b.terms.len(),
            #[inline(always)]
            |index| b.terms[index],
        );
    }
    for (((grad, ma), smooth), constraint) in b
        .grad
        .iter_mut()
        .zip(&b.ma)
        .zip(&b.smooth)
        .zip(&b.constraint)
    {
        *grad = minus(minus(*ma, *smooth, 1.0), *constraint, 1.0);
    }
}

/// Builds and factors the Hessian of the cost, `M + J' D J` over the rows that push: MuJoCo's
/// `MakeHessian`.
#[inline(always)]
fn hessian(problem: &Problem<'_>, b: &mut Buffers) {
    let (n, stride, plan) = (problem.n, problem.stride, problem.m.plan());
    if problem.sparse {
        b.sparse.factor(problem, &b.pushes);
        return;
    }
    // the Jacobians of the rows that push, and these Jacobians times the rows' stiffness
    b.pushing.clear();
    b.pushed.clear();
    for (row, (&pushes, &stiffness)) in b.pushes.iter().zip(problem.d).enumerate() {
        if pushes && stiffness != 0.0 {
            let jac = problem.row(row);
            b.pushing.extend_from_slice(jac);
            b.pushed
                .extend(jac.iter().map(|&four| times(four, stiffness)));
        }
    }
    b.hessian.resize(n * stride, [0.0; 4]);
    let (pushing, pushed) = (b.pushing.as_flattened(), &b.pushed[..]);
    let count = pushed.len() / stride;
    for (i, column) in b.hessian.chunks_exact_mut(stride).enumerate() {
        let first = i / 4;
        combine(
            &mut column[first..],
            pushed,
            count,
            #[inline(always)]
            |index| (index * stride + first, pushing[index * 4 * stride + i]),
        );
    }
    // as in MuJoCo, add the inertia matrix last
    let hessian = b.hessian.as_flattened_mut();
    for (dofs, place) in problem.places() {
        for (dof, row) in dofs.zip(place.clone()) {
            let known = plan.m_row(dof);
            for (&column, value) in plan.m_local[known.clone()].iter().zip(&problem.qm[known]) {
                hessian[(place.start + column) * 4 * stride + row] += value;
            }
        }
    }
    cholesky::factor(&mut b.hessian, n, stride);
}

/// Updates the factor of the Hessian for the rows that began or ceased to push: MuJoCo's
/// `HessianIncremental`. Returns false if the Hessian must be factored again.
#[inline(always)]
fn update_hessian(problem: &Problem<'_>, b: &mut Buffers) -> bool {
    let mut definite = true;
    b.updates.clear();
    b.adds.clear();
    let general = problem.row_costs.is_some();
    let rows = b.pushes.iter_mut().zip(&b.jar).zip(&b.states);
    for (row, ((known, jar), state)) in rows.enumerate() {
        let pushes = if general {
            *state == State::Quadratic
        } else {
            *jar < 0.0
        };
        if pushes == *known {
            continue;
        }
        *known = pushes;
        let root = problem.d[row].sqrt();
        if problem.sparse {
            definite = definite && b.sparse.update(row, root, pushes, problem.m.revision);
            continue;
        }
        let jac = problem.row(row).iter();
        b.updates.extend(jac.map(|jac| times(*jac, root)));
        b.adds.push(pushes);
    }
    let (n, stride) = (problem.n, problem.stride);
    if problem.sparse || b.adds.is_empty() {
        return definite;
    }
    cholesky::update(&mut b.hessian, n, stride, &mut b.updates, &b.adds)
}

/// Computes the factor of the Hessian with the second derivatives of the cones: MuJoCo's
/// `HessianCone`.
#[inline(always)]
fn add_cones(problem: &Problem<'_>, b: &mut Buffers) {
    if problem.sparse {
        let cones = b.cones.iter();
        let local = cones.map(|cone| (cone.row, cone.dim, local_factor(cone)));
        return b.sparse.add_cones(local);
    }
    b.with_cones.clear();
    b.with_cones.extend_from_slice(&b.hessian);
    let (n, stride) = (problem.n, problem.stride);
    b.updates.clear();
    b.adds.clear();
    for cone in &b.cones {
        let local = local_factor(cone);
        for c in 0..cone.dim {
            let start = b.updates.len();
            b.updates.resize(start + stride, [0.0; 4]);
            for r in c..cone.dim {
                let jac = problem.row(cone.row + r);
                add_scaled(&mut b.updates[start..], jac, local[r][c]);
            }
            b.adds.push(true);
        }
    }
    cholesky::update(&mut b.with_cones, n, stride, &mut b.updates, &b.adds);
}

/// Returns the factor of a cone's second derivatives.
fn local_factor(cone: &ConeHessian) -> Matrix<f64> {
    let mut l = cone.matrix;
    match cone.dim {
        3 => factor((), 3, &mut l),
        dim => factor((), dim, &mut l),
    }
    l
}

/// Returns the step length along the search direction, and the improvement. Stores `M search` and
/// `J search` in `b`.
#[inline(always)]
pub(super) fn search(problem: &Problem<'_>, b: &mut Buffers, scale: f64) -> (f64, f64) {
    let (opt, n) = (&problem.m.opt, problem.n);
    let length = norm(&b.search, n);
    if length < MINVAL {
        return (0.0, 0.0);
    }
    problem.mul_m(&mut b.way, &b.search, &mut b.mv);
    problem.mul_jacobian(&b.sparse, &b.search, &mut b.jv);
    b.rows.clear();
    match &problem.row_costs {
        Some(row_costs) => row_costs.prepare(&b.jar, &b.jv, &mut b.course),
        None => b.rows.extend(
            b.jar
                .iter()
                .zip(&b.jv)
                .zip(problem.d)
                .map(|((&jar, &jv), &d)| Row::new(jar, jv, d)),
        ),
    }
    let along = Along {
        rows: &b.rows,
        course: problem.row_costs.is_some().then_some(&b.course),
        linear: dot(&b.search, &b.ma, n) - dot(&b.smooth, &b.search, n),
        quadratic: 0.5 * dot(&b.search, &b.mv, n),
        evaluations: 0,
    };
    let flat = opt.tolerance * opt.ls_tolerance * length / scale;
    line_search(along, flat, opt.ls_iterations)
}
