//! Projected Gauss-Seidel, world by world: the order in which it visits rows depends on their
//! number, which differs between worlds.

use super::{Arrays, Row, Rows, WORLDS};
use crate::libm::wide;
use crate::physics::solver::fwd_one_tree;
use crate::{Data, Model};

/// The solver of one world.
#[derive(Clone, Debug)]
pub(super) struct Alone {
    data: Box<Data>,
    /// The forces of the rows of all worlds.
    pub(super) force: Vec<Row>,
}

impl Alone {
    pub(super) fn new(m: &Model) -> Self {
        Self {
            data: Box::new(Data::new(m)),
            force: Vec::new(),
        }
    }

    /// `qacc` and `qfrc_constraint` of `lanes` worlds from the first one on.
    pub(super) fn solve(
        &mut self,
        m: &Model,
        a: &mut Arrays,
        rows: &Rows,
        (first, lanes): (usize, usize),
    ) {
        let d = &mut *self.data;
        if self.force.len() < rows.used {
            self.force.resize(rows.used, Row::default());
        }
        for world in first..(first + lanes).min(WORLDS) {
            let count = rows.count[world];
            if count == 0 {
                for (qacc, smooth) in a.qacc.iter_mut().zip(&a.qacc_smooth) {
                    qacc.0[world] = smooth.0[world];
                }
                for force in &mut a.qfrc_constraint {
                    force.0[world] = 0.0;
                }
                continue;
            }
            let of = |rows: &[Row], numbers: &mut [f64]| {
                for (x, row) in numbers.iter_mut().zip(rows) {
                    *x = row.0[world];
                }
            };
            of(&a.qm, &mut d.qm);
            of(&a.qld, &mut d.qld);
            of(&a.qld_diag_inv, &mut d.qld_diag_inv);
            of(&a.qacc_smooth, &mut d.qacc_smooth);
            of(&a.warm, &mut d.qacc_warmstart);
            let nv = m.nv();
            d.efc.set_rows(
                count,
                nv,
                |row| [&rows.d, &rows.r, &rows.aref].map(|numbers| numbers[row].0[world]),
                |row, dof| rows.jac[row * nv + dof].0[world],
            );
            wide(
                (m, &mut *d),
                #[inline(always)]
                |(m, d)| fwd_one_tree(m, d),
                #[inline(always)]
                |(m, d)| fwd_one_tree(m, d),
            );
            for (rows, numbers) in [
                (&mut a.qacc, &d.qacc),
                (&mut a.qfrc_constraint, &d.qfrc_constraint),
                (&mut self.force, &d.efc.force),
            ] {
                for (row, x) in rows.iter_mut().zip(numbers) {
                    row.0[world] = *x;
                }
            }
        }
    }
}
