//! What the actuators of a model need, as far as it does not depend on the state.

use super::{
    BiasType, CompiledModel, Disable, DynamicsType, GainType, JointType, ObjectType,
    TransmissionType, WrapType,
};

fn scalar(m: &CompiledModel, joint: i32) -> bool {
    matches!(
        m.jnt_type[joint as usize],
        JointType::Slide | JointType::Hinge
    )
}

/// Whether all actuators are motors of slides and hinges whose force is the control, and nothing
/// else limits or changes it.
pub(super) fn motors(m: &CompiledModel) -> bool {
    let plain = |i: usize| {
        m.actuator_trntype[i] == TransmissionType::Joint
            && scalar(m, m.actuator_trnid[i][0])
            && m.actuator_dyntype[i] == DynamicsType::None
            && m.actuator_gaintype[i] == GainType::Fixed
            && m.actuator_gainprm[i].0[0] == 1.0
            && m.actuator_biastype[i] == BiasType::None
            && !m.actuator_forcelimited[i]
    };
    (0..m.nu()).all(plain)
        && m.opt.disableactuator == 0
        && !m.opt.disables(Disable::Actuation)
        && !m.opt.disables(Disable::ClampCtrl)
        && !m.jnt_actfrclimited.contains(&true)
        && !m.jnt_actgravcomp.contains(&true)
}

/// Whether the force of an actuator acts along a slide, a hinge, or a sum of such joints' positions,
/// and is the control times a constant but for what the bias adds.
fn straight(m: &CompiledModel, i: usize) -> bool {
    let id = m.actuator_trnid[i][0];
    let moved = match m.actuator_trntype[i] {
        TransmissionType::Joint => scalar(m, id),
        TransmissionType::Tendon => {
            let parts = m.tendon_adr[id as usize]..;
            let mut joints: Vec<i32> = parts
                .take(m.tendon_num[id as usize])
                .filter(|&w| m.wrap_type[w] == WrapType::Joint)
                .map(|w| m.wrap_objid[w])
                .collect();
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

/// Whether the forces of all actuators on degrees of freedom follow from controls alone.
pub(super) fn steady(m: &CompiledModel) -> bool {
    let plain = |i: usize| straight(m, i) && m.actuator_biastype[i] == BiasType::None;
    (0..m.nu()).all(plain) && !m.jnt_actgravcomp.contains(&true)
}

/// Whether they are the control times a constant, and the position times another one.
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

/// Whether lengths and velocities of actuators are needed.
pub(super) fn transmits(m: &CompiledModel) -> bool {
    !motors(m) || m.sensor_objtype.contains(&ObjectType::Actuator)
}

/// The periods of setpoints that are angles about any axis; 0 for others: MuJoCo's `wrapPeriod`.
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
