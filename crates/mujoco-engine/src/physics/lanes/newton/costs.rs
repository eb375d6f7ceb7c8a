//! The costs of rows: forces, and the second derivatives of elliptic cones.

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use super::{Mask, Newton};
use crate::Revision;
use crate::math::spatial::MINVAL;
use crate::physics::lanes::rows::Rows;
use crate::physics::lanes::tree::cholesky_update;
use crate::physics::lanes::{At, PerWorld, load, same, store};
use crate::physics::solver::cones::{Scaled, factor};

/// Calls `$do` with the number of rows of a cone. Most cones have three rows: the compiler unrolls
/// loops.
macro_rules! with_dim {
    ($dim:expr, $name:ident => $do:expr) => {
        match $dim {
            3 => {
                let $name = 3;
                $do
            }
            $name => $do,
        }
    };
}
pub(super) use with_dim;

/// Computes the forces of rows with the residuals `jar`, and whether the cost of each row is
/// quadratic (1) or not (0). Returns the cost of all rows: see
/// [`row_costs`](crate::physics::solver::row_costs).
#[inline(always)]
pub(super) fn forces<S: Simd>(
    at: At<S>,
    (rows, revision): (&Rows, Revision),
    jar: &[PerWorld],
    force: &mut [PerWorld],
    quadratic: &mut [PerWorld],
) -> Lanes<S> {
    let zero = same::<S>(at, 0.0);
    let one = zero.same(1.0);
    let mut cost = zero;
    for row in 0..rows.pulls[0] {
        let (x, d) = (load::<S>(at, &jar[row]), load::<S>(at, &rows.d[row]));
        cost = cost + d * 0.5 * x * x;
        store(at, &mut force[row], -d * x);
        store(at, &mut quadratic[row], one);
    }
    for row in rows.pulls[0]..rows.pulls[1] {
        let (x, d) = (load::<S>(at, &jar[row]), load::<S>(at, &rows.d[row]));
        let (r, loss) = (load::<S>(at, &rows.r[row]), load::<S>(at, &rows.loss[row]));
        let (low, high) = (x.le(-r * loss), (r * loss).le(x));
        let flat = r * -0.5 * loss * loss;
        let (below, above) = (flat - loss * x, flat + loss * x);
        let (between, inner) = (d * 0.5 * x * x, -d * x);
        let (between, inner) = (
            Lanes::select(high, above, between),
            Lanes::select(high, -loss, inner),
        );
        cost = cost + Lanes::select(low, below, between);
        store(at, &mut force[row], Lanes::select(low, loss, inner));
        store(
            at,
            &mut quadratic[row],
            Lanes::select(low | high, zero, one),
        );
    }
    for row in rows.one_sided() {
        let (x, d) = (load::<S>(at, &jar[row]), load::<S>(at, &rows.d[row]));
        let pushes = x.lt(zero);
        cost = cost + Lanes::select(pushes, d * 0.5 * x * x, zero);
        store(at, &mut force[row], Lanes::select(pushes, -d * x, zero));
        store(at, &mut quadratic[row], Lanes::select(pushes, one, zero));
    }
    if !rows.cones.is_empty() {
        with_dim!(rows.dim, dim => cost = of_cones(at, (rows, revision), dim, cost, jar, force, quadratic));
    }
    cost
}

/// [`forces`] for the cones. Returns the sum of `cost` and the costs of cones.
#[inline(always)]
fn of_cones<S: Simd>(
    at: At<S>,
    (rows, revision): (&Rows, Revision),
    dim: usize,
    mut cost: Lanes<S>,
    jar: &[PerWorld],
    force: &mut [PerWorld],
    quadratic: &mut [PerWorld],
) -> Lanes<S> {
    let zero = same::<S>(at, 0.0);
    for index in 0..rows.cones.len() {
        let first = rows.cone(index);
        let scaled = scaled(at, rows, index, dim, jar);
        let zone = scaled.zone;
        let (mut more, mut slides) = (zero, [zero; 6]);
        if !Lanes::<S>::all(zone.top | zone.bottom) {
            (more, slides) = scaled.slide(dim, revision);
        }
        let mut sticks = cost;
        let is_quadratic = Lanes::<S>::but_not(zone.bottom, zone.top);
        for (k, slides) in slides.into_iter().enumerate().take(dim) {
            let row = first + k;
            let (x, d) = (load::<S>(at, &jar[row]), load::<S>(at, &rows.d[row]));
            sticks = sticks + d * 0.5 * x * x;
            let own = Lanes::select(zone.bottom, -d * x, slides);
            store(at, &mut force[row], Lanes::select(zone.top, zero, own));
            let one = Lanes::select(is_quadratic, zero.same(1.0), zero);
            store(at, &mut quadratic[row], one);
        }
        let moves = Lanes::select(zone.bottom, sticks, cost + more);
        cost = Lanes::select(zone.top, cost, moves);
    }
    cost
}

/// Returns the scaled residuals of a cone.
#[inline(always)]
fn scaled<S: Simd>(
    at: At<S>,
    rows: &Rows,
    index: usize,
    dim: usize,
    jar: &[PerWorld],
) -> Scaled<Lanes<S>> {
    let first = rows.cone(index);
    let shape = rows.cones[index].map(
        #[inline(always)]
        |x| load::<S>(at, x),
    );
    Scaled::new(
        shape,
        dim,
        #[inline(always)]
        |k| load(at, &jar[first + k]),
    )
}

impl Newton {
    /// Writes the factor with the second derivatives of the cones that slide to `with_cones`, unless
    /// no cone slides in any world that continues. Returns whether it did.
    #[inline(always)]
    pub(super) fn add_cones<S: Simd>(
        &mut self,
        at: At<S>,
        (rows, revision): (&Rows, Revision),
        n: usize,
        active: &PerWorld,
    ) -> bool {
        let active: Mask<S> = load::<S>(at, active).gt(same(at, 0.0));
        let mut slide = false;
        for index in 0..rows.cones.len() {
            with_dim!(rows.dim, dim => {
                let scaled = scaled(at, rows, index, dim, &self.jar);
                let zone = scaled.zone;
                let which = Lanes::<S>::but_not(active, zone.top | zone.bottom);
                if Lanes::<S>::any(which) {
                    if !slide {
                        self.with_cones[..n * n].copy_from_slice(&self.hessian[..n * n]);
                        slide = true;
                    }
                    self.add_cone(at, rows, (rows.cone(index), dim), n, (&scaled, which), revision);
                }
            });
        }
        slide
    }

    /// Adds the second derivatives of the cone of the `dim` rows from row `first`, in the worlds of
    /// `which`.
    #[inline(always)]
    fn add_cone<S: Simd>(
        &mut self,
        at: At<S>,
        rows: &Rows,
        (first, dim): (usize, usize),
        n: usize,
        (scaled, which): (&Scaled<Lanes<S>>, Mask<S>),
        revision: Revision,
    ) {
        let mut l = scaled.bend(dim, revision);
        factor(at, dim, &mut l);
        for c in 0..dim {
            for (i, x) in self.row_update[..n].iter_mut().enumerate() {
                let mut sum = same::<S>(at, 0.0);
                for r in c..dim {
                    sum = sum + load::<S>(at, &rows.jac[(first + r) * n + i]) * l[r][c];
                }
                store(at, x, sum);
            }
            let (matrix, x) = (&mut self.with_cones, &mut self.row_update);
            cholesky_update(at, n, matrix, x, (which, which), MINVAL);
        }
    }
}
