//! Projected Gauss-Seidel, world by world. The solver visits rows in an order that depends on the
//! number of rows, which differs between worlds.

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use super::{Arrays, At, PerWorld, Rows, copy, load, same, store, tree};
use crate::math::libm::wide;
use crate::physics::solver::forces_of_one_tree;
use crate::{Data, Model};

/// The solver of one world, which is called for each world in turn.
#[derive(Clone, Debug)]
pub(super) struct GaussSeidel {
    data: Box<Data>,
    /// The forces of the constraint rows, for all worlds.
    pub(super) force: Vec<PerWorld>,
}

impl GaussSeidel {
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

    /// Computes `qacc` and `qfrc_constraint` of the worlds in the register `at`.
    pub(super) fn solve<S: Simd>(&mut self, m: &Model, at: At<S>, a: &mut Arrays, rows: &Rows) {
        let (simd, first) = at;
        if self.force.len() < rows.used {
            self.force.resize(rows.used, PerWorld::default());
        }
        let mut has = PerWorld::ZERO;
        for world in first..first + Lanes::<S>::LANES {
            if rows.count[world] > 0 {
                has.0[world] = 1.0;
                self.forces(m, a, rows, world);
            } else {
                for force in &mut a.qfrc_constraint {
                    force.0[world] = 0.0;
                }
            }
        }
        simd.vectorize(
            #[inline(always)]
            || {
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

    /// Computes the forces of the constraint rows and `qfrc_constraint` of world `world`.
    fn forces(&mut self, m: &Model, a: &mut Arrays, rows: &Rows, world: usize) {
        let (d, nv, count) = (&mut *self.data, m.nv(), rows.count[world]);
        for i in 0..nv {
            let diagonal = m.plan().m_diagonal(i);
            d.qm[diagonal] = a.qm[diagonal].0[world];
        }
        for (numbers, rows) in [
            (&mut d.qld, &a.qld),
            (&mut d.qacc_smooth, &a.qacc_smooth),
            (&mut d.qacc_warmstart, &a.warm),
        ] {
            for (x, row) in numbers.iter_mut().zip(rows) {
                *x = row.0[world];
            }
        }
        d.efc.set_rows(
            count,
            nv,
            rows.jac[..count * nv].iter().map(|row| row.0[world]),
            |row| [&rows.d, &rows.r, &rows.aref].map(|numbers| numbers[row].0[world]),
        );
        wide(
            (m, &mut *d),
            #[inline(always)]
            |(m, d)| forces_of_one_tree(m, d),
            #[inline(always)]
            |(m, d)| forces_of_one_tree(m, d),
        );
        for (rows, numbers) in [
            (&mut a.qfrc_constraint, &d.qfrc_constraint),
            (&mut self.force, &d.efc.force),
        ] {
            for (row, x) in rows.iter_mut().zip(numbers) {
                row.0[world] = *x;
            }
        }
    }
}
