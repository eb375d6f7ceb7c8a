//! The Hessian of the cost, and its factor.

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use super::islands::Part;
use super::{Mask, Newton, by_four, sums};
use crate::Model;
use crate::math::spatial::MINVAL;
use crate::physics::lanes::rows::{Rows, worlds};
use crate::physics::lanes::tree::{cholesky, cholesky_update};
use crate::physics::lanes::{Arrays, At, PerWorld, load, same, store};

impl Newton {
    /// Builds and factors the Hessian of the cost: for the worlds in `which`, or for all worlds.
    #[inline(always)]
    pub(super) fn make_hessian<S: Simd>(
        &mut self,
        m: &Model,
        at: At<S>,
        a: &Arrays,
        (rows, part): (&Rows, &Part),
        which: Option<&PerWorld>,
    ) {
        let (n, plan, zero) = (part.n, m.plan(), same::<S>(at, 0.0));
        self.pushing.clear();
        for row in 0..rows.used {
            let pushes = load::<S>(at, &self.pushes[row]).gt(zero);
            if !Lanes::<S>::any(pushes) {
                continue;
            }
            let d = Lanes::select(pushes, load(at, &rows.d[row]), zero);
            let place = self.pushing.len() * n;
            let jac = &rows.jac[row * n..(row + 1) * n];
            for (pushed, jac) in self.pushed[place..place + n].iter_mut().zip(jac) {
                store(at, pushed, load::<S>(at, jac) * d);
            }
            self.pushing.push(row);
        }
        let into = if which.is_some() {
            &mut self.again
        } else {
            &mut self.hessian
        };
        let into = &mut into[..n * n];
        for (i, column) in into.chunks_exact_mut(n).enumerate() {
            let mut first = i;
            by_four!(n, first, K => {
                let pushing = self.pushing.iter().zip(self.pushed.chunks_exact(n));
                let terms = pushing.map(
                    #[inline(always)]
                    |(&row, pushed)| (pushed, &rows.jac[row * n + i]),
                );
                let sums = sums::<S, K>(at, first, terms);
                for (x, sum) in column[first..].iter_mut().zip(sums) {
                    store(at, x, sum);
                }
            });
        }
        // as in MuJoCo, add the inertia matrix last
        for (dofs, place) in &part.trees {
            for (dof, own) in dofs.clone().zip(*place..) {
                let row = plan.m_row(dof);
                for (&column, value) in plan.m_local[row.clone()].iter().zip(&a.qm[row]) {
                    let x = &mut into[(place + column) * n + own];
                    store(at, x, load::<S>(at, x) + load(at, value));
                }
            }
        }
        cholesky(at, n, into, MINVAL);
        if let Some(which) = which {
            let which: Mask<S> = load::<S>(at, which).gt(zero);
            for (x, again) in self.hessian[..n * n].iter_mut().zip(&self.again) {
                store(at, x, Lanes::select(which, load(at, again), load(at, x)));
            }
        }
    }

    /// Updates the factors for the rows that began or ceased to push. Returns whether any world
    /// needs a new factorisation; `again` marks these worlds.
    #[inline(always)]
    pub(super) fn update_hessian<S: Simd>(
        &mut self,
        at: At<S>,
        (rows, n): (&Rows, usize),
        active: &PerWorld,
        again: &mut PerWorld,
    ) -> bool {
        let zero = same::<S>(at, 0.0);
        let (one, first) = (zero.same(1.0), at.1);
        let active: Mask<S> = load::<S>(at, active).gt(zero);
        for world in first..first + Lanes::<S>::LANES {
            self.changed[world].clear();
        }
        let mut most = 0;
        for row in 0..rows.used {
            let pushes = load::<S>(at, &self.quadratic[row]).gt(zero);
            let before = load::<S>(at, &self.pushes[row]).gt(zero);
            let changed = Lanes::<S>::but_not(pushes, before) | Lanes::<S>::but_not(before, pushes);
            let changed = Lanes::<S>::bits(changed & active);
            if changed != 0 {
                let pushes = Lanes::select(pushes, one, zero);
                let pushes = Lanes::select(active, pushes, load(at, &self.pushes[row]));
                store(at, &mut self.pushes[row], pushes);
                for world in worlds(changed, first) {
                    self.changed[world].push(row);
                    most = most.max(self.changed[world].len());
                }
            }
        }
        let mut indefinite = zero.lt(zero);
        // in each round, update every world for its next changed row
        for round in 0..most {
            let (mut which, mut adds) = (PerWorld::ZERO, PerWorld::ZERO);
            for world in first..first + Lanes::<S>::LANES {
                let Some(&row) = self.changed[world].get(round) else {
                    continue;
                };
                which.0[world] = 1.0;
                adds.0[world] = self.pushes[row].0[world];
                let root = rows.d[row].0[world].sqrt();
                let jac = &rows.jac[row * n..(row + 1) * n];
                for (x, jac) in self.row_update.iter_mut().zip(jac) {
                    x.0[world] = jac.0[world] * root;
                }
            }
            let which = load::<S>(at, &which).gt(zero);
            let adds = load::<S>(at, &adds).gt(zero);
            let masks = (Lanes::<S>::but_not(which, indefinite), adds);
            let (factor, x) = (&mut self.hessian, &mut self.row_update);
            indefinite |= cholesky_update(at, n, factor, x, masks, MINVAL);
        }
        store(at, again, Lanes::select(indefinite, one, zero));
        Lanes::<S>::any(indefinite)
    }
}
