//! Constraint forces: what accelerations become when constraints push back.

mod line_search;
pub(crate) mod newton;
pub(crate) mod pgs;

use super::constraint::put_rows;
use crate::model::Solver;
use crate::{Data, Model};

/// `qacc`, `qfrc_constraint` and the rows' forces: MuJoCo's `mj_fwdConstraint`.
pub fn fwd_constraint(m: &Model, d: &mut Data) {
    d.qfrc_constraint.fill(0.0);
    d.solver_niter.clear();
    if d.efc.nefc() == 0 {
        d.qacc.copy_from_slice(&d.qacc_smooth);
        d.solver_niter.push(0);
        return;
    }
    islands(m, d);
    match m.opt.solver {
        Solver::Newton => newton::solve(m, d),
        Solver::PGS => pgs::solve(m, d),
    }
}

/// Lists the degrees of freedom and the blocks of each island, in their order.
fn islands(m: &Model, d: &mut Data) {
    let (work, efc) = (&mut d.work, &d.efc);
    work.island_dofs.clear();
    work.island_blocks.clear();
    work.islands.clear();
    for island in 0..efc.nisland {
        let (dofs, blocks) = (work.island_dofs.len(), work.island_blocks.len());
        for (tree, range) in m.plan().trees.iter().enumerate() {
            if work.tree_island[tree] == island {
                work.island_dofs.extend(range.clone());
            }
        }
        for (index, block) in efc.blocks.iter().enumerate() {
            if block.island == island {
                work.island_blocks.push(index);
            }
        }
        work.islands
            .push(Island { dofs: dofs..work.island_dofs.len(), blocks: blocks..work.island_blocks.len() });
    }
}

/// Where the lists of an island are.
#[derive(Clone, Debug)]
pub(crate) struct Island {
    pub(crate) dofs: std::ops::Range<usize>,
    pub(crate) blocks: std::ops::Range<usize>,
}

/// `jar = J qacc - aref`, for all rows.
fn residuals(d: &Data, qacc: &[f64], jar: &mut [f64]) {
    let efc = &d.efc;
    for block in &efc.blocks {
        let along = efc.along(block, qacc);
        put_rows(block, along, jar);
    }
    for (jar, aref) in jar.iter_mut().zip(&efc.aref) {
        *jar -= aref;
    }
}

/// The cost of rows at their residuals: each pushes with its stiffness where it is violated.
fn cost_of_rows(d: &[f64], jar: &[f64]) -> f64 {
    let mut cost = 0.0;
    for (&d, &jar) in d.iter().zip(jar) {
        if jar < 0.0 {
            cost += 0.5 * d * jar * jar;
        }
    }
    cost
}

/// Half of `(M a - qfrc_smooth).(a - qacc_smooth)`: the cost of accelerating otherwise than without constraints.
fn gauss(ma: &[f64], smooth: &[f64], a: &[f64], a_smooth: &[f64], dofs: &[usize]) -> f64 {
    0.5 * dofs.iter().map(|&i| (ma[i] - smooth[i]) * (a[i] - a_smooth[i])).sum::<f64>()
}
