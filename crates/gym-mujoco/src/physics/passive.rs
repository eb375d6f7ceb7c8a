//! Forces of springs, dampers and the medium.

use std::f64::consts::PI;

use super::spatial::{
    InTurn, Order, Pairwise, add, cross, dot, rotate, rotate_back, rotation, scale, sub,
    translation, velocity_at,
};
use crate::model::JointType;
use crate::{Data, Model, Revision};

/// `qfrc_passive`: MuJoCo's `mj_passive`, springs, then dampers, then the medium.
#[inline(always)]
pub fn passive(m: &Model, d: &mut Data) {
    let plan = m.plan();
    d.qfrc_passive.fill(0.0);
    for &j in &plan.springs {
        let stiffness = m.jnt_stiffness[j];
        let (p, i) = (m.jnt_qposadr[j], m.jnt_dofadr[j]);
        if m.jnt_type[j] == JointType::Free {
            for k in 0..3 {
                d.qfrc_passive[i + k] = (d.qpos[p + k] - m.qpos_spring[p + k]) * -stiffness;
            }
            let quat = |q: &[f64]| [q[p + 3], q[p + 4], q[p + 5], q[p + 6]];
            let (now, rest) = (quat(&d.qpos), quat(&m.qpos_spring));
            let turned = match m.revision {
                Revision::V3_12 => InTurn::sub_quat(InTurn::normalize_quat((), now), rest),
                Revision::V4_0 => Pairwise::sub_quat(Pairwise::normalize_quat((), now), rest),
            };
            for (force, turned) in d.qfrc_passive[i + 3..i + 6].iter_mut().zip(turned) {
                *force = turned * -stiffness;
            }
        } else {
            d.qfrc_passive[i] = -(d.qpos[p] - m.qpos_spring[p]) * stiffness;
        }
    }
    for ((force, velocity), damping) in d.qfrc_passive.iter_mut().zip(&d.qvel).zip(&m.dof_damping) {
        *force += -velocity * damping;
    }
    if !plan.boxes.is_empty() {
        d.work.fluid.fill(0.0);
        fluid(m, d);
        for (force, fluid) in d.qfrc_passive.iter_mut().zip(&d.work.fluid) {
            *force += fluid;
        }
    }
}

/// Adds the forces of the medium on each body, as if it were the box of equal inertia: MuJoCo's
/// `mj_inertiaBoxFluidModel`.
#[inline(always)]
fn fluid(m: &Model, d: &mut Data) {
    let (density, viscosity) = (m.opt.density, m.opt.viscosity);
    for (b, edges) in &m.plan().boxes {
        let (b, edges) = (*b, *edges);
        let mat = &d.ximat[b];
        let offset = sub(d.xipos[b], d.subtree_com[m.body_rootid[b]]);
        let w = rotate_back(mat, rotation(&d.cvel[b]));
        let v = sub(
            rotate_back(mat, velocity_at(&d.cvel[b], offset)),
            rotate_back(mat, m.opt.wind),
        );

        let (mut torque, mut force) = ([0.0; 3], [0.0; 3]);
        if viscosity > 0.0 {
            let diameter = (edges[0] + edges[1] + edges[2]) / 3.0;
            torque = scale(w, -PI * diameter * diameter * diameter * viscosity);
            force = scale(v, -3.0 * PI * diameter * viscosity);
        }
        if density > 0.0 {
            for (k, [i, j]) in [[1, 2], [0, 2], [0, 1]].into_iter().enumerate() {
                let (a, c) = (edges[i], edges[j]);
                force[k] -= 0.5 * density * a * c * v[k].abs() * v[k];
                torque[k] -=
                    density * edges[k] * (a * a * a * a + c * c * c * c) * w[k].abs() * w[k] / 64.0;
            }
        }
        let (torque, force) = (rotate(mat, torque), rotate(mat, force));
        for &dof in m.plan().chain(b) {
            let axis = &d.cdof[dof];
            let moves = add(translation(axis), cross(rotation(axis), offset));
            d.work.fluid[dof] += dot(moves, force);
            d.work.fluid[dof] += dot(rotation(axis), torque);
        }
    }
}
