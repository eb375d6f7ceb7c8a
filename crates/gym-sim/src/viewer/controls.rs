//! The sliders of a model's actuators.

use mujoco_engine::CompiledModel;
use mujoco_engine::model::{
    BiasType, DynamicsType, GainType, JointType, ObjectType, TransmissionType,
};

/// The control of an actuator.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// The name of the actuator, or its number.
    pub name: String,
    /// The range of the control; for one without a range, the range of a slider: of a servo, that
    /// of its joint, and else -1 to 1.
    pub range: [f64; 2],
    /// Whether the range is that of the actuator.
    pub is_limited: bool,
}

pub(super) fn of(model: &CompiledModel) -> Vec<Control> {
    let control = |i: usize| {
        let is_limited = model.actuator_ctrllimited[i];
        let range = if is_limited {
            model.actuator_ctrlrange[i]
        } else {
            servo(model, i).unwrap_or([-1.0, 1.0])
        };
        Control {
            name: super::name(model, ObjectType::Actuator, i),
            range,
            is_limited,
        }
    };
    (0..model.nu()).map(control).collect()
}

/// The range of the positions of a servo: an actuator on a slide or a hinge that pulls it to its
/// control.
fn servo(m: &CompiledModel, i: usize) -> Option<[f64; 2]> {
    let gain = m.actuator_gainprm[i].0[0];
    let pulls = m.actuator_gaintype[i] == GainType::Fixed
        && m.actuator_biastype[i] == BiasType::Affine
        && m.actuator_biasprm[i].0[1] == -gain
        && gain > 0.0
        && m.actuator_dyntype[i] != DynamicsType::Integrator;
    let joint = match m.actuator_trntype[i] {
        TransmissionType::Joint | TransmissionType::JointInParent if pulls => {
            usize::try_from(m.actuator_trnid[i][0]).ok()?
        }
        _ => return None,
    };
    let turn = std::f64::consts::PI;
    let [low, high] = match m.jnt_type[joint] {
        JointType::Slide | JointType::Hinge if m.jnt_limited[joint] => m.jnt_range[joint],
        JointType::Hinge => [-turn, turn],
        _ => return None,
    };
    // the length of the actuator is the position times the gear
    let gear = m.actuator_gear[i][0];
    let ends = [low * gear, high * gear];
    (low < high && gear != 0.0).then(|| [ends[0].min(ends[1]), ends[0].max(ends[1])])
}
