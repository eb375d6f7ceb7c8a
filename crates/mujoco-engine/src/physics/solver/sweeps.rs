//! The sweeps of projected Gauss-Seidel over rows that only push.

use super::orders::{Orders, Pcg32};
use super::pgs::{Buffers, Coupled, product_of};
use crate::Model;
use crate::math::dense::{self, Lanes};

/// The quantities that the update of one row needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    row: usize,
    b: f64,
    diag_inv: f64,
    /// `1 / diag_inv`.
    diag: f64,
}

/// The sweeps over the rows of an island.
pub(in crate::physics) struct Sweeps<'a> {
    nefc: usize,
    stride: usize,
    /// The number of groups of four rows.
    full: usize,
    rows: &'a [usize],
    // slices: otherwise the compiler loads the vectors' addresses again after each write to `force`
    steps: &'a [Step],
    ar: &'a [Lanes],
    coupled: &'a Coupled,
    force: &'a mut [Lanes],
    before: &'a mut [f64],
    momentum: &'a mut [f64],
    /// The orders of all sweeps; drawn during the sweep before if there are none.
    known: Option<&'a [u8]>,
    order: &'a mut [u32],
    next_order: &'a mut [u32],
    generator: Pcg32,
    /// The number of sweeps since the momentum started.
    k: f64,
    /// The factor of the improvement.
    scale: f64,
    improvement: f64,
    pub(in crate::physics) iterations: usize,
}

impl<'a> Sweeps<'a> {
    #[inline(always)]
    pub(in crate::physics) fn new(
        s: &'a mut Buffers,
        (nefc, scale): (usize, f64),
        orders: Option<&'a Orders>,
        b: impl Fn(usize) -> f64,
    ) -> Self {
        let n = s.rows.len();
        let stride = dense::groups(nefc);
        s.steps.clear();
        s.steps.extend(s.rows.iter().map(|&row| {
            let diag_inv = 1.0 / s.ar[row * stride + row / 4][row % 4];
            Step {
                row,
                b: b(row),
                diag_inv,
                diag: 1.0 / diag_inv,
            }
        }));
        let known = orders.and_then(|orders| orders.of(n));
        let mut generator = Pcg32::new();
        s.next_order.clear();
        s.next_order.extend(0..n as u32);
        if known.is_none() {
            for i in (1..n).rev() {
                generator.swap(&mut s.next_order, i);
            }
        }
        s.order.clear();
        s.order.resize(n, 0);
        for vector in [&mut s.before, &mut s.momentum] {
            vector.clear();
            vector.extend(s.rows.iter().map(|row| s.force.as_flattened()[*row]));
        }
        Self {
            nefc,
            stride,
            full: nefc / 4,
            rows: &s.rows[..n],
            steps: &s.steps[..n],
            ar: &s.ar[..nefc * stride],
            coupled: &s.coupled,
            force: &mut s.force[..stride],
            before: &mut s.before[..n],
            momentum: &mut s.momentum[..n],
            known,
            order: &mut s.order[..n],
            next_order: &mut s.next_order[..n],
            generator,
            k: 0.0,
            scale,
            improvement: 0.0,
            iterations: 0,
        }
    }

    /// Begins a sweep: adds the momentum to the forces.
    #[inline(always)]
    fn begin(&mut self) {
        let beta = if self.iterations > 0 {
            (self.k - 1.0) / (self.k + 2.0)
        } else {
            0.0
        };
        let numbers = self.force.as_flattened_mut();
        let kept = self.before.iter_mut().zip(&mut *self.momentum);
        for (&row, (before, momentum)) in self.rows.iter().zip(kept) {
            let now = numbers[row];
            let mut start = now;
            if beta > 0.0 {
                let moved = now + beta * (now - *before);
                start = if moved < 0.0 { 0.0 } else { moved };
                numbers[row] = start;
            }
            (*before, *momentum) = (now, start);
        }
        match self.known {
            Some(known) => {
                let n = self.order.len();
                for (to, from) in self.order.iter_mut().zip(&known[self.iterations * n..]) {
                    *to = u32::from(*from);
                }
            }
            None => self.order.copy_from_slice(self.next_order),
        }
        self.improvement = 0.0;
    }

    /// Updates the force of a row, that at `place` in the order, if there are so many. Also draws a
    /// part of the next order: each update waits for the previous update, which leaves time on the
    /// CPU.
    #[inline(always)]
    fn update(&mut self, place: usize) {
        let n = self.steps.len();
        let Some(&i) = self.order.get(place) else {
            return;
        };
        let step = &self.steps[i as usize];
        let row = step.row;
        let ar = &self.ar[row * self.stride..][..self.stride];
        let product = if self.known.is_some() {
            dense::dot_of(ar, self.force, self.full)
        } else {
            product_of(ar, self.force, self.nefc, self.coupled.of(row))
        };
        let residual = step.b + product;
        let old = self.force.as_flattened()[row];
        let moved = old - residual * step.diag_inv;
        let new = if moved < 0.0 { 0.0 } else { moved };
        let delta = new - old;
        let change = 0.5 * delta * delta * step.diag + delta * residual;
        if change <= 1e-10 {
            dense::set(self.force, row, new);
            self.improvement -= change;
        }
        let next = n - 1 - place;
        if self.known.is_none() && next > 0 {
            self.generator.swap(self.next_order, next);
        }
    }

    /// Ends a sweep. Returns whether it improved the forces by more than `tolerance`.
    #[inline(always)]
    fn end(&mut self, tolerance: f64) -> bool {
        let numbers = self.force.as_flattened();
        let mut turned = 0.0;
        let kept = self.momentum.iter().zip(&*self.before);
        for (&row, (momentum, before)) in self.rows.iter().zip(kept) {
            turned += (numbers[row] - momentum) * (momentum - before);
        }
        self.k = if self.iterations > 0 && turned < 0.0 {
            0.0
        } else {
            self.k + 1.0
        };
        self.iterations += 1;
        let is_small = self.improvement * self.scale < tolerance;
        !is_small
    }
}

/// Updates the forces of islands until the solver stops. The islands, those of most rows first, take
/// turns row by row: each update of a row waits for the update before, which leaves time on the CPU for
/// other islands.
#[inline(always)]
pub(in crate::physics) fn iterate(m: &Model, islands: &mut [Sweeps<'_>]) {
    let mut left = if m.opt.iterations > 0 { islands.len() } else { 0 };
    while left > 0 {
        let islands = &mut islands[..left];
        for island in &mut *islands {
            island.begin();
        }
        let mut long = left;
        for place in 0..islands[0].steps.len() {
            while islands[long - 1].steps.len() <= place {
                long -= 1;
            }
            for island in &mut islands[..long] {
                island.update(place);
            }
        }
        left = 0;
        for index in 0..islands.len() {
            let improves = islands[index].end(m.opt.tolerance);
            if improves && islands[index].iterations < m.opt.iterations {
                islands.swap(left, index);
                left += 1;
            }
        }
    }
}
