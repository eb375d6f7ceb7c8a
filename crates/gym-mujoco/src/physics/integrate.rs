//! Velocities and positions from accelerations.

use super::evaluate;
use super::inertia::solve;
use super::spatial::quat_integrate;
use crate::libm::wide;
use crate::model::JointType;
use crate::{Data, Model};

/// Moves positions along velocities for some time: MuJoCo's `mj_integratePos`.
pub fn integrate_pos(m: &Model, qpos: &mut [f64], qvel: &[f64], dt: f64) {
    for j in 0..m.njnt() {
        let (p, v) = (m.jnt_qposadr[j], m.jnt_dofadr[j]);
        if m.jnt_type[j] == JointType::Free {
            for k in 0..3 {
                qpos[p + k] += dt * qvel[v + k];
            }
            let q = &mut qpos[p + 3..p + 7];
            let turned = quat_integrate(
                [q[0], q[1], q[2], q[3]],
                [qvel[v + 3], qvel[v + 4], qvel[v + 5]],
                dt,
            );
            q.copy_from_slice(&turned);
        } else {
            qpos[p] += dt * qvel[v];
        }
    }
}

/// Semi-implicit Euler, implicit in joint damping: MuJoCo's `mj_Euler`, for models with this
/// integrator.
pub fn euler(m: &Model, d: &mut Data) {
    wide(
        (m, d),
        #[inline(always)]
        |(m, d)| semi_implicit(m, d),
        #[inline(always)]
        |(m, d)| semi_implicit(m, d),
    );
}

#[inline(always)]
fn semi_implicit(m: &Model, d: &mut Data) {
    let dt = m.opt.timestep;
    if m.plan().implicit {
        let work = &mut d.work;
        for i in 0..m.nv() {
            work.acc_sum[i] = d.qfrc_smooth[i] + d.qfrc_constraint[i];
        }
        solve(m, &work.qh, &work.qh_diag_inv, &mut work.acc_sum);
    } else {
        d.work.acc_sum.copy_from_slice(&d.qacc);
    }
    for i in 0..m.nv() {
        d.qvel[i] += dt * d.work.acc_sum[i];
    }
    integrate_pos(m, &mut d.qpos, &d.qvel, dt);
    d.time += dt;
    d.qacc_warmstart.copy_from_slice(&d.qacc);
}

/// Runge-Kutta of fourth order: MuJoCo's `mj_RungeKutta`. The forward call of the start is done
/// already.
pub fn runge_kutta(m: &Model, d: &mut Data) {
    const WEIGHTS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
    // the part of the step from the start to the next stage
    const PARTS: [f64; 4] = [0.5, 0.5, 1.0, 0.0];
    let (dt, start, nv) = (m.opt.timestep, d.time, m.nv());
    d.work.qpos_start.copy_from_slice(&d.qpos);
    d.work.qvel_start.copy_from_slice(&d.qvel);
    d.work.vel_sum.fill(0.0);
    d.work.acc_sum.fill(0.0);
    for (weight, part) in WEIGHTS.into_iter().zip(PARTS) {
        for i in 0..nv {
            d.work.vel_sum[i] += weight * d.qvel[i];
            d.work.acc_sum[i] += weight * d.qacc[i];
        }
        if part > 0.0 {
            d.qpos.copy_from_slice(&d.work.qpos_start);
            integrate_pos(m, &mut d.qpos, &d.qvel, part * dt);
            for i in 0..nv {
                d.qvel[i] = d.work.qvel_start[i] + part * dt * d.qacc[i];
            }
            d.time = start + part * dt;
            evaluate(m, d);
        }
    }
    d.qpos.copy_from_slice(&d.work.qpos_start);
    for i in 0..nv {
        d.qvel[i] = d.work.qvel_start[i] + dt * d.work.acc_sum[i];
    }
    integrate_pos(m, &mut d.qpos, &d.work.vel_sum, dt);
    d.time = start + dt;
    d.qacc_warmstart.copy_from_slice(&d.qacc);
}
