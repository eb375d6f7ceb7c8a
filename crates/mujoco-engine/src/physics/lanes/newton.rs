//! Newton's method for several worlds at once: [`newton`](crate::physics::solver::newton).
//!
//! All worlds iterate together. A world that has converged keeps its accelerations. Quantities
//! derived from the accelerations are computed again, with the same result.

mod costs;
mod hessian;
mod islands;
mod search;

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use self::costs::forces;
use self::islands::{Islands, Part};
use super::rows::{Rows, worlds};
use super::tree::{cholesky_solve, dot};
use super::{Arrays, At, PerWorld, WORLDS, copy, load, same, store};
use crate::model::{Cone as ConeType, Disable};
use crate::physics::solver::cones::Cone;
use crate::physics::solver::{line_search, row_costs};
use crate::{Model, Revision};

type Mask<S> = <Lanes<S> as Real>::Mask;

/// The buffers of the method.
#[derive(Clone, Debug, Default)]
pub(super) struct Newton {
    acc: Vec<PerWorld>,
    ma: Vec<PerWorld>,
    grad: Vec<PerWorld>,
    mgrad: Vec<PerWorld>,
    search: Vec<PerWorld>,
    mv: Vec<PerWorld>,
    constraint: Vec<PerWorld>,
    row_update: Vec<PerWorld>,
    jar: Vec<PerWorld>,
    jv: Vec<PerWorld>,
    force: Vec<PerWorld>,
    /// 1 for each row whose cost is quadratic (of rows that only push: those whose residual `jar` is
    /// negative), 0 for the others.
    quadratic: Vec<PerWorld>,
    /// The `quadratic` rows that are part of the Hessian.
    pushes: Vec<PerWorld>,
    /// For each row, the cost along the search direction: three coefficients of a polynomial in the
    /// step length, and the cost at step length 0.
    costs: Vec<[PerWorld; 4]>,
    /// The cost of each cone along the search direction.
    along: Vec<Cone<PerWorld>>,
    hessian: Vec<PerWorld>,
    /// The factors with the second derivatives of cones.
    with_cones: Vec<PerWorld>,
    /// The Hessians of worlds whose factors are computed again.
    again: Vec<PerWorld>,
    /// The Jacobians of the rows that push, times the stiffness of each row; `pushing` has the
    /// indices of these rows.
    pushed: Vec<PerWorld>,
    pushing: Vec<usize>,
    /// For each world, the rows that became active or inactive in this iteration.
    changed: [Vec<usize>; WORLDS],
    line: Vec<line_search::Row>,
    course: row_costs::Course,
    /// `qfrc_smooth` of an island.
    smooth: Vec<PerWorld>,
    islands: Islands,
}

#[cfg(test)]
impl Newton {
    pub(super) fn poison(&mut self) {
        use crate::physics::work::Poison;
        for vector in [
            &mut self.acc,
            &mut self.ma,
            &mut self.grad,
            &mut self.mgrad,
            &mut self.search,
            &mut self.mv,
            &mut self.constraint,
            &mut self.row_update,
            &mut self.jar,
            &mut self.jv,
            &mut self.force,
            &mut self.quadratic,
            &mut self.pushes,
            &mut self.hessian,
            &mut self.with_cones,
            &mut self.again,
            &mut self.pushed,
            &mut self.smooth,
        ] {
            vector.poison();
        }
        self.costs.poison();
        self.islands.poison();
    }
}

/// Runs `$block` for the elements from `$first` to `$n` in groups of four; the last group may be
/// smaller. `$K` is the size of the group.
macro_rules! by_four {
    ($n:expr, $first:ident, $K:ident => $block:block) => {
        while $first < $n {
            match $n - $first {
                1 => {
                    const $K: usize = 1;
                    $block
                }
                2 => {
                    const $K: usize = 2;
                    $block
                }
                3 => {
                    const $K: usize = 3;
                    $block
                }
                _ => {
                    const $K: usize = 4;
                    $block
                }
            }
            $first += 4;
        }
    };
}
pub(super) use by_four;

/// Returns elements `first..first + K` of the sum of all vectors, each times its factor.
#[inline(always)]
pub(super) fn sums<'a, S: Simd, const K: usize>(
    at: At<S>,
    first: usize,
    terms: impl Iterator<Item = (&'a [PerWorld], &'a PerWorld)>,
) -> [Lanes<S>; K] {
    let mut sums = [same(at, 0.0); K];
    for (vector, factor) in terms {
        let Some(vector) = vector.get(first..).and_then(<[PerWorld]>::first_chunk::<K>) else {
            break;
        };
        let factor = load::<S>(at, factor);
        for k in 0..K {
            sums[k] = sums[k] + load(at, &vector[k]) * factor;
        }
    }
    sums
}

/// The result of a line search: for each world, the step length and the improvement of the cost.
type Found = [PerWorld; 2];

impl Newton {
    pub(super) fn new(m: &Model) -> Self {
        let (nv, rows) = (m.nv(), m.plan().bounds().rows_of_worlds());
        let dofs = || vec![PerWorld::ZERO; nv];
        let mut buffers = Self {
            acc: dofs(),
            ma: dofs(),
            grad: dofs(),
            mgrad: dofs(),
            search: dofs(),
            mv: dofs(),
            constraint: dofs(),
            row_update: dofs(),
            smooth: dofs(),
            islands: Islands::new(m),
            hessian: vec![PerWorld::ZERO; nv * nv],
            again: vec![PerWorld::ZERO; nv * nv],
            pushing: Vec::with_capacity(rows),
            changed: std::array::from_fn(|_| Vec::with_capacity(rows)),
            line: Vec::with_capacity(rows),
            ..Self::default()
        };
        if m.opt.cone == ConeType::Elliptic {
            let cones = m.plan().bounds().contacts;
            buffers.with_cones = vec![PerWorld::ZERO; nv * nv];
            buffers.along.reserve(cones);
            buffers.course.reserve(rows, cones);
        }
        buffers.reserve(nv, rows);
        buffers
    }

    /// Makes room for `rows` rows.
    fn reserve(&mut self, nv: usize, rows: usize) {
        for numbers in [
            &mut self.jar,
            &mut self.jv,
            &mut self.force,
            &mut self.quadratic,
            &mut self.pushes,
        ] {
            numbers.resize(rows, PerWorld::ZERO);
        }
        self.costs.resize(rows, [PerWorld::ZERO; 4]);
        self.pushed.resize(rows * nv, PerWorld::ZERO);
    }

    /// Returns the forces of the constraint rows.
    pub(super) fn forces(&self) -> &[PerWorld] {
        self.islands.forces().unwrap_or(&self.force)
    }

    /// Computes `qacc` and `qfrc_constraint` of all worlds that have rows.
    #[inline(always)]
    pub(super) fn solve<S: Simd>(
        &mut self,
        m: &Model,
        at: At<S>,
        a: &mut Arrays,
        rows: &Rows,
        live: u64,
    ) {
        let simd = at.0;
        if self.jar.len() < rows.used {
            self.reserve(m.nv(), rows.d.len());
        }
        let mut has = PerWorld::ZERO;
        for world in worlds(live, at.1) {
            has.0[world] = f64::from(rows.count[world] > 0);
        }
        simd.vectorize(
            #[inline(always)]
            || self.start(m, at, a, rows),
        );
        if m.ntree() > 1 {
            self.solve_islands(m, at, a, rows, &has);
            return;
        }
        let whole = std::mem::take(&mut self.islands.whole);
        self.smooth.copy_from_slice(&a.qfrc_smooth);
        self.iterate(m, at, a, rows, &whole, &has);
        self.islands.whole = whole;
        simd.vectorize(
            #[inline(always)]
            || {
                let has: Mask<S> = load::<S>(at, &has).gt(same(at, 0.5));
                for i in 0..m.nv() {
                    let (acc, smooth) = (load(at, &self.acc[i]), load(at, &a.qacc_smooth[i]));
                    store(at, &mut a.qacc[i], Lanes::select(has, acc, smooth));
                    let force = load(at, &self.constraint[i]);
                    let force = Lanes::select(has, force, same(at, 0.0));
                    store(at, &mut a.qfrc_constraint[i], force);
                }
            },
        );
    }

    /// Starts at the last step's accelerations, or at the accelerations without constraints if
    /// these have a lower cost.
    #[inline(always)]
    fn start<S: Simd>(&mut self, m: &Model, at: At<S>, a: &Arrays, rows: &Rows) {
        let (n, zero) = (m.nv(), same::<S>(at, 0.0));
        // `jv` holds the residuals without constraints here; later it holds `J search`
        rows.multiply(n, at, &a.qacc_smooth, Some(&rows.aref), &mut self.jv);
        rows.multiply(n, at, &a.warm, Some(&rows.aref), &mut self.jar);
        self.islands
            .whole
            .multiply(m, at, &a.qm, &a.warm, &mut self.ma);
        let all = (rows, m.revision);
        let (force, states) = (&mut self.force, &mut self.quadratic);
        let mut warm = forces(at, all, &self.jar, force, states);
        for i in 0..n {
            let force = load::<S>(at, &self.ma[i]) - load(at, &a.qfrc_smooth[i]);
            let apart = load::<S>(at, &a.warm[i]) - load(at, &a.qacc_smooth[i]);
            warm = warm + force * 0.5 * apart;
        }
        let mut cold = warm.gt(forces(at, all, &self.jv, force, states));
        if m.opt.disables(Disable::WarmStart) {
            cold = zero.le(zero);
        }
        for i in 0..n {
            let (smooth, warm) = (load(at, &a.qacc_smooth[i]), load(at, &a.warm[i]));
            store(at, &mut self.acc[i], Lanes::select(cold, smooth, warm));
        }
        if Lanes::<S>::any(cold) {
            self.islands
                .whole
                .multiply(m, at, &a.qm, &self.acc, &mut self.ma);
        }
        for (row, smooth) in self.jv[..rows.used].iter().enumerate() {
            let jar = Lanes::select(cold, load(at, smooth), load(at, &self.jar[row]));
            store(at, &mut self.jar[row], jar);
        }
    }

    #[inline(always)]
    fn iterate<S: Simd>(
        &mut self,
        m: &Model,
        at: At<S>,
        a: &Arrays,
        rows: &Rows,
        part: &Part,
        has: &PerWorld,
    ) {
        let simd = at.0;
        let mut control = Control {
            active: *has,
            ..Control::default()
        };
        loop {
            let go_on = simd.vectorize(
                #[inline(always)]
                || {
                    if control.iteration == 0 {
                        let mut inertia = same::<S>(at, 0.0);
                        for (i, _) in part.dofs() {
                            inertia = inertia + load(at, &a.qm[m.plan().m_diagonal(i)]);
                        }
                        store(at, &mut control.scale, inertia.same(1.0) / inertia);
                    }
                    self.update(at, (rows, m.revision), part.n);
                    if control.iteration == 0 {
                        let used = rows.used;
                        copy(at, &self.quadratic[..used], &mut self.pushes[..used]);
                    }
                    self.check(m, at, a, part, &mut control)
                },
            );
            if !go_on {
                return;
            }
            if control.iteration == 0 {
                simd.vectorize(
                    #[inline(always)]
                    || self.make_hessian(m, at, a, (rows, part), None),
                );
            } else {
                let mut again = PerWorld::ZERO;
                let anew = simd.vectorize(
                    #[inline(always)]
                    || self.update_hessian(at, (rows, part.n), &control.active, &mut again),
                );
                if anew {
                    simd.vectorize(
                        #[inline(always)]
                        || self.make_hessian(m, at, a, (rows, part), Some(&again)),
                    );
                }
            }
            let coned = !rows.cones.is_empty()
                && simd.vectorize(
                    #[inline(always)]
                    || self.add_cones(at, (rows, m.revision), part.n, &control.active),
                );
            let go_on = simd.vectorize(
                #[inline(always)]
                || self.direction(m, at, part.n, coned, &mut control),
            );
            if !go_on {
                return;
            }
            let mut found = [PerWorld::ZERO; 2];
            let stuck = simd.vectorize(
                #[inline(always)]
                || self.search(m, at, a, (rows, part), &control, &mut found),
            );
            self.finish_search(m, rows, stuck, &mut found, at.1);
            let go_on = simd.vectorize(
                #[inline(always)]
                || self.advance(at, rows, &mut control, &found),
            );
            if !go_on {
                return;
            }
        }
    }

    /// Computes the forces of the rows, the resulting forces on the joints, and the gradient.
    #[inline(always)]
    fn update<S: Simd>(&mut self, at: At<S>, all: (&Rows, Revision), n: usize) {
        let rows = all.0;
        forces(at, all, &self.jar, &mut self.force, &mut self.quadratic);
        let mut first = 0;
        by_four!(n, first, K => {
            let terms = rows.jac.chunks_exact(n).zip(&self.force[..rows.used]);
            let sums = sums::<S, K>(at, first, terms);
            for (i, sum) in (first..).zip(sums) {
                store(at, &mut self.constraint[i], sum);
                let grad = load::<S>(at, &self.ma[i]) - load(at, &self.smooth[i]) - sum;
                store(at, &mut self.grad[i], grad);
            }
        });
    }

    /// Returns the scaled reduction of the cost that a full Newton step predicts.
    #[inline(always)]
    fn decrement<S: Simd>(&self, at: At<S>, n: usize, scale: Lanes<S>) -> Lanes<S> {
        let x = scale * 0.5 * dot(at, &self.grad[..n], &self.mgrad[..n]);
        let zero = x.same(0.0);
        Lanes::select(x.gt(zero), x, zero)
    }

    /// Stops worlds with a small gradient or a small last improvement. Returns whether any world
    /// continues.
    #[inline(always)]
    fn check<S: Simd>(
        &mut self,
        m: &Model,
        at: At<S>,
        a: &Arrays,
        part: &Part,
        control: &mut Control,
    ) -> bool {
        let grad = &self.grad[..part.n];
        let tolerance = same(at, m.opt.tolerance);
        let (scale, zero) = (load::<S>(at, &control.scale), same(at, 0.0));
        let active: Mask<S> = load::<S>(at, &control.active).gt(zero);
        let length = dot(at, grad, grad).sqrt();
        let level = (scale * length).lt(tolerance);
        let stop = if control.iteration > 0 {
            let improvement = load(at, &control.improvement);
            level | (zero.lt(improvement) & improvement.lt(tolerance))
        } else {
            if Lanes::<S>::any(active & level) {
                // half of the gradient's square, in the norm of `M^-1`, bounds the possible
                // improvement
                self.mgrad[..part.n].copy_from_slice(grad);
                part.solve(m, at, a, &mut self.mgrad);
            }
            let one = zero.same(1.0);
            store(at, &mut control.level, Lanes::select(level, one, zero));
            level & self.decrement(at, part.n, scale).lt(tolerance)
        };
        control.keep(at, Lanes::<S>::but_not(active, stop))
    }

    /// Computes the search direction. Stops worlds with a small predicted improvement. Returns
    /// whether any world continues.
    #[inline(always)]
    fn direction<S: Simd>(
        &mut self,
        m: &Model,
        at: At<S>,
        n: usize,
        coned: bool,
        control: &mut Control,
    ) -> bool {
        self.mgrad[..n].copy_from_slice(&self.grad[..n]);
        let descending = m.revision.substitutes_by_columns();
        let factor = if coned {
            &self.with_cones
        } else {
            &self.hessian
        };
        cholesky_solve(at, n, factor, &mut self.mgrad, descending);
        if control.iteration == m.opt.iterations {
            return false;
        }
        let (scale, zero) = (load::<S>(at, &control.scale), same(at, 0.0));
        let mut small = self.decrement(at, n, scale).lt(same(at, m.opt.tolerance));
        if control.iteration == 0 {
            small &= load::<S>(at, &control.level).gt(zero);
        }
        for (search, mgrad) in self.search[..n].iter_mut().zip(&self.mgrad) {
            store(at, search, load::<S>(at, mgrad) * -1.0);
        }
        let active: Mask<S> = load::<S>(at, &control.active).gt(zero);
        control.keep(at, Lanes::<S>::but_not(active, small))
    }

    /// Moves each active world along its search direction. Returns whether any world continues.
    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        at: At<S>,
        rows: &Rows,
        control: &mut Control,
        found: &Found,
    ) -> bool {
        let zero = same::<S>(at, 0.0);
        let active: Mask<S> = load::<S>(at, &control.active).gt(zero);
        let alpha = load::<S>(at, &found[0]);
        let active = Lanes::<S>::but_not(active, alpha.abs().le(zero));
        let improvement = load::<S>(at, &control.scale) * load(at, &found[1]);
        store(at, &mut control.improvement, improvement);
        control.iteration += 1;
        let (step,) = (
            #[inline(always)]
            |to: &mut [PerWorld], along: &[PerWorld]| {
                for (to, along) in to.iter_mut().zip(along) {
                    let before = load::<S>(at, to);
                    let after = before + load::<S>(at, along) * alpha;
                    store(at, to, Lanes::select(active, after, before));
                }
            },
        );
        step(&mut self.acc, &self.search);
        step(&mut self.ma, &self.mv);
        step(&mut self.jar[..rows.used], &self.jv);
        control.keep(at, active)
    }
}

/// The state of the iteration.
#[derive(Clone, Copy, Debug, Default)]
struct Control {
    iteration: usize,
    /// 1 for each world that continues, 0 for the others.
    active: PerWorld,
    /// 1 for each world whose gradient was small at the start.
    level: PerWorld,
    scale: PerWorld,
    improvement: PerWorld,
}

impl Control {
    /// Sets `active`, and returns whether any world continues.
    #[inline(always)]
    fn keep<S: Simd>(&mut self, at: At<S>, active: Mask<S>) -> bool {
        let zero = same::<S>(at, 0.0);
        let ones = Lanes::select(active, zero.same(1.0), zero);
        store(at, &mut self.active, ones);
        Lanes::<S>::any(active)
    }
}
