//! The sweeps of Gauss-Seidel in worlds that take turns: [`pgs`](crate::physics::solver::pgs).

use fearless_simd::{Simd, SimdFrom, f64x4};

use crate::Model;
use crate::math::dense::{self, total};
use crate::model::Disable;
use crate::physics::solver::orders::{Orders, Pcg32};
use crate::physics::solver::sweep::{Momentum, Step, pushing};

/// Four elements of a row of a matrix, or of a vector over rows.
type Four = dense::Lanes;

/// The rows of a world, and the state of its sweeps.
///
/// Vectors over rows have as many groups of four in all worlds, so that all loops over them are of
/// the same length. The last group has the one to three rows after the last full group, which a sum
/// adds last. Groups between them are zero.
#[derive(Clone, Debug, Default)]
pub(super) struct World {
    /// The index among the worlds that step together.
    pub(super) index: usize,
    /// The number of groups of four, without the last.
    groups: usize,
    /// `J M^-1 J' + R`, row by row.
    ar: Vec<Four>,
    force: Vec<Four>,
    product: Vec<Four>,
    rows: Vec<Row>,
    /// The forces before the extrapolation, and after it.
    before: Vec<Four>,
    momentum: Vec<Four>,
    order: Vec<u32>,
    /// The last order that was drawn, of rows that are too many for [`Orders`], and what draws the next.
    drawn: Vec<u32>,
    generator: Pcg32,
    kept: Momentum,
    /// Scales the improvement.
    scale: f64,
    improvement: f64,
    sweeps: usize,
}

/// A row: the place of its element in a vector, and its update.
#[derive(Clone, Copy, Debug)]
struct Row {
    group: usize,
    lane: usize,
    step: Step,
}

impl World {
    pub(super) fn new(rows: usize) -> Self {
        let groups = rows / 4 + 1;
        Self {
            ar: Vec::with_capacity(rows * groups),
            force: Vec::with_capacity(groups),
            product: Vec::with_capacity(groups),
            rows: Vec::with_capacity(rows),
            before: Vec::with_capacity(groups),
            momentum: Vec::with_capacity(groups),
            order: Vec::with_capacity(rows),
            drawn: Vec::with_capacity(rows),
            ..Self::default()
        }
    }

    #[cfg(test)]
    pub(super) fn poison(&mut self) {
        use crate::physics::work::Poison;
        for vector in [
            &mut self.ar,
            &mut self.force,
            &mut self.product,
            &mut self.before,
            &mut self.momentum,
        ] {
            vector.poison();
        }
    }

    /// Begins world `index` with `n` rows, in vectors of `groups` groups and a last one. `scale` scales the
    /// improvement.
    pub(super) fn begin(&mut self, index: usize, n: usize, groups: usize, scale: f64) {
        (self.index, self.groups, self.scale) = (index, groups, scale);
        (self.kept, self.sweeps) = (Momentum::default(), 0);
        let stride = groups + 1;
        for (vector, len) in [
            (&mut self.ar, n * stride),
            (&mut self.force, stride),
            (&mut self.product, stride),
        ] {
            vector.clear();
            vector.resize(len, [0.0; 4]);
        }
        self.rows.clear();
        self.rows.extend((0..n).map(|row| Row {
            group: if row / 4 < n / 4 { row / 4 } else { groups },
            lane: row % 4,
            step: Step::default(),
        }));
    }

    /// Sets four elements of row `i` of the matrix.
    #[inline(always)]
    pub(super) fn set_four(&mut self, i: usize, group: usize, four: Four) {
        let full = self.rows.len() / 4;
        if group <= full {
            let group = if group < full { group } else { self.groups };
            self.ar[i * (self.groups + 1) + group] = four;
        }
    }

    /// Sets the residual of zero forces and the force of row `i`.
    #[inline(always)]
    pub(super) fn set_row(&mut self, i: usize, b: f64, force: f64) {
        let row = &mut self.rows[i];
        let diagonal = self.ar[i * (self.groups + 1) + row.group][row.lane];
        row.step = Step::new(b, diagonal);
        self.force[row.group][row.lane] = force;
    }

    /// Returns the forces of all rows.
    pub(super) fn forces(&self) -> impl Iterator<Item = f64> + '_ {
        self.rows.iter().map(|row| self.force[row.group][row.lane])
    }

    /// Starts at the forces, unless zero forces have a lower cost.
    #[inline(always)]
    fn start<S: Simd>(&mut self, simd: S, cold: bool) {
        for (row, ar) in self.rows.iter().zip(self.ar.chunks_exact(self.groups + 1)) {
            self.product[row.group][row.lane] = dot(simd, ar, &self.force);
        }
        let half_square = 0.5 * dot(simd, &self.force, &self.product);
        for row in &self.rows {
            self.product[row.group][row.lane] = row.step.b;
        }
        if cold || dot(simd, &self.force, &self.product) + half_square > 0.0 {
            self.force.fill([0.0; 4]);
        }
        for vector in [&mut self.before, &mut self.momentum] {
            vector.clear();
            vector.extend_from_slice(&self.force);
        }
    }

    /// Begins a sweep: extrapolates the forces by their last change.
    #[inline(always)]
    fn extrapolate(&mut self, orders: &Orders, iterations: usize) {
        let (n, beta) = (self.rows.len(), self.kept.beta());
        let kept = self.before.iter_mut().zip(&mut self.momentum);
        for (force, (before, momentum)) in self.force.iter_mut().zip(kept) {
            let now = *force;
            if beta > 0.0 {
                for k in 0..4 {
                    force[k] = pushing(now[k] + beta * (now[k] - before[k]));
                }
            }
            (*before, *momentum) = (now, *force);
        }
        self.order.clear();
        match orders.of(n, iterations) {
            Some(known) => {
                let own = &known[self.sweeps * n..][..n];
                self.order.extend(own.iter().map(|row| u32::from(*row)));
            }
            None => {
                if self.sweeps == 0 {
                    self.generator = Pcg32::new();
                    self.drawn.clear();
                    self.drawn.extend(0..n as u32);
                }
                self.generator.shuffle(&mut self.drawn);
                self.order.extend_from_slice(&self.drawn);
            }
        }
        self.improvement = 0.0;
    }

    /// Updates the force of the row at `place` in the order.
    #[inline(always)]
    fn update<S: Simd>(&mut self, simd: S, place: usize) {
        let i = self.order[place] as usize;
        let row = &self.rows[i];
        let stride = self.groups + 1;
        let force = &mut self.force[..stride];
        let product = dot(simd, &self.ar[i * stride..][..stride], force);
        let group = &mut force[row.group];
        if let Some((new, change)) = row.step.update(product, group[row.lane & 3]) {
            dense::set(std::slice::from_mut(group), row.lane, new);
            self.improvement -= change;
        }
    }

    /// Ends a sweep. Returns whether it improved the forces by less than `tolerance`.
    #[inline(always)]
    fn converges(&mut self, tolerance: f64) -> bool {
        let mut turned = 0.0;
        let kept = self.momentum.iter().zip(&self.before);
        for (force, (momentum, before)) in self.force.iter().zip(kept) {
            for k in 0..4 {
                turned += (force[k] - momentum[k]) * (momentum[k] - before[k]);
            }
        }
        self.kept.end_sweep(turned);
        self.sweeps += 1;
        self.improvement * self.scale < tolerance
    }
}

/// The product of two vectors over rows, in the order of [`dense::dot`].
#[inline(always)]
fn dot<S: Simd>(simd: S, a: &[Four], b: &[Four]) -> f64 {
    let (Some((rest_a, a)), Some((rest_b, b))) = (a.split_last(), b.split_last()) else {
        return 0.0;
    };
    let mut sums = f64x4::simd_from(simd, [0.0; 4]);
    for (a, b) in a.iter().zip(b) {
        sums += f64x4::simd_from(simd, *a) * f64x4::simd_from(simd, *b);
    }
    total(&sums.into()) + (rest_a[0] * rest_b[0] + rest_a[1] * rest_b[1] + rest_a[2] * rest_b[2])
}

/// Updates the forces of `worlds`, which are sorted by their number of rows from the largest, until
/// the solver stops. The worlds take turns, row by row: each update waits for the update before,
/// which leaves time on the CPU for other worlds.
#[inline(always)]
pub(super) fn sweep<S: Simd>(m: &Model, simd: S, worlds: &mut [World], orders: &Orders) {
    for world in &mut *worlds {
        world.start(simd, m.opt.disables(Disable::WarmStart));
    }
    let mut left = if m.opt.iterations > 0 {
        worlds.len()
    } else {
        0
    };
    while left > 0 {
        let worlds = &mut worlds[..left];
        for world in &mut *worlds {
            world.extrapolate(orders, m.opt.iterations);
        }
        let mut long = left;
        for place in 0..worlds[0].rows.len() {
            while worlds[long - 1].rows.len() <= place {
                long -= 1;
            }
            for world in &mut worlds[..long] {
                world.update(simd, place);
            }
        }
        left = 0;
        for index in 0..worlds.len() {
            let world = &mut worlds[index];
            if !world.converges(m.opt.tolerance) && world.sweeps < m.opt.iterations {
                worlds.swap(left, index);
                left += 1;
            }
        }
    }
}
