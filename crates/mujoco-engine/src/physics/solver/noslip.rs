//! MuJoCo's "noslip" iterations, which follow the solver and suppress slip. They change only
//! friction forces. They leave out the regularisation, because it lets contacts creep.

use super::dual::Rows;
use super::{pgs, qcqp};
use crate::math::dense::{self, dot_slices};
use crate::math::spatial::MINVAL;
use crate::physics::constraint::{Block, Kind, Source};
use crate::{Data, Model};

/// Corrects the forces of all islands: MuJoCo's `mj_solNoSlip`.
#[inline(never)]
pub(super) fn solve(m: &Model, d: &mut Data) {
    let mut s = std::mem::take(&mut d.work.pgs);
    let stride = dense::groups(d.efc.nefc());
    pgs::project(m, d, &mut s);
    s.force.clear();
    s.force.resize(stride, [0.0; 4]);
    dense::put(&mut s.force, &d.efc.force);
    let mut iterations = std::mem::take(&mut d.solver_niter);
    for (island, iterations) in d.work.islands.iter().zip(&mut iterations) {
        let trees = &d.work.island_trees[island.trees.clone()];
        let blocks = &d.work.island_blocks[island.blocks.clone()];
        let scale = 1.0 / pgs::inertia_of(m, d, trees);
        let own = blocks.iter().map(|&index| &d.efc.blocks[index]);
        let mut rows = Rows {
            d,
            s: &mut s,
            revision: m.revision,
        };
        *iterations += rows.prevent_slip(m, &own, scale);
    }
    d.solver_niter = iterations;
    let nefc = d.efc.nefc();
    d.efc.force.copy_from_slice(&s.force.as_flattened()[..nefc]);
    d.work.pgs = s;
    pgs::finish(m, d);
}

/// The cost of new forces of some rows as a quadratic form without regularisation, and the rows'
/// old forces.
struct QuadraticForm {
    old: [f64; 6],
    residual: [f64; 6],
    a: [f64; 36],
    /// The residuals without the rows' own forces.
    rest: [f64; 6],
}

impl Rows<'_> {
    fn prevent_slip<'b>(
        &mut self,
        m: &Model,
        blocks: &(impl Iterator<Item = &'b Block> + Clone),
        scale: f64,
    ) -> usize {
        for iteration in 0..m.opt.noslip_iterations {
            let mut improvement = 0.0;
            if iteration == 0 {
                for row in blocks
                    .clone()
                    .flat_map(|block| block.row..block.row + block.rows)
                {
                    let force = self.force(row);
                    improvement += 0.5 * force * force * self.d.efc.r[row];
                }
            }
            for block in blocks.clone() {
                match (block.kind, block.source) {
                    (Kind::Friction, _) => improvement -= self.dry_friction(block.row),
                    (Kind::OneSided, Source::Contact(_)) if block.rows > 1 => {
                        for row in (block.row..block.row + block.rows).step_by(2) {
                            improvement -= self.edges(row);
                        }
                    }
                    (Kind::Cone, Source::Contact(id)) => {
                        improvement -= self.slide(block, &self.d.contact[id].friction);
                    }
                    _ => {}
                }
            }
            improvement *= scale;
            if improvement < m.opt.noslip_tolerance {
                return iteration + 1;
            }
        }
        m.opt.noslip_iterations
    }

    /// Returns the residual of a row without its regularisation.
    fn pure_residual(&self, row: usize) -> f64 {
        self.residual(row) - self.d.efc.r[row] * self.force(row)
    }

    /// Updates the force of a row of dry friction. Returns the change of the cost.
    fn dry_friction(&mut self, row: usize) -> f64 {
        let (loss, old) = (self.d.efc.loss[row], self.force(row));
        let residual = self.pure_residual(row);
        let inverse = 1.0 / f64::max(MINVAL, self.element(row, row) - self.d.efc.r[row]);
        let force = (old - residual * inverse).clamp(-loss, loss);
        dense::set(&mut self.s.force, row, force);
        let delta = force - old;
        0.5 * delta * delta / inverse + delta * residual
    }

    fn form(&self, first: usize, n: usize) -> QuadraticForm {
        let (old, mut a) = (self.forces(first, n), self.block(first, n));
        let (mut residual, mut rest) = ([0.0; 6], [0.0; 6]);
        for (k, (residual, rest)) in residual[..n].iter_mut().zip(&mut rest).enumerate() {
            *residual = self.pure_residual(first + k);
            let own = &mut a[k * (n + 1)];
            *own = f64::max(1e-10, *own - self.d.efc.r[first + k]);
            *rest = *residual - dot_slices(&a[k * n..(k + 1) * n], &old[..n]);
        }
        QuadraticForm {
            old,
            residual,
            a,
            rest,
        }
    }

    /// Updates the forces of two opposite edges of a pyramid. Returns the change of the cost.
    fn edges(&mut self, row: usize) -> f64 {
        let form = self.form(row, 2);
        let QuadraticForm { old, a, rest, .. } = &form;
        let middle = 0.5 * (old[0] + old[1]);
        let k1 = a[0] + a[3] - a[1] - a[2];
        let k0 = middle * (a[0] - a[3]) + rest[0] - rest[1];
        let force = if k1 < MINVAL {
            [middle; 2]
        } else {
            let y = -k0 / k1;
            if y < -middle {
                [0.0, 2.0 * middle]
            } else if y > middle {
                [2.0 * middle, 0.0]
            } else {
                [middle + y, middle - y]
            }
        };
        self.take_form(row, &form, &force)
    }

    /// Updates the friction of an elliptic cone. Returns the change of the cost.
    fn slide(&mut self, block: &Block, friction: &[f64; 5]) -> f64 {
        let (row, n) = (block.row, block.rows - 1);
        let form = self.form(row + 1, n);
        let mut force = [0.0; 6];
        force[0] = self.force(row);
        if force[0] >= MINVAL {
            let (a, b) = (&form.a[..n * n], &form.rest[..n]);
            qcqp::friction(&mut force[..=n], a, b, friction, self.revision);
        }
        self.take_form(row + 1, &form, &force[1..=n])
    }

    fn take_form(&mut self, first: usize, form: &QuadraticForm, force: &[f64]) -> f64 {
        let n = force.len();
        let (old, residual) = (&form.old[..n], &form.residual[..n]);
        self.take(first, old, residual, &form.a[..n * n], force)
    }
}
