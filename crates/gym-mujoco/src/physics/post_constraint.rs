//! Forces on bodies, and their accelerations, once constraint forces are known.

use super::constraint::Source;
use super::contact_force::force_of;
use super::rows;
use super::spatial::{Vec3, add_to, cross, cross_force, join, mul_inertia, rotate_back, sub};
use super::velocity::{along, dofs};
use crate::model::EqualityType;
use crate::{Contact, Data, Model, Revision};

/// Computes `cfrc_ext` from the contacts of the last forward call, then `cacc` and `cfrc_int`:
/// MuJoCo's `mj_rnePostConstraint`.
pub fn rne_post_constraint(m: &Model, d: &mut Data) {
    d.contact_forces = true;
    contacts(m, d);
    equalities(m, d);
    if m.plan().internal {
        internal(m, d);
    }
}

/// Sums external forces and contact forces on bodies, about the centres of mass of their trees.
fn contacts(m: &Model, d: &mut Data) {
    d.cfrc_ext.fill([0.0; 6]);
    let pushed = if d.is_pushed() { m.nbody() } else { 0 };
    for b in 1..pushed {
        let [x, y, z, roll, pitch, yaw] = d.xfrc_applied[b];
        if d.xfrc_applied[b] != [0.0; 6] {
            let offset = sub(d.subtree_com[m.body_rootid[b]], d.xipos[b]);
            let force = [x, y, z];
            d.cfrc_ext[b] = join(sub([roll, pitch, yaw], cross(offset, force)), force);
        }
    }
    let com = |body: usize| d.subtree_com[body];
    for contact in &d.contact {
        let Ok(row) = usize::try_from(contact.efc_address) else {
            continue;
        };
        let edge = |k: usize| d.efc.force.get(row + k).copied();
        push_apart(m, contact, edge, com, &mut d.cfrc_ext);
    }
}

/// Adds the force of a contact to the forces on its two bodies. `edge` gives the forces of its
/// rows, `com` the centres of mass of trees.
pub(super) fn push_apart(
    m: &Model,
    contact: &Contact,
    edge: impl Fn(usize) -> Option<f64>,
    com: impl Fn(usize) -> Vec3,
    cfrc_ext: &mut [[f64; 6]],
) {
    let f = force_of(m, contact, edge);
    let force = rotate_back(&contact.frame, [f[0], f[1], f[2]]);
    let torque = rotate_back(&contact.frame, [f[3], f[4], f[5]]);
    for (geom, sign) in [(contact.geom[0], -1.0), (contact.geom[1], 1.0)] {
        let body = m.geom_bodyid[geom];
        if body > 0 {
            let offset = sub(com(m.body_rootid[body]), contact.pos);
            let about = sub(torque, cross(offset, force));
            add_to(&mut cfrc_ext[body], &join(about, force), sign);
        }
    }
}

/// Adds the forces of connect and weld constraints on bodies.
fn equalities(m: &Model, d: &mut Data) {
    for block in &d.efc.blocks {
        let Source::Equality(id) = block.source else {
            continue;
        };
        let Some(constraint) = m.plan().constraints.of_bodies(id) else {
            continue;
        };
        let weld = constraint.kind == EqualityType::Weld;
        let three = |first: usize| -> Vec3 { std::array::from_fn(|k| d.efc.force[first + k]) };
        let force = three(block.row);
        let torque = if weld { three(block.row + 3) } else { [0.0; 3] };
        let torque = if weld && m.revision == Revision::V4_0 {
            rows::weld_torque(m, d, constraint, torque)
        } else {
            torque
        };
        let points = rows::anchors(m, d, constraint);
        for (k, sign) in [(0, 1.0), (1, -1.0)] {
            let body = constraint.bodies[k];
            if body > 0 {
                let offset = sub(d.subtree_com[m.body_rootid[body]], points[k]);
                let about = sub(torque, cross(offset, force));
                add_to(&mut d.cfrc_ext[body], &join(about, force), sign);
            }
        }
    }
}

/// Computes the forces between bodies and their parents.
fn internal(m: &Model, d: &mut Data) {
    let g = m.plan().gravity;
    d.cacc[0] = [0.0, 0.0, 0.0, -g[0], -g[1], -g[2]];
    d.cfrc_int[0] = [0.0; 6];
    for b in 1..m.nbody() {
        let own = dofs(m, b);
        let mut acceleration = d.cacc[m.body_parentid[b]];
        let parts = [(&d.cdof_dot, &d.qvel), (&d.cdof, &d.qacc)];
        for (axes, rates) in parts {
            let sum = along::<f64>((), axes, rates, own.clone());
            add_to(&mut acceleration, &sum, 1.0);
        }
        d.cacc[b] = acceleration;
        let mut force = mul_inertia(&d.cinert[b], &acceleration);
        let momentum = mul_inertia(&d.cinert[b], &d.cvel[b]);
        add_to(&mut force, &cross_force(&d.cvel[b], &momentum), 1.0);
        d.cfrc_int[b] = std::array::from_fn(|k| force[k] - d.cfrc_ext[b][k]);
    }
    for b in (1..m.nbody()).rev() {
        let force = d.cfrc_int[b];
        add_to(&mut d.cfrc_int[m.body_parentid[b]], &force, 1.0);
    }
}
