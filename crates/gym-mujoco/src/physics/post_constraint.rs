//! Forces of contacts on bodies.

use super::spatial::{add_to, cross, join, rotate_back, sub};
use crate::{Data, Model};

/// Computes `cfrc_ext` from the contacts of the last forward call: the part of MuJoCo's
/// `mj_rnePostConstraint` that tasks read.
pub fn rne_post_constraint(m: &Model, d: &mut Data) {
    d.contact_forces = true;
    d.cfrc_ext.fill([0.0; 6]);
    for contact in &d.contact {
        let Ok(row) = usize::try_from(contact.efc_address) else {
            continue;
        };
        let f = &d.efc.force;
        let along = match contact.dim {
            1 => f.get(row).map(|&n| [n, 0.0, 0.0]),
            _ => f.get(row..row + 4).map(|f| {
                let mu = contact.mu;
                [
                    f[0] + f[1] + f[2] + f[3],
                    (f[0] - f[1]) * mu,
                    (f[2] - f[3]) * mu,
                ]
            }),
        };
        let Some(along) = along else { continue };
        let force = rotate_back(&contact.frame, along);
        for (geom, sign) in [(contact.geom[0], -1.0), (contact.geom[1], 1.0)] {
            let body = m.geom_bodyid[geom];
            if body > 0 {
                let offset = sub(contact.pos, d.subtree_com[m.body_rootid[body]]);
                add_to(
                    &mut d.cfrc_ext[body],
                    &join(cross(offset, force), force),
                    sign,
                );
            }
        }
    }
}
