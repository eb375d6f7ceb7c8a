//! Constraint forces, world by world: of models whose constraints have no stages for several worlds.

use fearless_simd::Simd;

use super::rows::worlds;
use super::{Arrays, At, PerWorld, Rows, copy, same, store};
use crate::math::libm::wide;
use crate::physics::{fwd_constraint, make_constraint, reference_constraint, tendon};
use crate::{Data, Model};

/// The solver of one world, which is called for each world in turn.
#[derive(Clone, Debug)]
pub(super) struct Alone {
    data: Box<Data>,
    /// The forces of the constraint rows, for all worlds.
    pub(super) force: Vec<PerWorld>,
}

impl Alone {
    pub(super) fn new(m: &Model) -> Self {
        Self {
            data: Box::new(Data::new(m)),
            force: Vec::new(),
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
            (&mut d.qpos[..], &a.qpos[..]),
            (&mut d.qvel, &a.qvel),
            (&mut d.qacc_warmstart, &a.warm),
            (&mut d.qfrc_smooth, &a.qfrc_smooth),
            (&mut d.qacc_smooth, &a.qacc_smooth),
            (&mut d.qm, &a.qm),
            (&mut d.qld, &a.qld),
            (&mut d.qld_diag_inv, &a.qld_diag_inv),
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
            |(m, d)| constrain(m, d),
            #[inline(always)]
            |(m, d)| constrain(m, d),
        );
        std::mem::swap(&mut d.contact, &mut rows.contacts[world]);
        rows.count[world] = d.efc.nefc();
        give(&d.qacc, &mut a.qacc, world);
        self.store(a, world);
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

/// Makes the rows of the contacts and limits of a world, and solves them.
#[inline(always)]
fn constrain(m: &Model, d: &mut Data) {
    if m.plan().constraints.pulls_tendons() {
        tendon(m, d);
    }
    make_constraint(m, d);
    reference_constraint(m, d);
    fwd_constraint(m, d);
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
