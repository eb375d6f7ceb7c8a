//! Forces of springs, dampers and the medium.

use std::f64::consts::PI;

use super::spatial::{
    MINVAL, add_scaled, cross, normalize_quat, rotate, rotate_back, rotation, scale, sub, sub_quat,
    velocity_at,
};
use crate::model::JointType;
use crate::{Data, Model};

/// `qfrc_passive`: MuJoCo's `mj_passive`.
pub fn passive(m: &Model, d: &mut Data) {
    for i in 0..m.nv() {
        d.qfrc_passive[i] = -m.dof_damping[i] * d.qvel[i];
    }
    for j in 0..m.njnt() {
        let stiffness = m.jnt_stiffness[j];
        if stiffness == 0.0 {
            continue;
        }
        let (p, i) = (m.jnt_qposadr[j], m.jnt_dofadr[j]);
        if m.jnt_type[j] == JointType::Free {
            for k in 0..3 {
                d.qfrc_passive[i + k] -= stiffness * (d.qpos[p + k] - m.qpos_spring[p + k]);
            }
            let quat = |q: &[f64]| normalize_quat([q[p + 3], q[p + 4], q[p + 5], q[p + 6]]);
            let turned = sub_quat(quat(&d.qpos), quat(&m.qpos_spring));
            for (force, turned) in d.qfrc_passive[i + 3..i + 6].iter_mut().zip(turned) {
                *force -= stiffness * turned;
            }
        } else {
            d.qfrc_passive[i] -= stiffness * (d.qpos[p] - m.qpos_spring[p]);
        }
    }
    if m.opt.density > 0.0 || m.opt.viscosity > 0.0 {
        fluid(m, d);
    }
}

/// Adds the forces of the medium on each body, as if it were the box of equal inertia: MuJoCo's `mj_inertiaBoxFluidModel`.
fn fluid(m: &Model, d: &mut Data) {
    let (density, viscosity) = (m.opt.density, m.opt.viscosity);
    for b in 1..m.nbody() {
        let mass = m.body_mass[b];
        if mass < MINVAL {
            continue;
        }
        let i = m.body_inertia[b];
        let edge = |a: f64, b: f64, c: f64| (f64::max(1e-15, a + b - c) / mass * 6.0).sqrt();
        let box_ = [edge(i[1], i[2], i[0]), edge(i[0], i[2], i[1]), edge(i[0], i[1], i[2])];

        let mat = &d.ximat[b];
        let offset = sub(d.xipos[b], d.subtree_com[m.body_rootid[b]]);
        let w = rotate_back(mat, rotation(&d.cvel[b]));
        let v = rotate_back(mat, sub(velocity_at(&d.cvel[b], offset), m.opt.wind));

        let (mut torque, mut force) = ([0.0; 3], [0.0; 3]);
        if viscosity > 0.0 {
            let diameter = (box_[0] + box_[1] + box_[2]) / 3.0;
            torque = scale(w, -PI * diameter * diameter * diameter * viscosity);
            force = scale(v, -3.0 * PI * diameter * viscosity);
        }
        if density > 0.0 {
            for k in 0..3 {
                let (a, c) = (box_[(k + 1) % 3], box_[(k + 2) % 3]);
                force[k] -= 0.5 * density * a * c * v[k].abs() * v[k];
                torque[k] -= density * box_[k] * (a * a * a * a + c * c * c * c) * w[k].abs() * w[k] / 64.0;
            }
        }
        let (torque, force) = (rotate(mat, torque), rotate(mat, force));
        // the same about the centre of mass of the tree
        let torque = add_scaled(torque, cross(offset, force), 1.0);
        for &dof in m.plan().chain(b) {
            let c = &d.cdof[dof];
            d.qfrc_passive[dof] += c[0] * torque[0]
                + c[1] * torque[1]
                + c[2] * torque[2]
                + c[3] * force[0]
                + c[4] * force[1]
                + c[5] * force[2];
        }
    }
}
