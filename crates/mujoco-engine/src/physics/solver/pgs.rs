//! Projected Gauss-Seidel on forces, with momentum and in random order, as in MuJoCo.
//!
//! The solver stops long before it converges, so its result depends on the order of the rows and on
//! the number of iterations. This module repeats both exactly.

use super::dual::{self, Unit};
use std::ops::Range;

use super::orders::Pcg32;
use super::row_costs::{RowCosts, State};
use super::sweep::{Momentum, Step, pushing};
use super::{add_forces, dense, residuals};
use crate::math::dense::{Lanes, add_scaled, dot, times};
use crate::model::{Bounds, Disable, Solver};
use crate::physics::constraint::Block;
use crate::physics::inertia;
use crate::{Data, Model};

/// Buffers of the solver: vectors over all rows, and over an island's rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    /// `(J L^-1 D^-1/2)'`: for each degree of freedom, its elements in every row.
    half: Vec<Lanes>,
    /// `J M^-1 J' + R`, row by row: MuJoCo's `efc_AR`.
    pub(super) ar: Vec<Lanes>,
    /// The terms of a row of `ar`: for each, the index at which a row of `half` starts, and its
    /// factor.
    terms: Vec<(usize, f64)>,
    /// The indices at which the nonzero rows of `half` start, in descending order.
    moving: Vec<usize>,
    pub(super) coupled: Coupled,
    jar: Vec<f64>,
    pub(super) force: Vec<Lanes>,
    product: Vec<Lanes>,
    /// The rows of an island. The vectors below have the same order.
    pub(super) rows: Vec<usize>,
    steps: Vec<Step>,
    pub(super) units: Vec<Unit>,
    pub(super) before: Vec<f64>,
    pub(super) momentum: Vec<f64>,
    pub(super) order: Vec<u32>,
    next_order: Vec<u32>,
}

impl Buffers {
    /// Allocates the buffers, which are empty if the model has another solver.
    pub(crate) fn new(m: &Model, bounds: &Bounds) -> Self {
        let (nv, mut buffers) = (m.nv(), Self::default());
        if m.opt.solver != Solver::PGS && m.opt.noslip_iterations == 0 {
            return buffers;
        }
        // the matrix of all rows has the square of their number, and grows beyond this
        const MOST: usize = 1000;
        let rows = bounds.rows.min(MOST);
        let groups = dense::groups(rows);
        buffers.half.reserve(nv * groups);
        buffers.ar.reserve(rows * groups);
        buffers.force.reserve(groups);
        buffers.product.reserve(groups);
        if m.plan().sparse {
            buffers.coupled.rows.reserve(bounds.blocks * rows);
            buffers.coupled.ranges.reserve(rows);
            buffers.coupled.trees.reserve(m.ntree());
        }
        buffers.rows.reserve(rows);
        buffers.terms.reserve(nv);
        buffers.moving.reserve(nv);
        buffers.steps.reserve(rows);
        if !m.plan().inequalities_only {
            buffers.units.reserve(rows);
        }
        for order in [&mut buffers.order, &mut buffers.next_order] {
            order.reserve(rows);
        }
        for vector in [&mut buffers.jar, &mut buffers.before, &mut buffers.momentum] {
            vector.reserve(rows);
        }
        buffers
    }
}

#[cfg(test)]
impl Buffers {
    pub(crate) fn poison(&mut self) {
        use crate::physics::work::Poison;
        for vector in [
            &mut self.half,
            &mut self.ar,
            &mut self.force,
            &mut self.product,
        ] {
            vector.poison();
        }
        for vector in [&mut self.jar, &mut self.before, &mut self.momentum] {
            vector.poison();
        }
    }
}

/// Solves all islands: MuJoCo's `mj_solPGS_island`.
#[inline(always)]
pub(super) fn solve(m: &Model, d: &mut Data) {
    let mut s = std::mem::take(&mut d.work.pgs);
    let nefc = d.efc.nefc();
    project(m, d, &mut s);

    // start at the forces that the last step's accelerations cause, unless zero forces have a lower
    // cost
    s.jar.resize(nefc, 0.0);
    residuals(m, &d.efc, &d.qacc_warmstart, &mut d.work.dofs, &mut s.jar);
    let stride = dense::groups(nefc);
    for vector in [&mut s.force, &mut s.product] {
        vector.clear();
        vector.resize(stride, [0.0; 4]);
    }
    let force = s.force.as_flattened_mut();
    if m.plan().inequalities_only {
        for ((force, &jar), d) in force.iter_mut().zip(&s.jar).zip(&d.efc.d) {
            *force = if jar < 0.0 { -d * jar } else { 0.0 };
        }
    } else {
        let (efc, b) = (&d.efc, &mut d.work.newton);
        b.states.resize(nefc, State::Satisfied);
        let row_costs = RowCosts {
            blocks: &efc.blocks,
            d: &efc.d,
            r: &efc.r,
            loss: &efc.loss,
            contacts: &d.contact,
            revision: m.revision,
        };
        row_costs.update(&s.jar, &mut force[..nefc], &mut b.states, &mut b.cones);
    }
    let products = s.product.as_flattened_mut().iter_mut();
    for (i, (product, row)) in products.zip(s.ar.chunks_exact(stride)).enumerate() {
        *product = product_of(row, &s.force, nefc, s.coupled.of(i));
    }
    // compare the cost of `force` with the cost of zero forces, which is 0
    let half_square = 0.5 * dot(&s.force, &s.product, nefc);
    dense::put(&mut s.product, &d.efc.b);
    let cold = m.opt.disables(Disable::WarmStart);
    if cold || dot(&s.force, &s.product, nefc) + half_square > 0.0 {
        s.force.fill([0.0; 4]);
    }

    let islands = std::mem::take(&mut d.work.islands);
    for island in &islands {
        s.rows.clear();
        let blocks = &d.work.island_blocks[island.blocks.clone()];
        for &index in blocks {
            let block = &d.efc.blocks[index];
            s.rows.extend(block.row..block.row + block.rows);
        }
        let trees = &d.work.island_trees[island.trees.clone()];
        let scale = 1.0 / inertia_of(m, d, trees);
        let iterations = if m.plan().inequalities_only {
            iterate(m, d, &mut s, scale)
        } else {
            dual::iterate(m, d, &mut s, blocks, scale)
        };
        d.solver_niter.push(iterations);
    }
    d.work.islands = islands;
    d.efc.force.copy_from_slice(&s.force.as_flattened()[..nefc]);
    d.work.pgs = s;
    finish(m, d);
}

/// Computes `qfrc_constraint` and `qacc` from the rows' forces: MuJoCo's `mj_dualFinish`.
#[inline(always)]
pub(super) fn finish(m: &Model, d: &mut Data) {
    add_forces(m, d);
    d.qacc.copy_from_slice(&d.qfrc_constraint);
    let (inverses, way) = (&d.qld_diag_inv, &mut d.work.way);
    inertia::solve(m, &d.qld, inverses, way, &mut d.qacc);
    for (a, smooth) in d.qacc.iter_mut().zip(&d.qacc_smooth) {
        *a += smooth;
    }
}

/// Returns the product of a row of `ar` with the rows' forces.
#[inline(always)]
pub(super) fn product_of(
    row: &[Lanes],
    force: &[Lanes],
    nefc: usize,
    coupled: Option<&[usize]>,
) -> f64 {
    match coupled {
        None => dot(row, force, nefc),
        Some(rows) => dense::dot_at(row.as_flattened(), force.as_flattened(), rows),
    }
}

/// For each row, the rows that act on the same trees, if the model is sparse: sums over rows leave
/// out the others.
#[derive(Clone, Debug, Default)]
pub(super) struct Coupled {
    rows: Vec<usize>,
    ranges: Vec<Range<usize>>,
    /// A buffer: the last block that acts on each tree.
    trees: Vec<usize>,
}

impl Coupled {
    pub(super) fn of(&self, row: usize) -> Option<&[usize]> {
        let range = self.ranges.get(row)?;
        Some(&self.rows[range.clone()])
    }

    fn list(&mut self, m: &Model, d: &Data) {
        self.rows.clear();
        self.ranges.clear();
        if !d.efc.sparse {
            return;
        }
        self.trees.clear();
        self.trees.resize(m.ntree(), usize::MAX);
        let columns = |block: &Block| d.efc.columns[block.columns.clone()].iter();
        for (index, block) in d.efc.blocks.iter().enumerate() {
            for &dof in columns(block) {
                self.trees[m.dof_treeid[dof]] = index;
            }
            let start = self.rows.len();
            for other in &d.efc.blocks {
                if columns(other).any(|&dof| self.trees[m.dof_treeid[dof]] == index) {
                    self.rows.extend(other.row..other.row + other.rows);
                }
            }
            let range = start..self.rows.len();
            self.ranges.extend(std::iter::repeat_n(range, block.rows));
        }
    }
}

/// Computes `J M^-1 J' + R`: MuJoCo's `mj_projectConstraint`.
#[inline(always)]
pub(super) fn project(m: &Model, d: &Data, s: &mut Buffers) {
    let (plan, nv, nefc) = (m.plan(), m.nv(), d.efc.nefc());
    let stride = dense::groups(nefc);
    s.half.clear();
    s.half.resize(nv * stride, [0.0; 4]);
    let width = 4 * d.efc.stride();
    for (g, rows) in d
        .efc
        .jacobian()
        .as_flattened()
        .chunks(4 * width)
        .enumerate()
    {
        if rows.len() == 4 * width {
            let (first, last) = rows.split_at(2 * width);
            let ((a, b), (c, e)) = (first.split_at(width), last.split_at(width));
            let elements = a.iter().zip(b).zip(c.iter().zip(e));
            for (half, ((a, b), (c, e))) in s.half.chunks_exact_mut(stride).zip(elements) {
                half[g] = [*a, *b, *c, *e];
            }
        } else {
            for (k, row) in rows.chunks_exact(width).enumerate() {
                for (half, x) in s.half.chunks_exact_mut(stride).zip(row) {
                    half[g][k] = *x;
                }
            }
        }
    }
    // from the last degree of freedom to the first, without those that no row depends on
    s.moving.clear();
    for i in (0..nv).rev() {
        let (above, rest) = s.half.split_at_mut(i * stride);
        let own = &mut rest[..stride];
        if !dense::any(own) {
            continue;
        }
        s.moving.push(i * stride);
        if m.dof_simplenum[i] == 0 {
            let row = plan.m_ancestors(i);
            for (&j, l) in plan.m_colind[row.clone()].iter().zip(&d.qld[row]) {
                add_scaled(&mut above[j * stride..(j + 1) * stride], own, -l);
            }
        }
        // `qld` has D on its diagonal (not the inverse of D)
        let scale = 1.0 / d.qld[plan.m_diagonal(i)].sqrt();
        own.iter_mut()
            .for_each(|group| *group = times(*group, scale));
    }

    s.coupled.list(m, d);
    s.ar.resize(nefc * stride, [0.0; 4]);
    let (half, moving, terms) = (&s.half[..], &s.moving[..], &mut s.terms);
    for ((i, row), r) in s.ar.chunks_exact_mut(stride).enumerate().zip(&d.efc.r) {
        terms.clear();
        for &start in moving.iter().rev() {
            let x = half[start + i / 4][i % 4];
            if x != 0.0 {
                terms.push((start, x));
            }
        }
        let terms = &terms[..];
        dense::combine(
            row,
            half,
            terms.len(),
            #[inline(always)]
            |index| terms[index],
        );
        row[i / 4][i % 4] += r;
    }
}

/// Returns the inertia that scales an island's improvement. Up to MuJoCo 3.16, this is the inertia
/// of the model in the initial configuration; from 3.17 on, the inertia of the island in the
/// current configuration.
pub(super) fn inertia_of(m: &Model, d: &Data, trees: &[usize]) -> f64 {
    let plan = m.plan();
    if m.revision.stops_by_current_inertia() {
        let dofs = trees.iter().flat_map(|&tree| plan.trees[tree].clone());
        dofs.fold(0.0, |sum, i| sum + d.qm[plan.m_diagonal(i)])
    } else {
        m.stat.meaninertia * m.nv().max(1) as f64
    }
}

/// Updates the forces of an island until the solver stops. Returns the number of iterations.
#[inline(always)]
fn iterate(m: &Model, d: &Data, s: &mut Buffers, scale: f64) -> usize {
    let (n, nefc) = (s.rows.len(), d.efc.nefc());
    let stride = dense::groups(nefc);
    let rows = &s.rows;
    s.steps.clear();
    s.steps.extend(rows.iter().map(|&row| {
        let diagonal = s.ar[row * stride + row / 4][row % 4];
        Step::new(d.efc.b[row], diagonal)
    }));
    let mut generator = Pcg32::new();
    s.next_order.clear();
    s.next_order.extend(0..n as u32);
    generator.shuffle(&mut s.next_order);
    s.order.clear();
    s.order.resize(n, 0);
    for vector in [&mut s.before, &mut s.momentum] {
        vector.clear();
        vector.extend(rows.iter().map(|row| s.force.as_flattened()[*row]));
    }

    // use slices: otherwise the compiler loads the vectors' addresses again after each write to
    // `force`
    let (steps, ar) = (&s.steps[..n], &s.ar[..nefc * stride]);
    let force = &mut s.force[..stride];
    let (before, momentum) = (&mut s.before[..n], &mut s.momentum[..n]);
    let (order, next_order) = (&mut s.order[..n], &mut s.next_order[..n]);
    let (mut kept, coupled) = (Momentum::default(), &s.coupled);
    for iteration in 0..m.opt.iterations {
        let beta = kept.beta();
        let numbers = force.as_flattened_mut();
        for ((&row, before), momentum) in rows.iter().zip(&mut *before).zip(&mut *momentum) {
            let now = numbers[row];
            let mut start = now;
            if beta > 0.0 {
                start = pushing(now + beta * (now - *before));
                numbers[row] = start;
            }
            (*before, *momentum) = (now, start);
        }

        // draw the next order in this loop: each update waits for the previous update, which leaves
        // time on the CPU
        order.copy_from_slice(next_order);
        let mut improvement = 0.0;
        for (&i, next) in order.iter().zip((0..n).rev()) {
            let row = rows[i as usize];
            let ar = &ar[row * stride..][..stride];
            let product = product_of(ar, force, nefc, coupled.of(row));
            let old = force.as_flattened()[row];
            if let Some((new, change)) = steps[i as usize].update(product, old) {
                dense::set(force, row, new);
                improvement -= change;
            }
            if next > 0 {
                generator.swap(next_order, next);
            }
        }
        improvement *= scale;
        let numbers = force.as_flattened();
        let mut turned = 0.0;
        for ((&row, momentum), before) in rows.iter().zip(&*momentum).zip(&*before) {
            turned += (numbers[row] - momentum) * (momentum - before);
        }
        kept.end_sweep(turned);
        if improvement < m.opt.tolerance {
            return iteration + 1;
        }
    }
    m.opt.iterations
}
