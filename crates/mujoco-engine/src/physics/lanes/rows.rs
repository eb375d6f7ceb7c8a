//! Constraint rows of several worlds. In each lane, the world's rows come first in the arrays; the
//! elements after the world's last row are zero.
//!
//! Limits, bounding spheres and contacts with planes are computed for all worlds at once. Other
//! contacts are rare, and are computed world by world.

use std::ops::Range;

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use super::tree::dot;
use super::{Arrays, At, PerWorld, WORLDS, fits, load, same, store};
use crate::math::number;
use crate::math::spatial::{add, column, dot as dot3, scale};
use crate::model::{Cone, GeomType, Pair, Softness};
use crate::physics::collision::{
    Places, Polytope, ROUNDING, above_plane, contact_at, frame, from_segments, touch,
};
use crate::physics::rows::{contact_jacobian, pyramid, regularization};
use crate::physics::solver::cones::Shape;
use crate::{Contact, Model};

/// Degrees of freedom, each with its column of the Jacobian of a constraint.
pub(super) type Moved = Vec<(usize, [PerWorld; 4])>;

/// The constraint rows of all worlds.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    /// The Jacobians, `nv` numbers for each row.
    pub(super) jac: Vec<PerWorld>,
    /// The stiffness of each row: MuJoCo's `efc_D` (inverse constraint mass).
    pub(super) d: Vec<PerWorld>,
    /// The regularisation of each row: `1 / d`.
    pub(super) r: Vec<PerWorld>,
    pub(super) aref: Vec<PerWorld>,
    /// The friction losses: 0 for rows that are not of dry friction.
    pub(super) loss: Vec<PerWorld>,
    /// The reference acceleration is `-damping * velocity - rest`.
    damping: Vec<PerWorld>,
    rest: Vec<PerWorld>,
    /// The trees on which each row acts: a bit for each tree, in each world.
    pub(super) trees: Vec<[u64; WORLDS]>,
    /// The number of rows of each world.
    pub(super) count: [usize; WORLDS],
    /// The largest element of `count`.
    pub(super) used: usize,
    /// The ends of the rows of equalities and of dry friction, which precede all others.
    pub(super) pulls: [usize; 2],
    /// The elliptic cones, whose rows are the last: `dim` for each cone.
    pub(super) cones: Vec<Shape<PerWorld>>,
    pub(super) dim: usize,
    /// The active contacts of each world. Contacts with planes are listed only if `keeps` or `lists`
    /// is true.
    pub(super) contacts: [Vec<Contact>; WORLDS],
    /// Whether [`make`](Self::make) only finds contacts, because each world makes rows of its own.
    pub(super) lists: bool,
    /// A bit for each world in the register: 1 if it may have rows. Only if `lists` is true.
    pub(super) touched: u64,
    /// Whether the environment reads contact forces after a step.
    keeps: bool,
    polytope: Polytope,
    /// A buffer: the degrees of freedom that move a contact or a tendon, each with its column of the
    /// Jacobian.
    moved: Moved,
}

/// Iterates over the worlds whose bits are set in `bits`. Bit 0 is world `first`.
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

/// Returns a bit for each world in the register: 1 if a capsule and a sphere or another capsule
/// cannot touch. `between` leads from the first centre to the second.
#[inline(always)]
fn apart<S: Simd>(m: &Model, at: At<S>, a: &Arrays, pair: &Pair, between: [Lanes<S>; 3]) -> u64 {
    let axes = pair.geom.map(
        #[inline(always)]
        |g| column(&number::get::<Lanes<S>, 9>(at, &a.geom_xmat[g]), 2),
    );
    let squares = from_segments(m, pair, between, axes).into_iter();
    squares.fold(
        0,
        #[inline(always)]
        |bits, (square, most)| bits | Lanes::<S>::bits(square.gt(square.same(most))),
    )
}

impl Rows {
    /// Allocates the rows. `keeps` is true if the environment reads contact forces after a step.
    pub(super) fn new(m: &Model, keeps: bool) -> Self {
        let (lists, gathers) = (!fits::makes_rows(m), fits::gathers(m));
        let (bounds, nv) = (m.plan().bounds(), m.nv());
        let mut buffers = Self {
            contacts: std::array::from_fn(|_| Vec::with_capacity(bounds.contacts)),
            moved: Vec::with_capacity(nv),
            keeps,
            lists,
            polytope: Polytope::new(m.plan().deep),
            ..Self::default()
        };
        if !lists || gathers {
            buffers.reserve(nv, bounds.rows_of_worlds());
        }
        if m.opt.cone == Cone::Elliptic {
            buffers.cones.reserve(bounds.contacts);
        }
        buffers
    }

    /// Makes room for `rows` rows.
    #[cold]
    pub(super) fn reserve(&mut self, nv: usize, rows: usize) {
        self.jac.resize(rows * nv, PerWorld::ZERO);
        self.trees.resize(rows, [0; WORLDS]);
        for column in self.columns() {
            column.resize(rows, PerWorld::ZERO);
        }
    }

    #[cfg(test)]
    pub(super) fn poison(&mut self) {
        use crate::physics::work::Poison;
        self.jac.poison();
        for column in self.columns() {
            column.poison();
        }
        self.polytope.poison();
    }

    fn columns(&mut self) -> [&mut Vec<PerWorld>; 6] {
        [
            &mut self.d,
            &mut self.r,
            &mut self.aref,
            &mut self.loss,
            &mut self.damping,
            &mut self.rest,
        ]
    }

    /// Builds the rows of the worlds in `live`: limits, then contacts. If `lists` is true, finds the
    /// contacts, and the worlds that may have rows.
    #[inline(always)]
    pub(super) fn make<S: Simd>(&mut self, m: &Model, at: At<S>, a: &Arrays, live: u64) {
        let (_, first) = at;
        self.used = 0;
        for world in first..first + Lanes::<S>::LANES {
            self.count[world] = 0;
            self.contacts[world].clear();
        }
        let (plan, nv) = (m.plan(), m.nv());
        if self.lists {
            let always = plan.constraints.can_pull();
            self.touched = if always { live } else { 0 };
        }
        for limit in &plan.limits {
            let q: Lanes<S> = load(at, &a.qpos[limit.qpos]);
            let [lower, upper] = limit.range;
            for (side, dist) in [(1.0, q - lower), (-1.0, q.same(upper) - q)] {
                let near = Lanes::<S>::bits(dist.lt(q.same(limit.margin))) & live;
                if near == 0 || self.lists {
                    self.touched |= near;
                    continue;
                }
                let mut dists = PerWorld::ZERO;
                store(at, &mut dists, dist);
                for world in worlds(near, first) {
                    let row = self.open(nv, world, 1 << limit.tree);
                    self.jac[row * nv + limit.dof].0[world] = side;
                    let stiff = (&limit.softness, limit.diag);
                    self.set_limit(row, world, stiff, (dists.0[world], limit.margin));
                }
            }
        }
        self.tendon_limits(m, at, a, live);
        for (index, reach) in plan.reaches.iter().enumerate() {
            let [g1, g2] = reach.geom;
            let (part,) = (
                #[inline(always)]
                |cells: &[PerWorld], k: usize| -> Lanes<S> { load(at, &cells[k]) },
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
            let height = dot3(between, along);
            let far = height.gt(height.same(reach.most));
            let near = !Lanes::<S>::bits(far) & live;
            if near == 0 {
                continue;
            }
            if let (GeomType::Plane, GeomType::Sphere | GeomType::Capsule) = plan.pairs[index].kind
            {
                self.touch_plane(m, at, a, index, near);
            } else {
                let near = match plan.pairs[index].kind {
                    (GeomType::Sphere | GeomType::Capsule, GeomType::Capsule) => {
                        near & !apart(m, at, a, &plan.pairs[index], between)
                    }
                    _ => near,
                };
                for world in worlds(near, first) {
                    self.touch(m, a, index, world);
                }
            }
        }
        if self.lists {
            for world in worlds(live, first) {
                self.touched |= u64::from(!self.contacts[world].is_empty()) << (world - first);
            }
        }
    }

    /// Adds the rows of the limits of tendons.
    #[inline(always)]
    fn tendon_limits<S: Simd>(&mut self, m: &Model, at: At<S>, a: &Arrays, live: u64) {
        for limit in &m.plan().constraints.tendon_limits {
            let (t, nv) = (limit.id, m.nv());
            let (length, margin) = (a.tendon_length::<S>(m, at, t), m.tendon_margin[t]);
            for (side, bound) in [-1.0, 1.0].into_iter().zip(m.tendon_range[t]) {
                let dist = (length.same(bound) - length) * side;
                let near = !Lanes::<S>::bits(length.same(margin).le(dist)) & live;
                if near == 0 || self.lists {
                    self.touched |= near;
                    continue;
                }
                let mut dists = PerWorld::ZERO;
                store(at, &mut dists, dist);
                let mut moved = std::mem::take(&mut self.moved);
                moved.clear();
                a.tendon_arms(m, at, t, &mut moved);
                for world in worlds(near, at.1) {
                    let moving = moved.iter().filter(|(_, arm)| arm[0].0[world] != 0.0);
                    let trees = moving.fold(0, |bits, (dof, _)| bits | 1 << m.dof_treeid[*dof]);
                    if trees == 0 {
                        continue;
                    }
                    let row = self.open(nv, world, trees);
                    for (dof, arm) in &moved {
                        self.jac[row * nv + dof].0[world] = arm[0].0[world] * -side;
                    }
                    let stiff = (&limit.softness, limit.diag);
                    self.set_limit(row, world, stiff, (dists.0[world], margin));
                }
                self.moved = moved;
            }
        }
    }

    /// Adds a row to a world, which acts on the trees of these bits. Returns its index.
    #[inline(always)]
    fn open(&mut self, nv: usize, world: usize, trees: u64) -> usize {
        let row = self.count[world];
        self.count[world] += 1;
        if row == self.used {
            self.open_all(nv);
        }
        self.trees[row][world] = trees;
        row
    }

    /// Adds a row of zeros to all worlds. Returns its index.
    #[inline(always)]
    pub(super) fn open_all(&mut self, nv: usize) -> usize {
        let row = self.used;
        if row == self.d.len() {
            self.reserve(nv, 2 * row + 32);
        }
        self.jac[row * nv..(row + 1) * nv].fill(PerWorld::ZERO);
        self.trees[row] = [0; WORLDS];
        for column in self.columns() {
            column[row] = PerWorld::ZERO;
        }
        self.used += 1;
        row
    }

    /// The rows of limits, and of contacts without an elliptic cone: they only push.
    #[inline(always)]
    pub(super) fn one_sided(&self) -> Range<usize> {
        self.pulls[1]..self.used - self.cones.len() * self.dim
    }

    /// The first row of a cone.
    #[inline(always)]
    pub(super) fn cone(&self, cone: usize) -> usize {
        self.used - (self.cones.len() - cone) * self.dim
    }

    /// Adds the rows of a contact to a world, and returns the index of the first row.
    #[inline(always)]
    fn open_contact(&mut self, nv: usize, pair: &Pair, dist: f64, world: usize) -> usize {
        let first = self.count[world];
        let softness = &pair.softness;
        let (impedance, _) = softness.impedance(dist, pair.includemargin);
        let (rows, r) = if pair.dim == 1 {
            (1, regularization(impedance, pair.diag))
        } else {
            let (diag, edge) = pyramid(pair.diag, pair.friction[0]);
            (4, edge(regularization(impedance, diag)))
        };
        let rest = softness.stiffness * impedance * (dist - pair.includemargin);
        let trees = pair
            .trees
            .iter()
            .flatten()
            .fold(0, |bits, tree| bits | 1 << tree);
        for _ in 0..rows {
            let row = self.open(nv, world, trees);
            self.set(row, world, r, softness.damping);
            self.rest[row].0[world] = rest;
        }
        first
    }

    /// Sets the numbers of the row of a limit at a distance.
    #[inline(always)]
    fn set_limit(
        &mut self,
        row: usize,
        world: usize,
        (softness, diag): (&Softness, f64),
        (dist, margin): (f64, f64),
    ) {
        let (impedance, _) = softness.impedance(dist, margin);
        self.set(
            row,
            world,
            regularization(impedance, diag),
            softness.damping,
        );
        self.rest[row].0[world] = softness.stiffness * impedance * (dist - margin);
    }

    #[inline(always)]
    fn set(&mut self, row: usize, world: usize, r: f64, damping: f64) {
        self.r[row].0[world] = r;
        self.d[row].0[world] = 1.0 / r;
        self.damping[row].0[world] = damping;
    }

    /// Adds the contacts of a plane with a sphere or capsule, and the contacts' rows, in the worlds
    /// in which the geoms are near each other.
    #[inline(always)]
    fn touch_plane<S: Simd>(&mut self, m: &Model, at: At<S>, a: &Arrays, index: usize, near: u64) {
        let (pair, nv) = (&m.plan().pairs[index], m.nv());
        if pair.trees == [None, None] {
            return;
        }
        let [plane, other] = pair.geom;
        let [radius, half, _] = m.geom_size[other];
        let normal = column(&number::get::<Lanes<S>, 9>(at, &a.geom_xmat[plane]), 2);
        let origin = number::get::<Lanes<S>, 3>(at, &a.geom_xpos[plane]);
        let centre = number::get::<Lanes<S>, 3>(at, &a.geom_xpos[other]);
        let round = pair.kind.1 == GeomType::Sphere;
        let axis = if round {
            number::of(at, [0.0; 3])
        } else {
            column(&number::get::<Lanes<S>, 9>(at, &a.geom_xmat[other]), 2)
        };
        let ends = if round { &[0.0][..] } else { &[half, -half] };
        let (end_above_plane,) = (
            #[inline(always)]
            |end: f64| {
                let centre = if round {
                    centre
                } else {
                    add(centre, scale(axis, end))
                };
                above_plane((origin, normal), centre, radius)
            },
        );
        let mut near = near;
        if pair.boxed {
            // MuJoCo's middle phase (see `Pair::boxed`) may drop a contact that touches only within
            // rounding errors: such worlds use the code for one world
            let mut shallow = 0;
            for end in ends {
                let (dist, _) = end_above_plane(*end);
                let touches = dist.le(dist.same(pair.margin));
                let deep = dist.le(dist.same(pair.margin - ROUNDING));
                shallow |= Lanes::<S>::bits(touches) & !Lanes::<S>::bits(deep);
            }
            for world in worlds(near & shallow, at.1) {
                self.touch(m, a, index, world);
            }
            near &= !shallow;
        }
        for end in ends {
            let (dist, pos) = end_above_plane(*end);
            let acts = dist.le(dist.same(pair.margin)) & dist.lt(dist.same(pair.includemargin));
            let acting = Lanes::<S>::bits(acts) & near;
            if acting == 0 {
                continue;
            }
            let frame = frame(at, normal, axis);
            let mut dists = PerWorld::ZERO;
            store(at, &mut dists, dist);
            if self.lists {
                self.list(at, (pair, index), acting, (&dists, pos, frame));
                continue;
            }
            let mu = if pair.dim == 1 { 0.0 } else { pair.friction[0] };
            self.moved.clear();
            let (moved,) = (&mut self.moved,);
            contact_jacobian(
                pair,
                (
                    #[inline(always)]
                    |dof: usize| number::get::<Lanes<S>, 6>(at, &a.cdof[dof]),
                    #[inline(always)]
                    |body: usize| number::get::<Lanes<S>, 3>(at, &a.subtree_com[body]),
                ),
                (pos, &frame, mu),
                #[inline(always)]
                |dof, values| {
                    let mut cells = [PerWorld::ZERO; 4];
                    number::put(at, values, &mut cells);
                    moved.push((dof, cells));
                },
            );
            let mut rows = [0; WORLDS];
            for world in worlds(acting, at.1) {
                rows[world] = self.open_contact(nv, pair, dists.0[world], world);
            }
            self.put_jacobian(at, nv, pair, acting, &rows);
            if self.keeps {
                self.list(at, (pair, index), acting, (&dists, pos, frame));
                for world in worlds(acting, at.1) {
                    if let Some(contact) = self.contacts[world].last_mut() {
                        (contact.mu, contact.efc_address) = (mu, rows[world] as i32);
                    }
                }
            }
        }
    }

    /// Lists a contact of the worlds in `acting`, without rows: distance, position and frame.
    #[inline(always)]
    fn list<S: Simd>(
        &mut self,
        at: At<S>,
        (pair, index): (&Pair, usize),
        acting: u64,
        (dists, pos, frame): (&PerWorld, [Lanes<S>; 3], [Lanes<S>; 9]),
    ) {
        let (mut points, mut frames) = ([PerWorld::ZERO; 3], [PerWorld::ZERO; 9]);
        number::put(at, pos, &mut points);
        number::put(at, frame, &mut frames);
        for world in worlds(acting, at.1) {
            let pos = points.each_ref().map(|row| row.0[world]);
            let frame = frames.each_ref().map(|row| row.0[world]);
            let contact = contact_at(pair, index, dists.0[world], pos, frame);
            self.contacts[world].push(contact);
        }
    }

    /// Writes the Jacobian of a contact for the worlds in `left`. `rows` has, for each world, the
    /// index of the contact's first row.
    #[inline(always)]
    fn put_jacobian<S: Simd>(
        &mut self,
        at: At<S>,
        nv: usize,
        pair: &Pair,
        mut left: u64,
        rows: &[usize; WORLDS],
    ) {
        let edges = if pair.dim == 1 { 1 } else { 4 };
        while left != 0 {
            let row = rows[at.1 + left.trailing_zeros() as usize];
            let (mut which, mut bits) = (PerWorld::ZERO, 0_u64);
            for world in worlds(left, at.1) {
                if rows[world] == row {
                    which.0[world] = 1.0;
                    bits |= 1 << (world - at.1);
                }
            }
            left &= !bits;
            let which = load::<S>(at, &which).gt(same(at, 0.0));
            for (dof, values) in &self.moved {
                for (edge, value) in values[..edges].iter().enumerate() {
                    let to = &mut self.jac[(row + edge) * nv + dof];
                    store(at, to, Lanes::select(which, load(at, value), load(at, to)));
                }
            }
        }
    }

    /// Adds the contacts of the pair of geoms `index`, and the contacts' rows, to world `world`.
    #[inline(never)]
    fn touch(&mut self, m: &Model, a: &Arrays, index: usize, world: usize) {
        let (pair, nv) = (&m.plan().pairs[index], m.nv());
        let of = |cells: &[PerWorld; 3]| cells.each_ref().map(|cell| cell.0[world]);
        let mat = |g: usize| a.geom_xmat[g].each_ref().map(|cell| cell.0[world]);
        let mats = pair.geom.map(mat);
        let frames = [0, 1].map(|k| (of(&a.geom_xpos[pair.geom[k]]), &mats[k]));
        let inertial = |body: usize| {
            let mat = a.ximat[body].each_ref().map(|cell| cell.0[world]);
            (of(&a.xipos[body]), mat)
        };
        let mut contacts = std::mem::take(&mut self.contacts[world]);
        let first = contacts.len();
        let places = Places {
            frames,
            inertial,
            geom: |g: usize| (of(&a.geom_xpos[g]), mat(g)),
            axes: &mut None,
        };
        touch(m, index, places, &mut self.polytope, &mut contacts);
        for contact in &mut contacts[first..] {
            if self.lists {
                break;
            }
            if contact.dist >= contact.includemargin || pair.trees == [None, None] {
                continue;
            }
            let row = self.open_contact(nv, pair, contact.dist, world);
            contact.efc_address = row as i32;
            if pair.dim > 1 {
                contact.mu = pair.friction[0];
            }
            let axis = |dof: usize| a.cdof[dof].each_ref().map(|cell| cell.0[world]);
            let frames = (axis, |body: usize| of(&a.subtree_com[body]));
            let jac = &mut self.jac[row * nv..];
            let edges = if pair.dim == 1 { 1 } else { 4 };
            let place = (contact.pos, &contact.frame, contact.mu);
            contact_jacobian(pair, frames, place, |dof, values| {
                for (edge, value) in values[..edges].iter().enumerate() {
                    jac[edge * nv + dof].0[world] = *value;
                }
            });
        }
        self.contacts[world] = contacts;
    }

    /// Computes the reference accelerations of all rows.
    #[inline(always)]
    pub(super) fn reference<S: Simd>(&mut self, m: &Model, at: At<S>, qvel: &[PerWorld]) {
        let nv = m.nv();
        for row in 0..self.used {
            let vel: Lanes<S> = dot(at, &self.jac[row * nv..(row + 1) * nv], qvel);
            let damping: Lanes<S> = load(at, &self.damping[row]);
            let aref = -damping * vel - load(at, &self.rest[row]);
            store(at, &mut self.aref[row], aref);
        }
    }

    /// Computes `J x`, or `J x - minus` if `minus` is given.
    #[inline(always)]
    pub(super) fn multiply<S: Simd>(
        &self,
        nv: usize,
        at: At<S>,
        x: &[PerWorld],
        minus: Option<&[PerWorld]>,
        out: &mut [PerWorld],
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
