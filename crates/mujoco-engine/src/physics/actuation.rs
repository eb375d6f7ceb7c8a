//! Actuator forces and activations.

use super::muscle;
use crate::math::{MAXVAL, libm};
use crate::model::{BiasType, Disable, DynamicsType, GainType, JointType, TransmissionType};
use crate::{Data, Model};

/// Computes `actuator_force`, `act_dot` and `qfrc_actuator`: MuJoCo's `mj_fwdActuation`. If one
/// control is invalid, all controls count as zero.
#[inline(always)]
pub fn fwd_actuation(m: &Model, d: &mut Data) {
    d.qfrc_actuator.fill(0.0);
    let motors = match &m.plan().motors {
        Some(motors) if !d.work.unactuated => motors,
        _ => return general(m, d),
    };
    let mut bad = false;
    for ((motor, ctrl), force) in motors.iter().zip(&d.ctrl).zip(&mut d.actuator_force) {
        let [low, high] = motor.range;
        *force = ctrl.max(low).min(high);
        bad |= ctrl.is_nan() | (force.abs() > MAXVAL);
    }
    if bad {
        d.actuator_force.fill(0.0);
        return;
    }
    for (motor, force) in motors.iter().zip(&d.actuator_force) {
        d.qfrc_actuator[motor.dof] += motor.gear * force;
    }
}

/// [`fwd_actuation`] for all kinds of actuators.
#[inline(never)]
fn general(m: &Model, d: &mut Data) {
    d.actuator_force.fill(0.0);
    // without actuators, joints with `actuatorgravcomp` have no gravity compensation at all
    if m.nu() == 0 || d.work.unactuated || m.opt.disables(Disable::Actuation) {
        return;
    }
    let mut ctrl = std::mem::take(&mut d.work.ctrl);
    controls(m, d, &mut ctrl);
    for i in 0..m.nu() {
        if let Ok(adr) = usize::try_from(m.actuator_actadr[i]) {
            d.act_dot[adr] = rate(m, i, ctrl[i], d.act[adr]);
        }
    }
    for i in (0..m.nu()).filter(|&i| !disabled(m, i)) {
        let input = match usize::try_from(m.actuator_actadr[i]) {
            Err(_) => ctrl[i],
            Ok(adr) if m.actuator_actearly[i] => next(m, d, i, adr, d.act_dot[adr]),
            Ok(adr) => d.act[adr],
        };
        let input = nearest(m, i, input, d.actuator_length[i]);
        d.actuator_force[i] = gain(m, d, i) * input + bias(m, d, i);
    }
    d.work.ctrl = ctrl;
    limit(m, d);
    for i in 0..m.nu() {
        let force = d.actuator_force[i];
        let (columns, moments) = d.work.moments.row(i);
        if force != 0.0 {
            for (&dof, moment) in columns.iter().zip(moments) {
                d.qfrc_actuator[dof] += moment * force;
            }
        }
    }
    joints(m, d);
}

/// Clamps the controls that implicit integrators read.
pub(super) fn clamp_controls(m: &Model, d: &mut Data) {
    let mut ctrl = std::mem::take(&mut d.work.ctrl);
    controls(m, d, &mut ctrl);
    d.work.ctrl = ctrl;
}

/// Clamps controls to their ranges. If a control is NaN, or exceeds `MAXVAL` after the clamp, all
/// controls are zero.
fn controls(m: &Model, d: &Data, ctrl: &mut Vec<f64>) {
    ctrl.clear();
    ctrl.extend_from_slice(&d.ctrl);
    if !m.opt.disables(Disable::ClampCtrl) {
        for i in (0..m.nu()).filter(|&i| m.actuator_ctrllimited[i]) {
            let [low, high] = m.actuator_ctrlrange[i];
            ctrl[i] = ctrl[i].max(low).min(high);
        }
    }
    let bad = |(given, used): (&f64, &f64)| given.is_nan() || used.abs() > MAXVAL;
    if d.ctrl.iter().zip(ctrl.iter()).any(bad) {
        ctrl.fill(0.0);
    }
}

/// Whether the group of actuator `i` is disabled: MuJoCo's `mj_actuatorDisabled`.
pub(super) fn disabled(m: &Model, i: usize) -> bool {
    let group = m.actuator_group[i];
    (0..31).contains(&group) && m.opt.disableactuator & (1 << group) != 0
}

/// The rate of change of an activation.
fn rate(m: &Model, i: usize, ctrl: f64, act: f64) -> f64 {
    let prm = &m.actuator_dynprm[i].0;
    match m.actuator_dyntype[i] {
        DynamicsType::None => 0.0,
        DynamicsType::Integrator => ctrl,
        DynamicsType::Filter | DynamicsType::FilterExact => (ctrl - act) / f64::max(1e-15, prm[0]),
        DynamicsType::Muscle => muscle::dynamics(ctrl, act, prm),
    }
}

/// The activation after a timestep: MuJoCo's `mj_nextActivation`.
pub(super) fn next(m: &Model, d: &Data, i: usize, adr: usize, rate: f64) -> f64 {
    let (act, dt) = (d.act[adr], m.opt.timestep);
    let next = if m.actuator_dyntype[i] == DynamicsType::FilterExact {
        let time = f64::max(1e-15, m.actuator_dynprm[i].0[0]);
        act + rate * time * (1.0 - libm::exp(-dt / time))
    } else {
        act + rate * dt
    };
    if m.actuator_actlimited[i] {
        let [low, high] = m.actuator_actrange[i];
        next.max(low).min(high)
    } else {
        next
    }
}

/// Advances the activations by a timestep at the rates `rates`.
pub(super) fn advance(m: &Model, d: &mut Data, rates: &[f64]) {
    if m.opt.disables(Disable::Actuation) {
        return;
    }
    for i in 0..m.nu() {
        let Ok(adr) = usize::try_from(m.actuator_actadr[i]) else {
            continue;
        };
        let rate = if disabled(m, i) { 0.0 } else { rates[adr] };
        d.act[adr] = next(m, d, i, adr, rate);
        if m.actuator_dyntype[i] == DynamicsType::Integrator {
            d.act[adr] = nearest(m, i, d.act[adr], d.actuator_length[i]);
        }
    }
}

/// The gain: the factor of control or activation.
fn gain(m: &Model, d: &Data, i: usize) -> f64 {
    let prm = &m.actuator_gainprm[i].0;
    let (length, velocity) = (d.actuator_length[i], d.actuator_velocity[i]);
    match m.actuator_gaintype[i] {
        GainType::Fixed => prm[0],
        GainType::Affine => prm[0] + prm[1] * length + prm[2] * velocity,
        GainType::Muscle => muscle::gain(m, d, i),
    }
}

/// The bias: the force without control.
fn bias(m: &Model, d: &Data, i: usize) -> f64 {
    let prm = &m.actuator_biasprm[i].0;
    let (length, velocity) = (d.actuator_length[i], d.actuator_velocity[i]);
    match m.actuator_biastype[i] {
        BiasType::None => 0.0,
        BiasType::Affine => prm[0] + prm[1] * length + prm[2] * velocity,
        BiasType::Muscle => muscle::bias(m, d, i),
    }
}

/// Returns `setpoint` plus the number of full turns that brings the result nearest to `length`.
fn nearest(m: &Model, i: usize, setpoint: f64, length: f64) -> f64 {
    let period = m.plan().periods[i];
    if period > 0.0 {
        setpoint - period * ((setpoint - length) / period).round()
    } else {
        setpoint
    }
}

/// Clamps forces to the ranges of tendons and actuators.
fn limit(m: &Model, d: &mut Data) {
    let tendon = |i: usize| {
        let id = m.actuator_trnid[i][0] as usize;
        let of_tendon = m.actuator_trntype[i] == TransmissionType::Tendon;
        (of_tendon && m.tendon_actfrclimited[id]).then_some(id)
    };
    if m.plan().tendon_forces {
        let mut sums = std::mem::take(&mut d.work.tendon_sums);
        sums.fill(0.0);
        for i in 0..m.nu() {
            if let Some(t) = tendon(i) {
                sums[t] += d.actuator_force[i];
            }
        }
        for i in 0..m.nu() {
            let Some(t) = tendon(i) else { continue };
            let ([low, high], sum) = (m.tendon_actfrcrange[t], sums[t]);
            if sum != 0.0 && sum < low {
                d.actuator_force[i] *= low / sum;
            } else if sum != 0.0 && sum > high {
                d.actuator_force[i] *= high / sum;
            }
        }
        d.work.tendon_sums = sums;
    }
    for i in (0..m.nu()).filter(|&i| m.actuator_forcelimited[i]) {
        let [low, high] = m.actuator_forcerange[i];
        d.actuator_force[i] = d.actuator_force[i].max(low).min(high);
    }
}

/// Adds gravity compensation of actuators, and clamps forces to the ranges of joints.
fn joints(m: &Model, d: &mut Data) {
    if m.plan().gravcomp {
        for j in (0..m.njnt()).filter(|&j| m.jnt_actgravcomp[j]) {
            let first = m.jnt_dofadr[j];
            for i in first..first + m.jnt_type[j].nv() {
                d.qfrc_actuator[i] += d.work.gravcomp[i];
            }
        }
    }
    for j in (0..m.njnt()).filter(|&j| m.jnt_actfrclimited[j]) {
        if matches!(m.jnt_type[j], JointType::Slide | JointType::Hinge) {
            let ([low, high], i) = (m.jnt_actfrcrange[j], m.jnt_dofadr[j]);
            d.qfrc_actuator[i] = d.qfrc_actuator[i].max(low).min(high);
        }
    }
}
