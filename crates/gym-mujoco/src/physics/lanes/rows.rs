//! Rows of constraints of several worlds. Each world has its own number of rows: the rows of a
//! world are its first ones, and what is beyond them is zero.
//!
//! Limits and bounding spheres are tested for all worlds at once. The contacts and rows that they
//! find are few, and different in each world, so they are made world by world.

use fearless_simd::Simd;
use gym_core::math::{Lanes, Real};

use super::tree::dot;
use super::{Arrays, Place, Row, WORLDS, load, store};
use crate::model::Softness;
use crate::physics::collision::{Polytope, touch};
use crate::physics::constraint::{contact_jacobian, pyramid, regularization};
use crate::{Contact, Model};

/// The rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    /// The Jacobians, `nv` numbers for each row.
    pub(super) jac: Vec<Row>,
    /// Stiffness that the solver sees.
    pub(super) d: Vec<Row>,
    pub(super) aref: Vec<Row>,
    /// Damping, and the acceleration at rest.
    damping: Vec<Row>,
    rest: Vec<Row>,
    /// The number of rows of each world.
    pub(super) count: [usize; WORLDS],
    /// The largest of these numbers.
    pub(super) used: usize,
    pub(super) contacts: [Vec<Contact>; WORLDS],
    polytope: Polytope,
}

/// The worlds whose bits are set, of those from `first` on.
#[inline(always)]
pub(super) fn worlds(mut bits: u64, first: usize) -> impl Iterator<Item = usize> {
    std::iter::from_fn(
        #[inline(always)]
        move || {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits.wrapping_sub(1);
            (lane < 64).then_some(first + lane)
        },
    )
}

impl Rows {
    pub(super) fn new(m: &Model) -> Self {
        let (bounds, nv) = (m.plan().bounds(), m.nv());
        let rows = || vec![Row::ZERO; bounds.rows];
        Self {
            jac: vec![Row::ZERO; bounds.rows * nv],
            d: rows(),
            aref: rows(),
            damping: rows(),
            rest: rows(),
            contacts: std::array::from_fn(|_| Vec::with_capacity(bounds.contacts)),
            polytope: if m.plan().pairs.iter().any(crate::model::Pair::is_convex) {
                Polytope::new()
            } else {
                Polytope::default()
            },
            ..Self::default()
        }
    }

    /// Makes the rows of the worlds in `live`: limits, then contacts.
    #[inline(always)]
    pub(super) fn make<S: Simd>(&mut self, m: &Model, at: Place<S>, a: &Arrays, live: u64) {
        let (_, first) = at;
        self.used = 0;
        for world in first..first + Lanes::<S>::LANES {
            self.count[world] = 0;
            self.contacts[world].clear();
        }
        let (plan, nv) = (m.plan(), m.nv());
        for limit in &plan.limits {
            let q: Lanes<S> = load(at, &a.qpos[limit.qpos]);
            let [lower, upper] = limit.range;
            for (side, dist) in [(1.0, q - lower), (-1.0, q.same(upper) - q)] {
                let near = Lanes::<S>::bits(dist.lt(q.same(limit.margin))) & live;
                if near == 0 {
                    continue;
                }
                let mut dists = Row::ZERO;
                store(at, &mut dists, dist);
                for world in worlds(near, first) {
                    let place = (self.open(nv, world), world);
                    self.jac[place.0 * nv + limit.dof].0[world] = side;
                    let (softness, dist) = (&limit.softness, dists.0[world]);
                    let (impedance, _) = softness.impedance(dist, limit.margin);
                    let r = regularization(impedance, limit.diag);
                    self.set(place, softness, impedance, dist - limit.margin, 1.0 / r);
                }
            }
        }
        for (index, reach) in plan.reaches.iter().enumerate() {
            let [g1, g2] = reach.geom;
            let (part,) = (
                #[inline(always)]
                |cells: &[Row], k: usize| -> Lanes<S> { load(at, &cells[k]) },
            );
            let between = [0, 1, 2].map(
                #[inline(always)]
                |k| part(&a.geom_xpos[g2], k) - part(&a.geom_xpos[g1], k),
            );
            let along = if reach.plane {
                [2, 5, 8].map(
                    #[inline(always)]
                    |k| part(&a.geom_xmat[g1], k),
                )
            } else {
                between
            };
            let height = crate::physics::spatial::dot(between, along);
            let far = height.gt(height.same(reach.most));
            for world in worlds(!Lanes::<S>::bits(far) & live, first) {
                self.touch(m, a, index, world);
            }
        }
    }

    /// Opens the next row of a world.
    #[inline(always)]
    fn open(&mut self, nv: usize, world: usize) -> usize {
        let row = self.count[world];
        self.count[world] += 1;
        if row == self.used {
            self.jac[row * nv..(row + 1) * nv].fill(Row::ZERO);
            for column in [&mut self.d, &mut self.damping, &mut self.rest] {
                column[row] = Row::ZERO;
            }
            self.used += 1;
        }
        row
    }

    #[inline(always)]
    fn set(
        &mut self,
        (row, world): (usize, usize),
        softness: &Softness,
        impedance: f64,
        beyond: f64,
        d: f64,
    ) {
        self.d[row].0[world] = d;
        self.damping[row].0[world] = softness.damping;
        self.rest[row].0[world] = softness.stiffness * impedance * beyond;
    }

    /// Adds the contacts of a pair of geoms in one world, and their rows.
    #[inline(never)]
    fn touch(&mut self, m: &Model, a: &Arrays, index: usize, world: usize) {
        let (pair, nv) = (&m.plan().pairs[index], m.nv());
        let of = |cells: &[Row; 3]| cells.each_ref().map(|cell| cell.0[world]);
        let mats = pair
            .geom
            .map(|g| a.geom_xmat[g].each_ref().map(|cell| cell.0[world]));
        let frames = [0, 1].map(|k| (of(&a.geom_xpos[pair.geom[k]]), &mats[k]));
        let inertial = |body: usize| {
            let mat = a.ximat[body].each_ref().map(|cell| cell.0[world]);
            (of(&a.xipos[body]), mat)
        };
        let first = self.contacts[world].len();
        touch(
            m,
            index,
            (frames, inertial),
            &mut self.polytope,
            &mut self.contacts[world],
        );
        for k in first..self.contacts[world].len() {
            let contact = &mut self.contacts[world][k];
            if contact.dist >= contact.includemargin || pair.trees == [None, None] {
                continue;
            }
            let row = self.count[world];
            contact.efc_address = row as i32;
            contact.mu = if contact.dim == 1 {
                0.0
            } else {
                contact.friction[0]
            };
            let contact = contact.clone();
            let beyond = contact.dist - contact.includemargin;
            let (impedance, _) = pair.softness.impedance(contact.dist, contact.includemargin);
            let (rows, r) = if contact.dim == 1 {
                (1, regularization(impedance, pair.diag))
            } else {
                let (diag, edge) = pyramid(pair.diag, contact.mu);
                (4, edge(regularization(impedance, diag)))
            };
            for _ in 0..rows {
                let place = (self.open(nv, world), world);
                self.set(place, &pair.softness, impedance, beyond, 1.0 / r);
            }
            let axis = |dof: usize| a.cdof[dof].each_ref().map(|cell| cell.0[world]);
            let frames = (axis, |body: usize| of(&a.subtree_com[body]));
            let jac = &mut self.jac[row * nv..];
            contact_jacobian(pair, frames, &contact, |edge, dof, value| {
                jac[edge * nv + dof].0[world] = value;
            });
        }
    }

    /// Reference accelerations of all rows.
    #[inline(always)]
    pub(super) fn reference<S: Simd>(&mut self, m: &Model, at: Place<S>, qvel: &[Row]) {
        let nv = m.nv();
        for row in 0..self.used {
            let vel: Lanes<S> = dot(at, &self.jac[row * nv..(row + 1) * nv], qvel);
            let damping: Lanes<S> = load(at, &self.damping[row]);
            let aref = -damping * vel - load(at, &self.rest[row]);
            store(at, &mut self.aref[row], aref);
        }
    }

    /// `J x`, or with `minus` `J x - minus`.
    #[inline(always)]
    pub(super) fn multiply<S: Simd>(
        &self,
        nv: usize,
        at: Place<S>,
        x: &[Row],
        minus: Option<&[Row]>,
        out: &mut [Row],
    ) {
        for (row, out) in out[..self.used].iter_mut().enumerate() {
            let mut product: Lanes<S> = dot(at, &self.jac[row * nv..(row + 1) * nv], x);
            if let Some(minus) = minus {
                product = product - load(at, &minus[row]);
            }
            store(at, out, product);
        }
    }
}
