//! Projected Gauss-Seidel for models with equality constraints, dry friction or elliptic cones.
//! [`noslip`](super::noslip) uses the same updates of the rows' forces.

use super::orders::Pcg32;
use super::pgs::{Buffers, product_of};
use super::qcqp;
use super::sweep::{Momentum, pushing};
use crate::math::dense::{self, dot_slices};
use crate::math::spatial::MINVAL;
use crate::physics::constraint::{Block, Kind, Source};
use crate::{Data, Model, Revision};

/// The largest number of rows of a cone.
const MOST: usize = 6;

/// The forces of all rows, and the matrix `J M^-1 J' + R`, by which the forces of rows affect one
/// another.
pub(super) struct Rows<'a> {
    pub(super) d: &'a Data,
    pub(super) s: &'a mut Buffers,
    pub(super) revision: Revision,
}

impl Rows<'_> {
    pub(super) fn force(&self, row: usize) -> f64 {
        self.s.force.as_flattened()[row]
    }

    pub(super) fn forces(&self, first: usize, n: usize) -> [f64; MOST] {
        std::array::from_fn(|k| if k < n { self.force(first + k) } else { 0.0 })
    }

    fn set(&mut self, row: usize, force: f64) {
        dense::set(&mut self.s.force, row, force);
    }

    pub(super) fn element(&self, i: usize, j: usize) -> f64 {
        let stride = dense::groups(self.d.efc.nefc());
        self.s.ar[i * stride + j / 4][j % 4]
    }

    /// Returns the part of the matrix for the `n` rows from `first` on.
    pub(super) fn block(&self, first: usize, n: usize) -> [f64; MOST * MOST] {
        let mut a = [0.0; MOST * MOST];
        for (k, a) in a[..n * n].iter_mut().enumerate() {
            *a = self.element(first + k / n, first + k % n);
        }
        a
    }

    pub(super) fn residual(&self, row: usize) -> f64 {
        let (nefc, stride) = (self.d.efc.nefc(), dense::groups(self.d.efc.nefc()));
        let ar = &self.s.ar[row * stride..(row + 1) * stride];
        self.d.efc.b[row] + product_of(ar, &self.s.force, nefc, self.s.coupled.of(row))
    }

    /// Sets the forces of the rows from `first` on to `force`, unless the cost would grow. Returns
    /// the change of the cost.
    pub(super) fn take(
        &mut self,
        first: usize,
        old: &[f64],
        residual: &[f64],
        a: &[f64],
        force: &[f64],
    ) -> f64 {
        let n = old.len();
        let mut delta = [0.0; MOST];
        for (delta, (force, old)) in delta.iter_mut().zip(force.iter().zip(old)) {
            *delta = force - old;
        }
        let delta = &delta[..n];
        let mut square = 0.0;
        for (delta_k, row) in delta.iter().zip(a.chunks(n)) {
            square += delta_k * dot_slices(row, delta);
        }
        let change = 0.5 * square + dot_slices(delta, residual);
        if change > 1e-10 {
            return 0.0;
        }
        for (k, force) in force[..n].iter().enumerate() {
            self.set(first + k, *force);
        }
        change
    }

    /// Updates the force of the single row of `unit`. Returns the change of the cost.
    fn single(&mut self, unit: &Unit) -> f64 {
        let (row, old) = (unit.row, self.force(unit.row));
        let (residual, inverse) = (self.residual(row), 1.0 / self.element(row, row));
        let force = unit.bounded(self.d, old - residual * inverse);
        let delta = force - old;
        let change = 0.5 * delta * delta * (1.0 / inverse) + delta * residual;
        if change > 1e-10 {
            return 0.0;
        }
        self.set(row, force);
        change
    }

    /// Updates the forces of a cone: scales all forces along their common direction, then solves
    /// for the friction. Returns the change of the cost.
    fn cone(&mut self, row: usize, dim: usize, mu: &[f64; 5]) -> f64 {
        let (old, a) = (self.forces(row, dim), self.block(row, dim));
        let mut residual = [0.0; MOST];
        for (k, residual) in residual[..dim].iter_mut().enumerate() {
            *residual = self.residual(row + k);
        }
        let (before, residual, a) = (&old[..dim], &residual[..dim], &a[..dim * dim]);
        let mut force = old;
        if old[0] < MINVAL {
            let moved = old[0] - residual[0] * (1.0 / a[0]);
            force = [0.0; MOST];
            force[0] = pushing(moved);
        } else {
            let mut product = [0.0; MOST];
            for (product, row) in product.iter_mut().zip(a.chunks(dim)) {
                *product = dot_slices(row, before);
            }
            let square = dot_slices(before, &product[..dim]);
            if square >= MINVAL {
                let mut step = -dot_slices(before, residual) / square;
                if force[0] + step * old[0] < 0.0 {
                    step = -old[0] / force[0];
                }
                for (force, old) in force.iter_mut().zip(before) {
                    *force += step * old;
                }
            }
        }
        let n = dim - 1;
        let (mut sliding, mut rest) = ([0.0; 25], [0.0; 5]);
        for (j, rest) in rest[..n].iter_mut().enumerate() {
            let row = &a[(j + 1) * dim..][..dim];
            sliding[j * n..][..n].copy_from_slice(&row[1..]);
            *rest = residual[j + 1] - dot_slices(&row[1..], &before[1..]);
            *rest += row[0] * (force[0] - old[0]);
        }
        if force[0] < MINVAL {
            force[1..].fill(0.0);
        } else {
            let a = &sliding[..n * n];
            qcqp::friction(&mut force[..dim], a, &rest[..n], mu, self.revision);
        }
        self.take(row, before, residual, a, &force[..dim])
    }
}

/// Rows that are updated together: a single row, or all rows of an elliptic cone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unit {
    row: usize,
    rows: usize,
    kind: Kind,
    source: Source,
}

impl Unit {
    pub(super) fn of(block: &Block) -> impl Iterator<Item = Self> + '_ {
        let (count, rows) = match block.kind {
            Kind::Cone => (1, block.rows),
            _ => (block.rows, 1),
        };
        (0..count).map(move |k| Self {
            row: block.row + k,
            rows,
            kind: block.kind,
            source: block.source,
        })
    }

    /// Returns `force`, clamped to the possible forces of the row.
    fn bounded(&self, d: &Data, force: f64) -> f64 {
        match self.kind {
            Kind::Equality => force,
            Kind::Friction => {
                let loss = d.efc.loss[self.row];
                force.clamp(-loss, loss)
            }
            _ => pushing(force),
        }
    }

    /// Returns the coefficients of friction of a cone.
    fn friction<'a>(&self, d: &'a Data) -> Option<&'a [f64; 5]> {
        match (self.kind, self.source) {
            (Kind::Cone, Source::Contact(id)) => Some(&d.contact[id].friction),
            _ => None,
        }
    }
}

/// Iterates on the forces of an island, given by its blocks: MuJoCo's `solPGS`. Returns the number
/// of iterations.
#[inline(never)]
pub(super) fn iterate(m: &Model, d: &Data, s: &mut Buffers, blocks: &[usize], scale: f64) -> usize {
    let mut units = std::mem::take(&mut s.units);
    units.clear();
    units.extend(blocks.iter().flat_map(|&b| Unit::of(&d.efc.blocks[b])));
    let mut order = std::mem::take(&mut s.order);
    order.clear();
    order.extend(0..units.len() as u32);
    for vector in [&mut s.before, &mut s.momentum] {
        vector.clear();
        vector.resize(s.rows.len(), 0.0);
    }
    let mut generator = Pcg32::new();
    let revision = m.revision;
    let mut rows = Rows { d, s, revision };
    let (mut momentum, mut iterations) = (Momentum::default(), 0);
    while iterations < m.opt.iterations {
        rows.extrapolate(&units, momentum.beta());
        generator.shuffle(&mut order);
        let mut improvement = 0.0;
        for unit in order.iter().map(|&i| &units[i as usize]) {
            improvement -= match unit.friction(d) {
                Some(mu) => rows.cone(unit.row, unit.rows, mu),
                None => rows.single(unit),
            };
        }
        improvement *= scale;
        momentum.end_sweep(rows.extrapolation_product());
        iterations += 1;
        if improvement < m.opt.tolerance {
            break;
        }
    }
    (s.units, s.order) = (units, order);
    iterations
}

impl Rows<'_> {
    /// Extrapolates the forces by `beta` times their last change.
    fn extrapolate(&mut self, units: &[Unit], beta: f64) {
        for c in 0..self.s.rows.len() {
            let row = self.s.rows[c];
            let now = self.force(row);
            if beta > 0.0 {
                self.set(row, now + beta * (now - self.s.before[c]));
            }
            self.s.before[c] = now;
        }
        if beta > 0.0 {
            for unit in units {
                let Some(mu) = unit.friction(self.d) else {
                    let force = unit.bounded(self.d, self.force(unit.row));
                    self.set(unit.row, force);
                    continue;
                };
                let mut forces = self.forces(unit.row, unit.rows);
                if forces[0] < 0.0 {
                    forces = [0.0; MOST];
                } else {
                    let normal = forces[0];
                    qcqp::limit(&mut forces[1..unit.rows], normal, mu);
                }
                for (k, force) in forces[..unit.rows].iter().enumerate() {
                    self.set(unit.row + k, *force);
                }
            }
        }
        for c in 0..self.s.rows.len() {
            self.s.momentum[c] = self.force(self.s.rows[c]);
        }
    }

    /// Returns the scalar product of the updates and of the extrapolation before the updates.
    fn extrapolation_product(&self) -> f64 {
        let s = &self.s;
        let parts = s.rows.iter().zip(&s.momentum).zip(&s.before);
        parts.fold(0.0, |sum, ((&row, momentum), before)| {
            sum + (self.force(row) - momentum) * (momentum - before)
        })
    }
}
