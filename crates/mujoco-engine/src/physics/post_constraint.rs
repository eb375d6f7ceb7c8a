//! Forces on bodies, and their accelerations, once constraint forces are known.

use super::constraint::Source;
use super::contact_force::force_of;
use super::passive::polynomials::of_tendon;
use super::passive::tendon_spring_force;
use super::rows;
use super::tendon::{along_path, change, pulling};
use super::velocity::{along, dofs};
use crate::math::spatial::{
    Vec3, add_to, cross, cross_force, join, mul_inertia, rotate_back, scale, sub,
};
use crate::model::EqualityType;
use crate::{Contact, Data, Model};

/// Computes `cfrc_ext` from the contacts of the last forward call, then `cacc` and `cfrc_int`:
/// MuJoCo's `mj_rnePostConstraint`.
pub fn rne_post_constraint(m: &Model, d: &mut Data) {
    d.contact_forces = true;
    contacts(m, d);
    equalities(m, d);
    if m.revision.shows_tendon_forces() {
        tendons(m, d);
    }
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
        let com = com(m.body_rootid[body]);
        add_at(cfrc_ext, (body, com), contact.pos, [torque, force], sign);
    }
}

/// Adds `sign` times a torque and a force at a `point` of a `body` to the forces on bodies. `com` is
/// the centre of mass of the body's tree.
fn add_at(
    cfrc_ext: &mut [[f64; 6]],
    (body, com): (usize, Vec3),
    point: Vec3,
    [torque, force]: [Vec3; 2],
    sign: f64,
) {
    if body > 0 {
        let about = sub(torque, cross(sub(com, point), force));
        add_to(&mut cfrc_ext[body], &join(about, force), sign);
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
        let torque = if weld && m.revision.turns_weld_torques() {
            rows::weld_torque(m, d, constraint, torque)
        } else {
            torque
        };
        let points = rows::anchors(m, d, constraint);
        for (k, sign) in [(0, 1.0), (1, -1.0)] {
            let body = constraint.bodies[k];
            let com = d.subtree_com[m.body_rootid[body]];
            let wrench = [torque, force];
            add_at(&mut d.cfrc_ext, (body, com), points[k], wrench, sign);
        }
    }
}

/// Adds the forces of spatial tendons on bodies, which versions before 4.0 leave out.
fn tendons(m: &Model, d: &mut Data) {
    for t in 0..m.ntendon() {
        if m.plan().paths.fixed[t] {
            continue;
        }
        let tension = tension(m, d, t) - inertia(m, d, t);
        along_path(m, d, t, |d, segment| {
            let force = scale(segment.direction(), tension / segment.divisor);
            for (k, sign) in [(0, -1.0), (1, 1.0)] {
                let (body, point) = segment.ends[k];
                let com = d.subtree_com[m.body_rootid[body]];
                let wrench = [[0.0; 3], force];
                add_at(&mut d.cfrc_ext, (body, com), point, wrench, sign);
            }
        });
    }
}

/// The force along a tendon, positive if it pushes the ends apart: the sum of the tendon's
/// constraints, actuators, spring and damper.
fn tension(m: &Model, d: &Data, tendon: usize) -> f64 {
    let forces = |source: Source| {
        let blocks = d.efc.blocks.iter();
        blocks
            .filter(move |block| block.source == source)
            .map(|block| d.efc.force[block.row])
    };
    let mut sum = 0.0;
    for equality in &m.plan().constraints.equalities {
        if equality.kind != EqualityType::Tendon {
            continue;
        }
        let [_, slope] = rows::polynomial_error(m, d, equality);
        let ids = [m.eq_obj1id[equality.id], m.eq_obj2id[equality.id]];
        for force in forces(Source::Equality(equality.id)) {
            for (id, factor) in ids.into_iter().zip([1.0, slope]) {
                if usize::try_from(id) == Ok(tendon) {
                    sum += force * factor;
                }
            }
        }
    }
    sum += forces(Source::TendonFriction(tendon)).sum::<f64>();
    let mut limits = forces(Source::TendonLimit(tendon));
    for (side, _) in rows::reached_limits(m, tendon, d.ten_length[tendon]) {
        sum -= side * limits.next().unwrap_or(0.0);
    }
    for i in pulling(m, tendon) {
        sum += m.actuator_gear[i][0] * d.actuator_force[i];
    }
    let elastic = &m.plan().paths.elastic;
    match elastic.iter().find(|(id, ..)| *id == tendon) {
        Some(&(id, ..)) if m.plan().polynomials => {
            let [spring, damper] = of_tendon(m, d, id);
            sum + (spring + damper)
        }
        Some(&(id, stiffness, damping)) => {
            let rest = m.tendon_lengthspring[id];
            let spring = tendon_spring_force(d.ten_length[id], rest, stiffness);
            sum + (spring - d.ten_velocity[id] * damping)
        }
        None => sum,
    }
}

/// The force that accelerates the inertia along a spatial tendon.
fn inertia(m: &Model, d: &mut Data, tendon: usize) -> f64 {
    let armature = m.tendon_armature[tendon];
    if armature == 0.0 {
        return 0.0;
    }
    let mut acceleration = change(m, d, tendon);
    let paths = &m.plan().paths;
    let row = paths.rows[tendon].clone();
    for (&dof, arm) in paths.columns[row.clone()].iter().zip(&d.ten_j[row]) {
        acceleration += arm * d.qacc[dof];
    }
    armature * acceleration
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
