//! Properties of a model's actuators that do not depend on the state.

use super::{
    BiasType, CompiledModel, Disable, DynamicsType, GainType, JointType, ObjectType,
    TransmissionType, WrapType,
};

/// A motor on a slide or a hinge.
#[derive(Clone, Debug)]
pub(crate) struct Motor {
    pub(crate) dof: usize,
    pub(crate) gear: f64,
    /// The range of the control; without bounds if the control has no range.
    pub(crate) range: [f64; 2],
}

/// Returns the actuators, if all are motors on slides and hinges whose force equals the control, without
/// ranges of force, joint or group.
pub(super) fn motors(m: &CompiledModel) -> Option<Vec<Motor>> {
    let plain = |i: usize| {
        m.actuator_trntype[i] == TransmissionType::Joint
            && m.jnt_type[m.actuator_trnid[i][0] as usize].is_scalar()
            && m.actuator_dyntype[i] == DynamicsType::None
            && m.actuator_gaintype[i] == GainType::Fixed
            && m.actuator_gainprm[i].0[0] == 1.0
            && m.actuator_biastype[i] == BiasType::None
            && !m.actuator_forcelimited[i]
    };
    let all = (0..m.nu()).all(plain)
        && m.opt.disableactuator == 0
        && !m.opt.disables(Disable::Actuation)
        && !m.opt.disables(Disable::ClampCtrl)
        && !m.jnt_actfrclimited.contains(&true)
        && !m.jnt_actgravcomp.contains(&true);
    let motor = |i: usize| Motor {
        dof: m.jnt_dofadr[m.actuator_trnid[i][0] as usize],
        gear: m.actuator_gear[i][0],
        range: if m.actuator_ctrllimited[i] {
            m.actuator_ctrlrange[i]
        } else {
            [f64::NEG_INFINITY, f64::INFINITY]
        },
    };
    all.then(|| (0..m.nu()).map(motor).collect())
}

/// Whether the transmission of an actuator is a slide, a hinge, or a fixed tendon, and its force is
/// the control times a constant plus a bias.
fn straight(m: &CompiledModel, i: usize) -> bool {
    let id = m.actuator_trnid[i][0];
    let moved = match m.actuator_trntype[i] {
        TransmissionType::Joint => m.jnt_type[id as usize].is_scalar(),
        TransmissionType::Tendon => {
            let parts = m.tendon_adr[id as usize]..;
            let parts = parts.take(m.tendon_num[id as usize]);
            let joints = parts.filter(|&w| m.wrap_type[w] == WrapType::Joint);
            let mut joints: Vec<i32> = joints.map(|w| m.wrap_objid[w]).collect();
            joints.sort_unstable();
            joints.dedup();
            joints.len() == m.tendon_num[id as usize]
        }
        _ => false,
    };
    moved
        && m.actuator_dyntype[i] == DynamicsType::None
        && m.actuator_gaintype[i] == GainType::Fixed
}

/// Whether all actuator forces on degrees of freedom depend on controls alone.
pub(super) fn steady(m: &CompiledModel) -> bool {
    let plain = |i: usize| straight(m, i) && m.actuator_biastype[i] == BiasType::None;
    (0..m.nu()).all(plain) && !m.jnt_actgravcomp.contains(&true)
}

/// Whether all actuator forces are a constant times the control plus a constant times the position.
pub(super) fn servos(m: &CompiledModel) -> bool {
    let plain = |i: usize| {
        let [rest, _, damping] = [0, 1, 2].map(|k| m.actuator_biasprm[i].0[k]);
        straight(m, i)
            && m.actuator_biastype[i] == BiasType::Affine
            && (rest, damping) == (0.0, 0.0)
            && !m.actuator_forcelimited[i]
    };
    (0..m.nu()).all(plain)
        && m.opt.disableactuator == 0
        && !m.opt.disables(Disable::Actuation)
        && !m.tendon_actfrclimited.contains(&true)
        && !m.jnt_actfrclimited.contains(&true)
        && !m.jnt_actgravcomp.contains(&true)
}

/// Whether the engine must compute lengths and velocities of actuators.
pub(super) fn transmits(m: &CompiledModel) -> bool {
    motors(m).is_none() || m.sensor_objtype.contains(&ObjectType::Actuator)
}

/// The period of each actuator's setpoint: a full turn for an angle of a ball joint or between
/// sites, else 0: MuJoCo's `wrapPeriod`.
pub(super) fn periods(m: &CompiledModel) -> Vec<f64> {
    let length = |v: &[f64]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let period = |i: usize| {
        let servo = m.actuator_gaintype[i] == GainType::Fixed
            && m.actuator_biastype[i] == BiasType::Affine
            && m.actuator_gainprm[i].0[0] == -m.actuator_biasprm[i].0[1]
            && matches!(
                m.actuator_dyntype[i],
                DynamicsType::None | DynamicsType::Integrator
            );
        let (gear, [id, reference]) = (&m.actuator_gear[i], m.actuator_trnid[i]);
        let turn = match m.actuator_trntype[i] {
            TransmissionType::Site if reference >= 0 && gear[..3] == [0.0; 3] => &gear[3..],
            TransmissionType::Joint | TransmissionType::JointInParent
                if m.jnt_type[id as usize] == JointType::Ball =>
            {
                &gear[..3]
            }
            _ => return 0.0,
        };
        if servo {
            2.0 * std::f64::consts::PI * length(turn)
        } else {
            0.0
        }
    };
    (0..m.nu()).map(period).collect()
}
