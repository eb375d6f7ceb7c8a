//! Projected Gauss-Seidel for several worlds: [`pgs`](crate::physics::solver::pgs), for models of one
//! tree whose only constraints are limits and pyramidal contacts.
//!
//! The matrix of the rows is made for all worlds at once. The sweeps visit rows in an order that depends on
//! their number, so each world sweeps by itself; the worlds take turns, row by row.

mod sweeps;

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use self::sweeps::{World, sweep};
use super::newton::{by_four, sums};
use super::rows::worlds;
use super::{Arrays, At, PerWorld, Rows, WORLDS, copy, load, same, store, tree};
use crate::Model;
use crate::physics::solver::orders::Orders;

/// The buffers of the method.
#[derive(Clone, Debug)]
pub(super) struct GaussSeidel {
    /// `(J L^-1 D^-1/2)'`: for each degree of freedom, its elements in every row.
    half: Vec<PerWorld>,
    /// The residuals of zero forces.
    b: Vec<PerWorld>,
    /// The residuals of the last step's accelerations.
    jar: Vec<PerWorld>,
    pub(super) force: Vec<PerWorld>,
    /// The worlds that have rows, sorted by the number of rows from the largest.
    worlds: Box<[World; WORLDS]>,
    orders: Orders,
}

impl GaussSeidel {
    pub(super) fn new(m: &Model) -> Self {
        let rows = m.plan().bounds().rows_of_worlds();
        let mut buffers = Self {
            half: Vec::new(),
            b: Vec::new(),
            jar: Vec::new(),
            force: Vec::new(),
            worlds: Box::new(std::array::from_fn(|_| World::new(rows))),
            orders: Orders::new(m.opt.iterations),
        };
        buffers.reserve(m.nv(), rows);
        buffers
    }

    /// Makes room for `rows` rows.
    #[cold]
    fn reserve(&mut self, nv: usize, rows: usize) {
        self.half.resize(rows * nv, PerWorld::ZERO);
        for numbers in [&mut self.b, &mut self.jar, &mut self.force] {
            numbers.resize(rows, PerWorld::ZERO);
        }
    }

    #[cfg(test)]
    pub(super) fn poison(&mut self) {
        use crate::physics::work::Poison;
        for numbers in [&mut self.half, &mut self.b, &mut self.jar, &mut self.force] {
            numbers.poison();
        }
        self.worlds.iter_mut().for_each(World::poison);
    }

    /// Computes `qacc` and `qfrc_constraint` of the worlds of `live`.
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
        if self.b.len() < rows.used {
            self.reserve(m.nv(), rows.d.len());
        }
        // sorted by the number of rows, from the largest
        let mut list = [0; WORLDS];
        let mut len = 0;
        for world in worlds(live, at.1).filter(|world| rows.count[*world] > 0) {
            let place =
                list[..len].partition_point(|other| rows.count[*other] >= rows.count[world]);
            list.copy_within(place..len, place + 1);
            (list[place], len) = (world, len + 1);
        }
        let list = &list[..len];
        let mut inertias = PerWorld::ZERO;
        simd.vectorize(
            #[inline(always)]
            || {
                self.start(m, at, a, rows);
                store(at, &mut inertias, inertia::<S>(m, at, a));
            },
        );
        for (own, &world) in self.worlds.iter_mut().zip(list) {
            self.orders.draw(rows.count[world]);
            own.begin(
                world,
                rows.count[world],
                rows.used / 4,
                1.0 / inertias.0[world],
            );
        }
        simd.vectorize(
            #[inline(always)]
            || {
                self.project(m, at, a, rows, list);
                for (own, &world) in self.worlds.iter_mut().zip(list) {
                    for row in 0..rows.count[world] {
                        own.set_row(row, self.b[row].0[world], self.force[row].0[world]);
                    }
                }
                sweep(m, simd, &mut self.worlds[..list.len()], &self.orders);
            },
        );
        for own in &self.worlds[..list.len()] {
            for (row, force) in self.force.iter_mut().zip(own.forces()) {
                row.0[own.index] = force;
            }
        }
        let mut has = PerWorld::ZERO;
        list.iter().for_each(|world| has.0[*world] = 1.0);
        simd.vectorize(
            #[inline(always)]
            || {
                let (nv, mut first) = (m.nv(), 0);
                by_four!(nv, first, K => {
                    let jac = rows.jac[..rows.used * nv].chunks_exact(nv);
                    let force = sums::<S, K>(at, first, jac.zip(&self.force));
                    for k in 0..K {
                        store(at, &mut a.qfrc_constraint[first + k], force[k]);
                    }
                });
                let has = load::<S>(at, &has).gt(same(at, 0.0));
                copy(at, &a.qfrc_constraint, &mut a.qacc);
                tree::solve(m, at, &a.qld, &a.qld_diag_inv, &mut a.qacc);
                for (qacc, smooth) in a.qacc.iter_mut().zip(&a.qacc_smooth) {
                    let smooth = load(at, smooth);
                    let pushed = load::<S>(at, qacc) + smooth;
                    store(at, qacc, Lanes::select(has, pushed, smooth));
                }
            },
        );
    }

    /// Computes the residuals, and the forces that the last step's accelerations cause.
    #[inline(always)]
    fn start<S: Simd>(&mut self, m: &Model, at: At<S>, a: &Arrays, rows: &Rows) {
        let nv = m.nv();
        rows.multiply(nv, at, &a.qacc_smooth, Some(&rows.aref), &mut self.b);
        rows.multiply(nv, at, &a.warm, Some(&rows.aref), &mut self.jar);
        for ((force, jar), d) in self.force[..rows.used]
            .iter_mut()
            .zip(&self.jar)
            .zip(&rows.d)
        {
            let (jar, d): (Lanes<S>, Lanes<S>) = (load(at, jar), load(at, d));
            let zero = jar.same(0.0);
            store(at, force, Lanes::select(jar.lt(zero), -d * jar, zero));
        }
    }

    /// Computes `J M^-1 J' + R` of the worlds in `list`. Zeros are not left out of sums, which changes no sum:
    /// these start at zero, so they are never -0.
    #[inline(always)]
    fn project<S: Simd>(&mut self, m: &Model, at: At<S>, a: &Arrays, rows: &Rows, list: &[usize]) {
        let (plan, nv, n) = (m.plan(), m.nv(), rows.used);
        let half = &mut self.half[..nv * n];
        for (row, jac) in rows.jac[..n * nv].chunks_exact(nv).enumerate() {
            for (half, x) in half.chunks_exact_mut(n).zip(jac) {
                store(at, &mut half[row], load::<S>(at, x));
            }
        }
        for i in (0..nv).rev() {
            let (above, rest) = half.split_at_mut(i * n);
            let own = &mut rest[..n];
            if m.dof_simplenum[i] == 0 {
                let row = plan.m_ancestors(i);
                for (&j, l) in plan.m_colind[row.clone()].iter().zip(&a.qld[row]) {
                    let factor = -load::<S>(at, l);
                    for (above, own) in above[j * n..(j + 1) * n].iter_mut().zip(&*own) {
                        store(at, above, load::<S>(at, above) + load(at, own) * factor);
                    }
                }
            }
            let diagonal: Lanes<S> = load(at, &a.qld[plan.m_diagonal(i)]);
            let scale = diagonal.same(1.0) / diagonal.sqrt();
            for x in own {
                store(at, x, load::<S>(at, x) * scale);
            }
        }
        for i in 0..n {
            let long = list.partition_point(|world| rows.count[*world] > i);
            let mut first = 0;
            by_four!(n, first, K => {
                let terms = half.chunks_exact(n).map(
                    #[inline(always)]
                    |half| (half, &half[i]),
                );
                let sums = sums::<S, K>(at, first, terms);
                let mut elements = [PerWorld::ZERO; 4];
                for (k, (element, sum)) in elements.iter_mut().zip(sums).enumerate() {
                    let is_diagonal = first + k == i;
                    store(at, element, if is_diagonal { sum + load(at, &rows.r[i]) } else { sum });
                }
                for (own, &world) in self.worlds.iter_mut().zip(&list[..long]) {
                    let four = elements.each_ref().map(|element| element.0[world]);
                    own.set_four(i, first / 4, four);
                }
            });
        }
    }
}

/// Returns the inertias that scale the improvements: see [`pgs`](crate::physics::solver::pgs).
#[inline(always)]
fn inertia<S: Simd>(m: &Model, at: At<S>, a: &Arrays) -> Lanes<S> {
    if !m.revision.stops_by_current_inertia() {
        return same(at, m.stat.meaninertia * m.nv() as f64);
    }
    (0..m.nv()).fold(
        same(at, 0.0),
        #[inline(always)]
        |sum, i| sum + load::<S>(at, &a.qm[m.plan().m_diagonal(i)]),
    )
}
