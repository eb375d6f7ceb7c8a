//! Forces of the motors.

use crate::{Data, Model};

/// Controls beyond this count as errors, as positions do: MuJoCo's `mjMAXVAL`.
pub(crate) const MAXVAL: f64 = 1e10;

/// `actuator_force` and `qfrc_actuator`: MuJoCo's `mj_fwdActuation`. A bad control makes all
/// controls count as zero.
#[inline(always)]
pub fn fwd_actuation(m: &Model, d: &mut Data) {
    d.qfrc_actuator.fill(0.0);
    for i in 0..m.nu() {
        let ctrl = d.ctrl[i];
        let [low, high] = m.actuator_ctrlrange[i];
        d.actuator_force[i] = if m.actuator_ctrllimited[i] {
            ctrl.max(low).min(high)
        } else {
            ctrl
        };
        if ctrl.is_nan() || d.actuator_force[i].abs() > MAXVAL {
            d.actuator_force.fill(0.0);
            return;
        }
    }
    for i in 0..m.nu() {
        let dof = m.jnt_dofadr[m.actuator_trnid[i][0] as usize];
        d.qfrc_actuator[dof] += m.actuator_gear[i][0] * d.actuator_force[i];
    }
}
