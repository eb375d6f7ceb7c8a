//! Geoms that stick: a constant attraction along the normals of their contacts, also within the gap.

use crate::math::spatial::{add, cross, dot, rotation, sub};
use crate::model::Cone;
use crate::{Data, Model};

/// Adds the attraction to `qfrc_passive`: MuJoCo's `mj_adhesion`.
#[cold]
#[inline(never)]
pub(super) fn pull(m: &Model, d: &mut Data) {
    let forces = &mut d.work.fluid;
    forces.fill(0.0);
    for contact in &d.contact {
        let pair = &m.plan().pairs[contact.pair];
        if pair.adhesion == 0.0 {
            continue;
        }
        let [x, y, z, ..] = contact.frame;
        for column in &pair.columns {
            let c = &d.cdof[column.dof];
            let offset = sub(contact.pos, d.subtree_com[column.root]);
            let moves = add([c[3], c[4], c[5]], cross(rotation(c), offset));
            let along = dot([x, y, z], moves) * column.sign + 0.0;
            forces[column.dof] += along * -pair.adhesion;
        }
    }
    for (sum, force) in d.qfrc_passive.iter_mut().zip(&*forces) {
        *sum += force;
    }
}

/// Shifts the reference accelerations of contacts that stick, so that they are as deep as others
/// under the same load: MuJoCo's `mj_adhesionRef`.
#[cold]
#[inline(never)]
pub(super) fn shift_references(m: &Model, d: &mut Data) {
    let elliptic = m.opt.cone == Cone::Elliptic;
    for contact in &d.contact {
        let adhesion = m.plan().pairs[contact.pair].adhesion;
        let Ok(row) = usize::try_from(contact.efc_address) else {
            continue;
        };
        if adhesion == 0.0 {
            continue;
        }
        let rows = if contact.dim == 1 || elliptic {
            1
        } else {
            2 * (usize::from(contact.dim) - 1)
        };
        let part = adhesion / rows as f64;
        for row in row..row + rows {
            d.efc.aref[row] += d.efc.r[row] * part;
        }
    }
}
