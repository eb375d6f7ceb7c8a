//! Springs and dampers whose force also has terms in the square and the cube of the displacement or
//! velocity.

use super::{stretch, turn};
use crate::math::spatial::{Vec3, norm, sub};
use crate::model::{Disable, JointType};
use crate::{Data, Model};

/// The factor of the displacement in the force of a spring: MuJoCo's `mju_polyForce`.
fn factor(linear: f64, [square, cube]: [f64; 2], x: f64) -> f64 {
    linear + square * x + cube * (x * x)
}

/// The derivative of a damper's force by the velocity: MuJoCo's `mjd_xPolyForce`.
pub(in crate::physics) fn slope(linear: f64, [square, cube]: [f64; 2], velocity: f64) -> f64 {
    let x = velocity.abs();
    linear + 2.0 * square * x + 3.0 * cube * (x * x)
}

/// The energy of a spring: MuJoCo's `mju_polyPotential`.
pub(in crate::physics) fn energy(linear: f64, [square, cube]: [f64; 2], x: f64) -> f64 {
    let energy = 0.5 * linear * (x * x);
    energy + square / 3.0 * (x * x * x) + cube / 4.0 * (x * x * x * x)
}

/// The force of a tendon's spring, and that of its damper.
pub(in crate::physics) fn of_tendon(m: &Model, d: &Data, t: usize) -> [f64; 2] {
    let on = |part: Disable, x: f64| if m.opt.disables(part) { 0.0 } else { x };
    let x = stretch(d.ten_length[t], m.tendon_lengthspring[t]);
    let velocity = d.ten_velocity[t];
    let spring = factor(m.tendon_stiffness[t], m.tendon_stiffnesspoly[t], x);
    let damper = factor(m.tendon_damping[t], m.tendon_dampingpoly[t], velocity.abs());
    [
        on(Disable::Spring, -x * spring),
        on(Disable::Damper, -velocity * damper),
    ]
}

/// Adds the forces of all springs to `qfrc_passive`, then those of all dampers: MuJoCo's
/// `mj_springdamper`.
#[cold]
#[inline(never)]
pub(super) fn forces(m: &Model, d: &mut Data) {
    let plan = m.plan();
    for &j in &plan.springs {
        let (linear, higher) = (m.jnt_stiffness[j], m.jnt_stiffnesspoly[j]);
        let (mut p, mut i) = (m.jnt_qposadr[j], m.jnt_dofadr[j]);
        let pull = |d: &mut Data, i: usize, moved: Vec3| {
            let factor = factor(linear, higher, norm(moved));
            for k in 0..3 {
                d.qfrc_passive[i + k] += moved[k] * -factor;
            }
        };
        if m.jnt_type[j].is_scalar() {
            let x = d.qpos[p] - m.qpos_spring[p];
            d.qfrc_passive[i] = -x * factor(linear, higher, x);
            continue;
        }
        if m.jnt_type[j] == JointType::Free {
            let three = |q: &[f64]| [q[p], q[p + 1], q[p + 2]];
            let moved = sub(three(&d.qpos), three(&m.qpos_spring));
            pull(d, i, moved);
            (p, i) = (p + 3, i + 3);
        }
        let turned = turn(m, d, p);
        pull(d, i, turned);
    }
    for i in 0..m.nv() {
        let (linear, higher) = (m.dof_damping[i], m.dof_dampingpoly[i]);
        let still = m.opt.disables(Disable::Damper) || (linear == 0.0 && higher == [0.0; 2]);
        let v = d.qvel[i];
        d.work.damper[i] = if still {
            0.0
        } else {
            -v * factor(linear, higher, v.abs())
        };
    }
    for &(t, ..) in &plan.paths.elastic {
        let [spring, damp] = of_tendon(m, d, t);
        if spring == 0.0 && damp == 0.0 {
            continue;
        }
        let row = plan.paths.rows[t].clone();
        for (&dof, j) in plan.paths.columns[row.clone()].iter().zip(&d.ten_j[row]) {
            d.qfrc_passive[dof] += j * spring;
            d.work.damper[dof] += j * damp;
        }
    }
    for (force, damper) in d.qfrc_passive.iter_mut().zip(&d.work.damper) {
        *force += *damper;
    }
}
