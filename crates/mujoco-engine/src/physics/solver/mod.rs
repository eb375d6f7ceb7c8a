//! Constraint forces, and the resulting accelerations.
//!
//! | file | what |
//! |---|---|
//! | `newton`, `conjugate` | MuJoCo's solvers Newton and CG, on accelerations; `line_search`, `cholesky`, `sparse` and `buffers` are theirs |
//! | `pgs` | the solver PGS, on forces; `dual` for rows other than limits and pyramidal contacts, `sweep` and `orders` of the rows |
//! | `row_costs` | costs and forces of rows, for Newton and CG |
//! | `cones` | the same for elliptic friction cones, in one world or in several |
//! | `qcqp` | the friction in an elliptic cone, for PGS and `noslip` |
//! | `noslip` | the iterations that suppress slip |

pub(crate) mod buffers;
mod cholesky;
pub(super) mod cones;
mod conjugate;
mod dual;
pub(super) mod line_search;
mod newton;
mod noslip;
pub(super) mod orders;
pub(crate) mod pgs;
mod qcqp;
pub(super) mod row_costs;
mod sparse;
pub(super) mod sweep;

use std::ops::Range;

use super::constraint::Constraints;
use crate::math::dense::{self, Lanes};
use crate::model::Solver;
use crate::{Data, Model};

/// Computes `qacc`, `qfrc_constraint` and the rows' forces: MuJoCo's `mj_fwdConstraint`.
#[inline(always)]
pub fn fwd_constraint(m: &Model, d: &mut Data) {
    d.qfrc_constraint.fill(0.0);
    d.solver_niter.clear();
    if d.efc.nefc() == 0 {
        d.qacc.copy_from_slice(&d.qacc_smooth);
        return;
    }
    let mut b = std::mem::take(&mut d.efc.b);
    residuals(m, &d.efc, &d.qacc_smooth, &mut d.work.dofs, &mut b);
    d.efc.b = b;
    islands(m, d);
    match m.opt.solver {
        Solver::PGS => pgs::solve(m, d),
        _ => newton::solve(m, d),
    }
    if m.opt.noslip_iterations > 0 {
        noslip::solve(m, d);
    }
}

/// Lists the trees and the blocks of each island, in the order of their indices.
fn islands(m: &Model, d: &mut Data) {
    let (work, efc) = (&mut d.work, &d.efc);
    work.island_trees.clear();
    work.island_blocks.clear();
    work.islands.clear();
    for island in 0..efc.nisland {
        let (trees, blocks) = (work.island_trees.len(), work.island_blocks.len());
        work.island_trees
            .extend((0..m.ntree()).filter(|&tree| work.tree_island[tree] == island));
        let all = efc.blocks.iter().enumerate();
        let own = all.filter(|(_, block)| block.island == island);
        work.island_blocks.extend(own.map(|(index, _)| index));
        work.islands.push(Island {
            trees: trees..work.island_trees.len(),
            blocks: blocks..work.island_blocks.len(),
        });
    }
}

/// The ranges of an island in `island_trees` and `island_blocks`.
#[derive(Clone, Debug)]
pub(crate) struct Island {
    trees: Range<usize>,
    blocks: Range<usize>,
}

/// Computes the rows' forces at `qacc`: MuJoCo's `mj_constraintUpdate`.
pub(super) fn forces_at(m: &Model, d: &mut Data) {
    let (efc, b) = (&mut d.efc, &mut d.work.newton);
    b.jar.resize(efc.nefc(), 0.0);
    residuals(m, efc, &d.qacc, &mut d.work.dofs, &mut b.jar);
    let row_costs = row_costs::RowCosts {
        blocks: &efc.blocks,
        d: &efc.d,
        r: &efc.r,
        loss: &efc.loss,
        contacts: &d.contact,
        revision: m.revision,
    };
    b.states.resize(b.jar.len(), row_costs::State::Satisfied);
    row_costs.update(&b.jar, &mut efc.force, &mut b.states, &mut b.cones);
}

/// Computes `qfrc_constraint`: the forces of all rows on the degrees of freedom.
#[inline(always)]
pub(super) fn add_forces(m: &Model, d: &mut Data) {
    let sum = &mut d.work.dofs;
    sum.fill([0.0; 4]);
    let rows = d.efc.jacobian().chunks_exact(d.efc.stride().max(1));
    for (row, &force) in rows.zip(&d.efc.force) {
        if force != 0.0 {
            dense::add_scaled(sum, row, force);
        }
    }
    d.qfrc_constraint
        .copy_from_slice(&sum.as_flattened()[..m.nv()]);
}

/// Computes `jar = J qacc - aref` for all rows; `x` is a buffer.
#[inline(always)]
fn residuals(m: &Model, efc: &Constraints, qacc: &[f64], x: &mut [Lanes], jar: &mut [f64]) {
    dense::put(x, qacc);
    efc.multiply(x, m.nv(), jar);
    for (jar, aref) in jar.iter_mut().zip(&efc.aref) {
        *jar -= aref;
    }
}

/// Returns the cost of rows with the residuals `jar`, for rows that only push (limits, and contacts
/// without elliptic cones).
#[inline(always)]
fn cost_of_rows(d: &[f64], jar: &[f64]) -> f64 {
    let mut cost = 0.0;
    for (&d, &jar) in d.iter().zip(jar) {
        if jar < 0.0 {
            cost += 0.5 * d * jar * jar;
        }
    }
    cost
}
