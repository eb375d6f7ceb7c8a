//! Iterations after the solver that prevent slip: they change only friction forces, and leave out
//! the regularisation that lets contacts creep.

use super::pgs::{self, Buffers};
use crate::physics::constraint::{Block, Kind, Source};
use crate::physics::dense::{self, dot, dot_slices};
use crate::physics::spatial::MINVAL;
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
        let mut problem = Problem { m, d, s: &mut s };
        *iterations += problem.iterate(&own, scale);
    }
    d.solver_niter = iterations;
    let nefc = d.efc.nefc();
    d.efc.force.copy_from_slice(&s.force.as_flattened()[..nefc]);
    d.work.pgs = s;
    pgs::finish(m, d);
}

struct Problem<'a> {
    m: &'a Model,
    d: &'a Data,
    s: &'a mut Buffers,
}

impl Problem<'_> {
    fn iterate<'b>(
        &mut self,
        blocks: &(impl Iterator<Item = &'b Block> + Clone),
        scale: f64,
    ) -> usize {
        for iteration in 0..self.m.opt.noslip_iterations {
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
                    (Kind::Limit, Source::Contact(_)) if block.rows > 1 => {
                        for row in (block.row..block.row + block.rows).step_by(2) {
                            improvement -= self.edges(row);
                        }
                    }
                    (Kind::Cone, Source::Contact(id)) => {
                        improvement -= self.cone(block.row, &self.d.contact[id].friction);
                    }
                    _ => {}
                }
            }
            improvement *= scale;
            if improvement < self.m.opt.noslip_tolerance {
                return iteration + 1;
            }
        }
        self.m.opt.noslip_iterations
    }

    fn force(&self, row: usize) -> f64 {
        self.s.force.as_flattened()[row]
    }

    fn element(&self, i: usize, j: usize) -> f64 {
        let stride = dense::groups(self.d.efc.nefc());
        self.s.ar[i * stride + j / 4][j % 4]
    }

    /// The residual of a row, with its regularisation left out.
    fn residual(&self, row: usize) -> f64 {
        let (nefc, stride) = (self.d.efc.nefc(), dense::groups(self.d.efc.nefc()));
        let ar = &self.s.ar[row * stride..(row + 1) * stride];
        self.d.efc.b[row] + dot(ar, &self.s.force, nefc) - self.d.efc.r[row] * self.force(row)
    }

    /// Updates a row of dry friction; returns the change of the cost.
    fn dry_friction(&mut self, row: usize) -> f64 {
        let (loss, old) = (self.d.efc.loss[row], self.force(row));
        let residual = self.residual(row);
        let inverse = 1.0 / f64::max(MINVAL, self.element(row, row) - self.d.efc.r[row]);
        let force = (old - residual * inverse).clamp(-loss, loss);
        dense::set(&mut self.s.force, row, force);
        let delta = force - old;
        0.5 * delta * delta / inverse + delta * residual
    }

    /// For two rows: forces, residuals, the 2x2 matrix without regularisation, and the residuals
    /// without the rows' own forces.
    fn two(&self, row: usize) -> ([f64; 2], [f64; 2], [f64; 4], [f64; 2]) {
        let old = [self.force(row), self.force(row + 1)];
        let residual = [self.residual(row), self.residual(row + 1)];
        let mut a = [0, 1, 2, 3].map(|k| self.element(row + k / 2, row + k % 2));
        for k in 0..2 {
            a[3 * k] = f64::max(1e-10, a[3 * k] - self.d.efc.r[row + k]);
        }
        let mut rest = residual;
        for k in 0..2 {
            rest[k] -= dot_slices(&a[2 * k..2 * k + 2], &old);
        }
        (old, residual, a, rest)
    }

    /// Updates two opposite edges of a pyramid; returns the change of the cost.
    fn edges(&mut self, row: usize) -> f64 {
        let (old, residual, a, rest) = self.two(row);
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
        self.take(row, old, residual, &a, force)
    }

    /// Updates the friction of an elliptic cone; returns the change of the cost.
    fn cone(&mut self, row: usize, friction: &[f64; 5]) -> f64 {
        let normal = self.force(row);
        let (old, residual, a, rest) = self.two(row + 1);
        let force = if normal < MINVAL {
            [0.0; 2]
        } else {
            let mu = [friction[0], friction[1]];
            let (mut v, active) = nearest(&a, &rest, mu, normal);
            if active {
                // scale onto the ellipse
                let square = v[0] * v[0] / (mu[0] * mu[0]) + v[1] * v[1] / (mu[1] * mu[1]);
                let scale = (normal * normal / f64::max(MINVAL, square)).sqrt();
                v = v.map(|x| x * scale);
            }
            v
        };
        self.take(row + 1, old, residual, &a, force)
    }

    /// Sets the forces of two rows unless the cost would grow; returns the change of the cost.
    fn take(
        &mut self,
        row: usize,
        old: [f64; 2],
        residual: [f64; 2],
        a: &[f64; 4],
        force: [f64; 2],
    ) -> f64 {
        let delta = [force[0] - old[0], force[1] - old[1]];
        let mut square = 0.0;
        for k in 0..2 {
            square += delta[k] * dot_slices(&a[2 * k..2 * k + 2], &delta);
        }
        let change = 0.5 * square + dot_slices(&delta, &residual);
        if change > 1e-10 {
            return 0.0;
        }
        for (k, force) in force.into_iter().enumerate() {
            dense::set(&mut self.s.force, row + k, force);
        }
        change
    }
}

/// The minimum of a quadratic form within an ellipse, and whether it is on the ellipse's edge:
/// MuJoCo's `mju_QCQP2`.
fn nearest(a: &[f64; 4], b: &[f64; 2], d: [f64; 2], r: f64) -> ([f64; 2], bool) {
    const LEAST: f64 = 1e-10;
    let (b1, b2) = (b[0] * d[0], b[1] * d[1]);
    let a11 = a[0] * d[0] * d[0];
    let a22 = a[3] * d[1] * d[1];
    let a12 = a[1] * d[0] * d[1];
    let (mut la, mut v) = (0.0, [0.0; 2]);
    for _ in 0..20 {
        let det = (a11 + la) * (a22 + la) - a12 * a12;
        if det < LEAST {
            return ([0.0; 2], false);
        }
        let inverse = 1.0 / det;
        let (p11, p22, p12) = ((a22 + la) * inverse, (a11 + la) * inverse, -a12 * inverse);
        v = [-p11 * b1 - p12 * b2, -p12 * b1 - p22 * b2];
        let value = v[0] * v[0] + v[1] * v[1] - r * r;
        if value < LEAST {
            break;
        }
        let slope = -2.0 * (p11 * v[0] * v[0] + 2.0 * p12 * v[0] * v[1] + p22 * v[1] * v[1]);
        let step = -value / slope;
        if step < LEAST {
            break;
        }
        la += step;
    }
    ([v[0] * d[0], v[1] * d[1]], la != 0.0)
}
