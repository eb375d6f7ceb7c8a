//! Projected Gauss-Seidel on forces, with momentum and in random order, as MuJoCo 3.12.0 does it.
//!
//! It stops long before it converges. So order and number of iterations are part of the answer, and both are repeated.

use std::ops::Range;

use super::residuals;
use crate::model::{Bounds, Solver};
use crate::physics::constraint::Block;
use crate::physics::inertia;
use crate::{Data, Model};

/// Buffers of the solver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    /// `D^-1/2 L^-T J'` of normals and tangents, by block: nv numbers each.
    half: Vec<f64>,
    /// The degrees of freedom, by block, beyond which these numbers are zero.
    spans: Vec<Range<usize>>,
    /// Rows, by island; the vectors below have the same order.
    rows: Vec<usize>,
    /// `J M^-1 J' + R` of each island, row by row.
    ar: Vec<f64>,
    parts: Vec<Part>,
    b: Vec<f64>,
    force: Vec<f64>,
    before: Vec<f64>,
    momentum: Vec<f64>,
    residual: Vec<f64>,
    residual_before: Vec<f64>,
    diag_inv: Vec<f64>,
    order: Vec<u32>,
    jar: Vec<f64>,
    sqrt_diag_inv: Vec<f64>,
}

/// Where the rows of an island are, and the first element of its matrix.
#[derive(Clone, Debug)]
struct Part {
    rows: Range<usize>,
    ar: usize,
}

impl Buffers {
    /// Buffers that need not grow; for another solver they stay empty.
    pub(crate) fn new(solver: Solver, nv: usize, trees: usize, bounds: &Bounds) -> Self {
        let mut buffers = Self::default();
        if solver != Solver::PGS {
            return buffers;
        }
        let rows = bounds.rows;
        buffers.half.reserve(bounds.directions * nv);
        buffers.spans.reserve(bounds.blocks);
        buffers.rows.reserve(rows);
        buffers.ar.reserve(rows * rows);
        buffers.parts.reserve(trees);
        buffers.order.reserve(rows);
        for vector in [
            &mut buffers.b,
            &mut buffers.force,
            &mut buffers.before,
            &mut buffers.momentum,
            &mut buffers.residual,
            &mut buffers.residual_before,
            &mut buffers.diag_inv,
            &mut buffers.jar,
            &mut buffers.sqrt_diag_inv,
        ] {
            vector.reserve(rows.max(nv));
        }
        buffers
    }

    /// The dual cost of an island's forces.
    fn cost(&self, part: &Part) -> f64 {
        let n = part.rows.len();
        let force = &self.force[part.rows.clone()];
        let terms = part.rows.clone().enumerate().map(|(i, row)| {
            let ar = &self.ar[part.ar + i * n..part.ar + (i + 1) * n];
            self.force[row] * (self.b[row] + 0.5 * dot(ar, force))
        });
        terms.sum()
    }
}

/// Solves all islands: MuJoCo's `mj_solPGS`.
pub(super) fn solve(m: &Model, d: &mut Data) {
    let mut s = std::mem::take(&mut d.work.pgs);
    let (dofs, blocks) = (std::mem::take(&mut d.work.island_dofs), std::mem::take(&mut d.work.island_blocks));
    project(m, d, &mut s);

    // forces at the accelerations of the last step
    s.jar.resize(d.efc.nefc(), 0.0);
    residuals(d, &d.qacc_warmstart, &mut s.jar);
    for i in 0..d.efc.nefc() {
        d.efc.force[i] = if s.jar[i] < 0.0 { -d.efc.d[i] * s.jar[i] } else { 0.0 };
    }
    residuals(d, &d.qacc_smooth, &mut s.jar);

    let islands = std::mem::take(&mut d.work.islands);
    s.rows.clear();
    s.ar.clear();
    s.parts.clear();
    for island in &islands {
        gather(d, &mut s, &blocks[island.blocks.clone()]);
    }
    let cost: f64 = s.parts.iter().map(|part| s.cost(part)).sum();
    if cost > 0.0 {
        s.force.fill(0.0);
    }
    for index in 0..s.parts.len() {
        let iterations = iterate(m, &mut s, index);
        d.solver_niter.push(iterations);
    }
    for (&row, &force) in s.rows.iter().zip(&s.force) {
        d.efc.force[row] = force;
    }

    for index in 0..d.efc.blocks.len() {
        d.efc.add_jac_t(&d.efc.blocks[index], &d.efc.force, &mut d.qfrc_constraint);
    }
    d.qacc.copy_from_slice(&d.qfrc_constraint);
    inertia::solve(m, &d.qld, &d.qld_diag_inv, &mut d.qacc);
    for (a, smooth) in d.qacc.iter_mut().zip(&d.qacc_smooth) {
        *a += smooth;
    }
    (d.work.island_dofs, d.work.island_blocks, d.work.islands) = (dofs, blocks, islands);
    d.work.pgs = s;
}

/// `D^-1/2 L^-T J'`, whose products with itself are `J M^-1 J'`: the first half of MuJoCo's `mj_projectConstraint`.
fn project(m: &Model, d: &Data, s: &mut Buffers) {
    let (plan, nv) = (m.plan(), m.nv());
    s.sqrt_diag_inv.clear();
    s.sqrt_diag_inv.extend(d.qld_diag_inv.iter().map(|x| x.sqrt()));
    s.half.clear();
    s.spans.clear();
    for block in &d.efc.blocks {
        let (columns, jac) = d.efc.jacobian(block);
        let span = match (columns.first(), columns.last()) {
            (Some(&first), Some(&last)) => plan.trees[m.dof_treeid[first]].start..last + 1,
            _ => 0..0,
        };
        for k in 0..block.dim {
            let start = s.half.len();
            s.half.resize(start + nv, 0.0);
            let x = &mut s.half[start..];
            for (&c, &j) in columns.iter().zip(&jac[k * block.width..]) {
                x[c] = j;
            }
            for i in span.clone().rev() {
                let xi = x[i];
                if xi != 0.0 {
                    let (start, end) = (plan.m_rowadr[i], plan.m_rowadr[i + 1] - 1);
                    for (&j, l) in plan.m_colind[start..end].iter().zip(&d.qld[start..end]) {
                        x[j] -= l * xi;
                    }
                    x[i] = xi * s.sqrt_diag_inv[i];
                }
            }
        }
        s.spans.push(span);
    }
}

/// Appends the rows of an island, with their matrix, `b` and forces.
fn gather(d: &Data, s: &mut Buffers, blocks: &[usize]) {
    let nv = d.qacc.len();
    let (start, ar_start) = (s.rows.len(), s.ar.len());
    for &index in blocks {
        let block = &d.efc.blocks[index];
        s.rows.extend(block.row..block.row + block.rows());
    }
    let n = s.rows.len() - start;
    s.ar.resize(ar_start + n * n, 0.0);
    let ar = &mut s.ar[ar_start..];
    let half = |block: &Block, k: usize, span: &Range<usize>| {
        let start = (block.direction + k) * nv;
        &s.half[start + span.start..start + span.end]
    };
    let mut first = 0;
    for (index, &i) in blocks.iter().enumerate() {
        let a = &d.efc.blocks[i];
        let mut second = 0;
        for &j in &blocks[..=index] {
            let b = &d.efc.blocks[j];
            let (low, high) = (s.spans[i].start.max(s.spans[j].start), s.spans[i].end.min(s.spans[j].end));
            let shared = low..high.max(low);
            // products of normals and tangents, then of the rows of both pyramids
            let mut partial = [[0.0; 3]; 4];
            for k in 0..b.dim {
                let b_half = half(b, k, &shared);
                let along = [0, 1, 2].map(|i| if i < a.dim { dot(half(a, i, &shared), b_half) } else { 0.0 });
                for (partial, value) in partial.iter_mut().zip(pyramid(a, along)) {
                    partial[k] = value;
                }
            }
            for (r, along) in partial[..a.rows()].iter().enumerate() {
                for (c, value) in pyramid(b, *along)[..b.rows()].iter().enumerate() {
                    ar[(first + r) * n + second + c] = *value;
                    ar[(second + c) * n + first + r] = *value;
                }
            }
            second += b.rows();
        }
        first += a.rows();
    }
    s.b.resize(start + n, 0.0);
    s.force.resize(start + n, 0.0);
    for (i, &row) in s.rows[start..].iter().enumerate() {
        ar[i * n + i] += d.efc.r[row];
        s.b[start + i] = s.jar[row];
        s.force[start + i] = d.efc.force[row];
    }
    s.parts.push(Part { rows: start..start + n, ar: ar_start });
}

/// The rows of a block from what happens along its normal and tangents.
fn pyramid(block: &Block, [n, t1, t2]: [f64; 3]) -> [f64; 4] {
    let (t1, t2) = (block.mu * t1, block.mu * t2);
    if block.dim == 1 { [n, 0.0, 0.0, 0.0] } else { [n + t1, n - t1, n + t2, n - t2] }
}

/// MuJoCo's generator of the order: PCG32.
struct Pcg32(u64);

impl Pcg32 {
    fn next(&mut self) -> u32 {
        let old = self.0;
        self.0 = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let shifted = (((old >> 18) ^ old) >> 27) as u32;
        shifted.rotate_right((old >> 59) as u32)
    }
}

/// Iterates on the forces of an island; the number of iterations.
fn iterate(m: &Model, s: &mut Buffers, part: usize) -> usize {
    let Part { rows, ar } = s.parts[part].clone();
    let n = rows.len();
    let ar = &s.ar[ar..ar + n * n];
    let (b, force) = (&s.b[rows.clone()], &mut s.force[rows]);
    let scale = 1.0 / (m.stat.meaninertia * m.nv().max(1) as f64);
    let mut generator = Pcg32(0);
    generator.next();
    s.order.clear();
    s.order.extend(0..n as u32);
    s.before.clear();
    s.before.extend_from_slice(force);
    s.diag_inv.clear();
    s.diag_inv.extend((0..n).map(|i| 1.0 / ar[i * n + i]));
    // residuals `b + AR f`, kept up to date; the matrix is symmetric
    s.residual.clear();
    s.residual.extend((0..n).map(|i| b[i] + dot(&ar[i * n..(i + 1) * n], force)));
    s.residual_before.clone_from(&s.residual);

    let mut k = 0.0;
    for iteration in 0..m.opt.iterations {
        let beta = if iteration > 0 { (k - 1.0) / (k + 2.0) } else { 0.0 };
        if beta > 0.0 {
            for (residual, before) in s.residual.iter_mut().zip(&mut s.residual_before) {
                let now = *residual;
                *residual = now + beta * (now - *before);
                *before = now;
            }
            for i in 0..n {
                let now = force[i];
                let moved = now + beta * (now - s.before[i]);
                s.before[i] = now;
                force[i] = moved.max(0.0);
                if moved < 0.0 {
                    add_scaled(&mut s.residual, &ar[i * n..(i + 1) * n], -moved);
                }
            }
        } else {
            s.before.copy_from_slice(force);
            s.residual_before.copy_from_slice(&s.residual);
        }
        s.momentum.clear();
        s.momentum.extend_from_slice(force);

        for i in (1..n).rev() {
            s.order.swap(i, (generator.next() % (i as u32 + 1)) as usize);
        }
        let mut improvement = 0.0;
        for &i in &s.order {
            let i = i as usize;
            let (residual, old) = (s.residual[i], force[i]);
            let new = (old - residual * s.diag_inv[i]).max(0.0);
            let delta = new - old;
            if delta == 0.0 {
                continue;
            }
            let row = &ar[i * n..(i + 1) * n];
            let change = 0.5 * delta * delta * row[i] + delta * residual;
            if change <= 1e-10 {
                force[i] = new;
                improvement -= change;
                add_scaled(&mut s.residual, row, delta);
            }
        }
        let turned: f64 =
            force.iter().zip(&s.momentum).zip(&s.before).map(|((f, m), p)| (f - m) * (m - p)).sum();
        k = if iteration > 0 && turned < 0.0 { 0.0 } else { k + 1.0 };
        if improvement * scale < m.opt.tolerance {
            return iteration + 1;
        }
    }
    m.opt.iterations
}

/// `a += s b`.
fn add_scaled(a: &mut [f64], b: &[f64], s: f64) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += s * b;
    }
}

/// The product of two vectors.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}
