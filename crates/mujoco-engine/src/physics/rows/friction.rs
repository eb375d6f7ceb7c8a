//! Rows of dry friction.

use super::{push_row, push_scalar, tendon_row};
use crate::model::Scalar;
use crate::physics::constraint::{Kind, Source, push_block, set_row};
use crate::{Data, Model};

/// Adds rows of dry friction: MuJoCo's `mj_instantiateFriction`.
#[inline(never)]
pub(super) fn friction(m: &Model, d: &mut Data) {
    let plan = m.plan();
    let constraints = &plan.constraints;
    for constraint in &constraints.dof_frictions {
        if plan.sleeps && !d.work.tree_awake[m.dof_treeid[constraint.id]] {
            continue;
        }
        let (dof, tree) = (constraint.id, m.dof_treeid[constraint.id]);
        let source = Source::DofFriction(dof);
        let row = push_block(&mut d.efc, source, Kind::Friction, 1, dof / 4 + 1, tree);
        set_row(&mut d.efc, row, dof, 1.0);
        push_friction(d, constraint);
    }
    for constraint in &constraints.tendon_frictions {
        let source = (Source::TendonFriction(constraint.id), Kind::Friction);
        if let Some(row) = push_scalar(m, d, false, &[Some(constraint.id)], source) {
            tendon_row(m, d, row, constraint.id, 1.0);
            push_friction(d, constraint);
        }
    }
}

fn push_friction(d: &mut Data, constraint: &Scalar) {
    let efc = &mut d.efc;
    push_row(efc, (&constraint.softness, constraint.diag), 0.0, 0.0);
    let row = efc.nefc() - 1;
    efc.kbip[row][0] = 0.0;
    efc.loss.resize(row + 1, 0.0);
    efc.loss[row] = constraint.loss;
}
