//! Muscles: MuJoCo's formulas. The parameters `prm` of gain and bias are range (2), force, scale,
//! lmin, lmax, vmax, fpmax and fvmax. The parameters of the dynamics are the time constants of
//! activation and deactivation, and the width of the transition between them.

use crate::math::spatial::MINVAL;
use crate::{Data, Model};

/// The peak force, and the optimal fibre length.
fn scales(m: &Model, i: usize, prm: &[f64; 10]) -> (f64, f64) {
    let [least, most] = m.actuator_lengthrange[i];
    let force = match prm[2] {
        force if force < 0.0 => prm[3] / f64::max(MINVAL, m.actuator_acc0[i]),
        force => force,
    };
    (force, (most - least) / f64::max(MINVAL, prm[1] - prm[0]))
}

/// The active force at an activation of 1: MuJoCo's `mju_muscleGain`.
pub(super) fn gain(m: &Model, d: &Data, i: usize) -> f64 {
    let (scale, v, _) = contraction(m, d, i);
    let fvmax = m.actuator_gainprm[i].0[8];
    let y = fvmax - 1.0;
    let by_velocity = if v <= -1.0 {
        0.0
    } else if v <= 0.0 {
        (v + 1.0) * (v + 1.0)
    } else if v <= y {
        fvmax - (y - v) * (y - v) / f64::max(MINVAL, y)
    } else {
        fvmax
    };
    scale * by_velocity
}

/// The derivative of [`gain`] by the velocity: MuJoCo's `mjd_muscleGain_vel`.
pub(super) fn gain_slope(m: &Model, d: &Data, i: usize) -> f64 {
    let (scale, v, fastest) = contraction(m, d, i);
    let y = m.actuator_gainprm[i].0[8] - 1.0;
    let slope = if v <= -1.0 || v > f64::max(0.0, y) {
        0.0
    } else if v <= 0.0 {
        2.0 * v + 2.0
    } else {
        (-2.0 * v + 2.0 * y) / f64::max(MINVAL, y)
    };
    scale * slope / fastest
}

/// Returns the force at a velocity factor of 1, the velocity divided by the maximum velocity, and
/// the maximum velocity.
fn contraction(m: &Model, d: &Data, i: usize) -> (f64, f64, f64) {
    let prm = &m.actuator_gainprm[i].0;
    let (force, optimum) = scales(m, i, prm);
    let [lmin, lmax, vmax] = [prm[4], prm[5], prm[6]];
    let moved = d.actuator_length[i] - m.actuator_lengthrange[i][0];
    let l = prm[0] + moved / f64::max(MINVAL, optimum);
    let fastest = f64::max(MINVAL, optimum * vmax);
    let scale = -force * length_curve(l, lmin, lmax);
    (scale, d.actuator_velocity[i] / fastest, fastest)
}

/// The force-length curve: four parabolas from `lmin` to `lmax`, with the maximum at 1.
fn length_curve(l: f64, lmin: f64, lmax: f64) -> f64 {
    if !(lmin..=lmax).contains(&l) {
        return 0.0;
    }
    let (a, b) = (0.5 * (lmin + 1.0), 0.5 * (1.0 + lmax));
    let part = |x: f64, width: f64| x / f64::max(MINVAL, width);
    if l <= a {
        let x = part(l - lmin, a - lmin);
        0.5 * x * x
    } else if l <= 1.0 {
        let x = part(1.0 - l, 1.0 - a);
        1.0 - 0.5 * x * x
    } else if l <= b {
        let x = part(l - 1.0, b - 1.0);
        1.0 - 0.5 * x * x
    } else {
        let x = part(lmax - l, lmax - b);
        0.5 * x * x
    }
}

/// The passive force: MuJoCo's `mju_muscleBias`.
pub(super) fn bias(m: &Model, d: &Data, i: usize) -> f64 {
    let prm = &m.actuator_biasprm[i].0;
    let (force, optimum) = scales(m, i, prm);
    let (lmax, fpmax) = (prm[5], prm[7]);
    let moved = d.actuator_length[i] - m.actuator_lengthrange[i][0];
    let l = prm[0] + moved / f64::max(MINVAL, optimum);
    let b = 0.5 * (1.0 + lmax);
    let part = |x: f64| x / f64::max(MINVAL, b - 1.0);
    if l <= 1.0 {
        0.0
    } else if l <= b {
        let x = part(l - 1.0);
        -force * fpmax * 0.5 * x * x
    } else {
        -force * fpmax * (0.5 + part(l - b))
    }
}

/// The rate of change of the activation: MuJoCo's `mju_muscleDynamics`.
pub(super) fn dynamics(ctrl: f64, act: f64, prm: &[f64; 10]) -> f64 {
    let (ctrl, within) = (ctrl.clamp(0.0, 1.0), act.clamp(0.0, 1.0));
    let on = prm[0] * (0.5 + 1.5 * within);
    let off = prm[1] / (0.5 + 1.5 * within);
    let excess = ctrl - act;
    let width = prm[2];
    let time = if width < MINVAL {
        if excess > 0.0 { on } else { off }
    } else {
        off + (on - off) * sigmoid(excess / width + 0.5)
    };
    excess / f64::max(MINVAL, time)
}

fn sigmoid(x: f64) -> f64 {
    if x <= 0.0 {
        0.0
    } else if x >= 1.0 {
        1.0
    } else {
        x * x * x * (3.0 * x * (2.0 * x - 5.0) + 10.0)
    }
}
