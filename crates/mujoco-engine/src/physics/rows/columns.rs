//! The degrees of freedom of each row, for models whose sums leave out the others.

use crate::model::{Equality, EqualityType};
use crate::physics::constraint::Source;
use crate::{Data, Model};

/// Lists the degrees of freedom of each block, ascending: the `chain` of MuJoCo's
/// `mj_addConstraint`.
pub(super) fn list(m: &Model, d: &mut Data) {
    let (plan, efc) = (m.plan(), &mut d.efc);
    let columns = &mut efc.columns;
    columns.clear();
    for block in &mut efc.blocks {
        let start = columns.len();
        match block.source {
            Source::Equality(id) => {
                let mut equalities = plan.constraints.equalities.iter();
                if let Some(constraint) = equalities.find(|constraint| constraint.id == id) {
                    list_equality(m, constraint, columns);
                }
            }
            Source::DofFriction(dof) => columns.push(dof),
            Source::TendonFriction(t) | Source::TendonLimit(t) => {
                columns.extend_from_slice(&plan.paths.columns[plan.paths.rows[t].clone()]);
            }
            Source::Limit(joint) => {
                let first = m.jnt_dofadr[joint];
                columns.extend(first..first + m.jnt_type[joint].nv());
            }
            Source::Contact(index) => {
                let pair = &plan.pairs[d.contact[index].pair];
                columns.extend(pair.columns.iter().map(|column| column.dof));
            }
        }
        block.columns = start..columns.len();
    }
}

fn list_equality(m: &Model, constraint: &Equality, columns: &mut Vec<usize>) {
    let (plan, start) = (m.plan(), columns.len());
    let ids = [m.eq_obj1id[constraint.id], m.eq_obj2id[constraint.id]];
    for (k, id) in ids.into_iter().enumerate() {
        let Ok(object) = usize::try_from(id) else {
            continue;
        };
        match constraint.kind {
            EqualityType::Connect | EqualityType::Weld => {
                columns.extend_from_slice(plan.chain(constraint.bodies[k]));
            }
            EqualityType::Joint => columns.push(m.jnt_dofadr[object]),
            EqualityType::Tendon => {
                columns.extend_from_slice(&plan.paths.columns[plan.paths.rows[object].clone()]);
            }
        }
    }
    // two ascending lists: their elements once
    columns[start..].sort_unstable();
    let mut kept = start;
    for k in start..columns.len() {
        if kept == start || columns[kept - 1] != columns[k] {
            columns[kept] = columns[k];
            kept += 1;
        }
    }
    columns.truncate(kept);
}
