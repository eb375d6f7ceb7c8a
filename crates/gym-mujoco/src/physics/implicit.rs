//! The integrator that is implicit in the velocities of dampers and actuators: MuJoCo's
//! `implicitfast`.

use super::actuation::{disabled, next};
use super::inertia::factor_damped;
use crate::model::{BiasType, Disable, GainType};
use crate::{Data, Model};

/// Makes and factors the inertia matrix less the timestep times the derivatives of the forces by
/// the velocities: the lower half of MuJoCo's `mjd_smooth_vel`.
#[inline(never)]
pub(super) fn factor(m: &Model, d: &mut Data) {
    let mut slopes = std::mem::take(&mut d.work.qh);
    slopes.clear();
    slopes.resize(d.qm.len(), 0.0);
    actuators(m, d, &mut slopes);
    if !m.opt.disables(Disable::Damper) {
        for i in 0..m.nv() {
            slopes[m.plan().m_diagonal(i)] -= m.dof_damping[i];
        }
        let paths = &m.plan().paths;
        for (t, row) in paths.rows.iter().enumerate() {
            let damping = m.tendon_damping[t];
            if damping != 0.0 {
                add_square(
                    m,
                    &mut slopes,
                    &paths.columns[row.clone()],
                    &d.ten_j[row.clone()],
                    -damping,
                );
            }
        }
    }
    for (slope, inertia) in slopes.iter_mut().zip(&d.qm) {
        *slope = inertia + *slope * -m.opt.timestep;
    }
    d.work.qh = slopes;
    factor_damped(m, d);
}

/// Adds `factor J' J` to the lower half of a matrix of the inertia matrix's structure.
fn add_square(m: &Model, matrix: &mut [f64], columns: &[usize], j: &[f64], factor: f64) {
    let plan = m.plan();
    for (&dof, part) in columns.iter().zip(j) {
        let scale = part * factor;
        let row = plan.m_row(dof);
        let known = &plan.m_colind[row.clone()];
        for (&column, other) in columns.iter().zip(j) {
            if let Ok(place) = known.binary_search(&column) {
                matrix[row.start + place] += other * scale;
            }
        }
    }
}

/// The derivatives of the actuators' forces: MuJoCo's `mjd_actuator_vel`.
fn actuators(m: &Model, d: &Data, slopes: &mut [f64]) {
    if m.opt.disables(Disable::Actuation) {
        return;
    }
    for i in 0..m.nu() {
        if disabled(m, i) {
            continue;
        }
        let force = d.actuator_force[i];
        let [low, high] = m.actuator_forcerange[i];
        if m.actuator_forcelimited[i] && (force <= low || force >= high) {
            continue;
        }
        let mut slope = 0.0;
        if m.actuator_biastype[i] == BiasType::Affine {
            slope = m.actuator_biasprm[i].0[2];
        }
        let gain = m.actuator_gainprm[i].0[2];
        if m.actuator_gaintype[i] == GainType::Affine && gain != 0.0 {
            slope += gain
                * match usize::try_from(m.actuator_actadr[i]) {
                    Err(_) => d.ctrl[i],
                    Ok(adr) if m.actuator_actearly[i] => next(m, d, i, adr, d.act_dot[adr]),
                    Ok(adr) => d.act[adr],
                };
        }
        if slope != 0.0 {
            let (columns, moments) = d.work.moments.row(i);
            add_square(m, slopes, columns, moments, slope);
        }
    }
}
