//! Constraint rows or forces, world by world: of models whose constraints have no stages for several
//! worlds.

use fearless_simd::Simd;

use super::rows::worlds;
use super::{Arrays, At, PerWorld, Rows, WORLDS, copy, fits, same, store};
use crate::math::libm::wide;
use crate::physics::constraint::{Constraints, Kind};
use crate::physics::solver::cones::Shape;
use crate::physics::{fwd_constraint, make_constraint, reference_constraint, tendon};
use crate::{Data, Model};

/// The data of one world, whose rows are made, and perhaps solved, for each world in turn.
#[derive(Clone, Debug)]
pub(super) struct Alone {
    data: Box<Data>,
    /// The forces of the constraint rows, for all worlds.
    pub(super) force: Vec<PerWorld>,
    /// The rows of each world, if worlds solve together.
    made: Vec<Made>,
}

/// The rows of a world.
#[derive(Clone, Debug, Default)]
struct Made {
    efc: Constraints,
    /// The bits of the trees of each island.
    islands: Vec<u64>,
    /// For each tree, four bits: the first tree of its island.
    likeness: u64,
    /// The number of rows of equalities, of dry friction, of limits and pyramids, and of cones.
    kinds: [usize; 4],
}

impl Alone {
    pub(super) fn new(m: &Model) -> Self {
        let worlds = if fits::gathers(m) { WORLDS } else { 0 };
        let mut made = vec![Made::default(); worlds];
        for made in &mut made {
            made.efc.reserve(&m.plan().bounds(), m.nv(), false);
            made.islands.reserve(m.ntree());
        }
        Self {
            data: Box::new(Data::new(m)),
            force: Vec::new(),
            made,
        }
    }

    #[cfg(test)]
    pub(super) fn poison(&mut self) {
        use crate::physics::work::Poison;
        self.force.poison();
        self.data.work.poison();
    }

    /// Computes `qacc` and `qfrc_constraint` of the worlds in the register.
    pub(super) fn solve<S: Simd>(&mut self, m: &Model, at: At<S>, a: &mut Arrays, rows: &mut Rows) {
        let simd = at.0;
        simd.vectorize(
            #[inline(always)]
            || {
                copy(at, &a.qacc_smooth, &mut a.qacc);
                for force in &mut a.qfrc_constraint {
                    store(at, force, same(at, 0.0));
                }
            },
        );
        for world in worlds(rows.touched, at.1) {
            self.constrain(m, a, rows, world);
        }
    }

    /// Makes the constraint rows of world `world`, and computes its forces and accelerations.
    fn constrain(&mut self, m: &Model, a: &mut Arrays, rows: &mut Rows, world: usize) {
        let d = &mut *self.data;
        for (numbers, cells) in [
            (&mut d.qacc_warmstart[..], &a.warm[..]),
            (&mut d.qfrc_smooth, &a.qfrc_smooth),
            (&mut d.qacc_smooth, &a.qacc_smooth),
            (&mut d.qm, &a.qm),
            (&mut d.qld, &a.qld),
            (&mut d.qld_diag_inv, &a.qld_diag_inv),
        ] {
            take(numbers, cells, world);
        }
        self.make_world(m, a, rows, world, true);
        give(&self.data.qacc, &mut a.qacc, world);
        self.store(a, world);
    }

    /// Makes the rows of world `world` from its state and its contacts, and `solves` them.
    fn make_world(&mut self, m: &Model, a: &Arrays, rows: &mut Rows, world: usize, solves: bool) {
        let d = &mut *self.data;
        for (numbers, cells) in [
            (&mut d.qpos[..], &a.qpos[..]),
            (&mut d.qvel, &a.qvel),
            (d.cdof.as_flattened_mut(), a.cdof.as_flattened()),
            (
                d.subtree_com.as_flattened_mut(),
                a.subtree_com.as_flattened(),
            ),
            // tendons between sites follow from these
            (
                d.site_xpos.as_flattened_mut(),
                if m.plan().sites_read {
                    a.site_xpos.as_flattened()
                } else {
                    &[]
                },
            ),
        ] {
            take(numbers, cells, world);
        }
        std::mem::swap(&mut d.contact, &mut rows.contacts[world]);
        wide(
            (m, &mut *d),
            #[inline(always)]
            |(m, d)| make(m, d, solves),
            #[inline(always)]
            |(m, d)| make(m, d, solves),
        );
        std::mem::swap(&mut d.contact, &mut rows.contacts[world]);
        rows.count[world] = d.efc.nefc();
    }

    /// Returns a number that is equal for worlds with the same islands, if they solve together.
    pub(super) fn likeness(&self, world: usize) -> u64 {
        self.made.get(world).map_or(0, |made| made.likeness)
    }

    /// Makes the constraint rows of the worlds in the register, and moves them to `rows`. Rows of one
    /// kind have the same place in all worlds.
    pub(super) fn make(&mut self, m: &Model, a: &Arrays, rows: &mut Rows, first: usize) {
        let mut most = [0; 4];
        for world in worlds(rows.touched, first) {
            self.make_world(m, a, rows, world, false);
            let (d, made) = (&mut *self.data, &mut self.made[world]);
            made.note(d);
            std::mem::swap(&mut d.efc, &mut made.efc);
            for (most, rows) in most.iter_mut().zip(made.kinds) {
                *most = rows.max(*most);
            }
        }
        rows.pulls = [most[0], most[0] + most[1]];
        rows.dim = m.plan().pairs.first().map_or(0, |pair| pair.dim.into());
        rows.cones.clear();
        if most[3] > 0 {
            rows.cones.resize(most[3] / rows.dim, Shape::default());
        }
        for _ in 0..most.iter().sum() {
            rows.open_all(m.nv());
        }
        for world in worlds(rows.touched, first) {
            self.made[world].give(m.nv(), rows, world, most);
        }
    }

    /// Stores the forces of world `world`.
    fn store(&mut self, a: &mut Arrays, world: usize) {
        let (d, rows) = (&*self.data, self.data.efc.nefc());
        if self.force.len() < rows {
            self.force.resize(rows, PerWorld::ZERO);
        }
        give(&d.qfrc_constraint, &mut a.qfrc_constraint, world);
        give(&d.efc.force, &mut self.force, world);
    }
}

/// Makes the rows of a world, and `solves` them.
#[inline(always)]
fn make(m: &Model, d: &mut Data, solves: bool) {
    if m.plan().constraints.pulls_tendons() {
        tendon(m, d);
    }
    make_constraint(m, d);
    reference_constraint(m, d);
    if solves {
        fwd_constraint(m, d);
    }
}

impl Made {
    /// Counts the rows, and notes the islands.
    fn note(&mut self, d: &Data) {
        self.kinds = [0; 4];
        for block in &d.efc.blocks {
            self.kinds[block.kind as usize] += block.rows;
        }
        self.islands.clear();
        self.islands.resize(d.efc.nisland, 0);
        for (tree, &island) in d.work.tree_island.iter().enumerate() {
            if let Some(trees) = self.islands.get_mut(island) {
                *trees |= 1 << tree;
            }
        }
        self.likeness = d.work.tree_island.iter().fold(0, |bits, &island| {
            let trees = self.islands.get(island);
            bits << 4 | trees.map_or(15, |trees| u64::from(trees.trailing_zeros() & 15))
        });
    }

    /// Moves the rows to `rows`, where each kind has `most` rows.
    fn give(&self, nv: usize, rows: &mut Rows, world: usize, most: [usize; 4]) {
        let efc = &self.efc;
        // by how much the index of a row grows, for each kind
        let mut shifts = [0; 4];
        for kind in 1..4 {
            shifts[kind] = shifts[kind - 1] + most[kind - 1] - self.kinds[kind - 1];
        }
        for block in &efc.blocks {
            let shift = shifts[block.kind as usize];
            for own in block.row..block.row + block.rows {
                let row = own + shift;
                let jac = rows.jac[row * nv..(row + 1) * nv].iter_mut();
                for (to, x) in jac.zip(&efc.row(own)[..4 * block.groups]) {
                    to.0[world] = *x;
                }
                rows.d[row].0[world] = efc.d[own];
                rows.r[row].0[world] = efc.r[own];
                rows.aref[row].0[world] = efc.aref[own];
                rows.loss[row].0[world] = match block.kind {
                    Kind::Friction => efc.loss[own],
                    _ => 0.0,
                };
                rows.trees[row][world] = self.islands[block.island];
            }
        }
        let cones = self.kinds[..3].iter().sum::<usize>();
        for contact in &mut rows.contacts[world] {
            let Ok(row) = usize::try_from(contact.efc_address) else {
                continue;
            };
            let is_cone = row >= cones;
            if is_cone {
                let shape = Shape::new(contact, efc.d[row]);
                let place = &mut rows.cones[(row - cones) / rows.dim];
                place.each(&shape, |to, x| to.0[world] = *x);
            }
            let shift = shifts[if is_cone { 3 } else { 2 }];
            contact.efc_address = (row + shift) as i32;
        }
    }
}

/// Reads the numbers of world `world`.
fn take(numbers: &mut [f64], cells: &[PerWorld], world: usize) {
    for (x, cell) in numbers.iter_mut().zip(cells) {
        *x = cell.0[world];
    }
}

/// Writes the numbers of world `world`.
fn give(numbers: &[f64], cells: &mut [PerWorld], world: usize) {
    for (x, cell) in numbers.iter().zip(cells) {
        cell.0[world] = *x;
    }
}
