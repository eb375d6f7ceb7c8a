//! Actuators.

use super::named;
use crate::Result;
use crate::mjcf::spec::{Actuator, Spec};
use crate::model::{
    BiasType, CompiledModel, DynamicsType, GainType, ObjectType, Parameters, TransmissionType,
};

pub(super) fn add_actuators(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for actuator in &spec.actuators {
        let place = &actuator.place;
        let (kind, ids) = transmission(m, actuator)?;
        let (mut ctrl_range, mut act_range) = (actuator.ctrl_range, actuator.act_range);
        if actuator.inherit_range > 0.0 {
            let servo = actuator.gain == GainType::Fixed
                && actuator.bias == BiasType::Affine
                && actuator.gainprm[0] == -actuator.biasprm[1];
            if servo {
                let range = inherited(m, actuator, kind, ids[0])?;
                match actuator.dynamics {
                    DynamicsType::Integrator => act_range = range,
                    _ => ctrl_range = range,
                }
            }
        }
        let limited =
            |stated, range, names| super::limited(stated, range, &actuator.compiler, place, names);
        let ctrl = ["ctrlrange", "ctrllimited"];
        let force = ["forcerange", "forcelimited"];
        let act = ["actrange", "actlimited"];
        let ctrl_limited = limited(actuator.ctrl_limited, ctrl_range, ctrl)?;
        let force_limited = limited(actuator.force_limited, actuator.force_range, force)?;
        let act_limited = limited(actuator.act_limited, act_range, act)?;
        let active = actuator.dynamics != DynamicsType::None;
        if act_limited && !active {
            return Err(place.attribute("actrange", "there is no activation"));
        }
        let muscle = actuator.gain == GainType::Muscle || actuator.bias == BiasType::Muscle;
        let mut length_range = actuator.length_range;
        if muscle && length_range[0] >= length_range[1] {
            if !spec.compiler.length_range.wants(true) {
                let reason = "missing: a muscle needs it, and the compiler does not measure it";
                return Err(place.attribute("lengthrange", reason));
            }
            // until it is measured
            length_range = [0.0, 1.0];
        }
        m.names.actuator.push(actuator.name.clone());
        m.actuator_actadr
            .push(if active { m.na() as i32 } else { -1 });
        m.actuator_trntype.push(kind);
        m.actuator_trnid.push(ids);
        m.actuator_cranklength.push(actuator.crank_length);
        m.actuator_gear.push(actuator.gear);
        m.actuator_dyntype.push(actuator.dynamics);
        m.actuator_gaintype.push(actuator.gain);
        m.actuator_biastype.push(actuator.bias);
        m.actuator_dynprm.push(Parameters(actuator.dynprm));
        m.actuator_gainprm.push(Parameters(actuator.gainprm));
        m.actuator_biasprm.push(Parameters(actuator.biasprm));
        m.actuator_ctrllimited.push(ctrl_limited);
        m.actuator_ctrlrange.push(ctrl_range);
        m.actuator_forcelimited.push(force_limited);
        m.actuator_forcerange.push(actuator.force_range);
        m.actuator_actlimited.push(act_limited);
        m.actuator_actrange.push(act_range);
        m.actuator_actearly.push(actuator.act_early);
        m.actuator_group.push(actuator.group);
        m.actuator_lengthrange.push(length_range);
        m.actuator_length0.push(0.0);
        m.actuator_acc0.push(0.0);
    }
    Ok(())
}

/// The kind and the id of an actuator's target.
fn transmission(m: &CompiledModel, actuator: &Actuator) -> Result<(TransmissionType, [i32; 2])> {
    let place = &actuator.place;
    let Some((attribute, name)) = &actuator.target else {
        return Err(place.attribute("joint", "missing: it must be given (or tendon, or site)"));
    };
    if actuator.reference_site.is_some() && *attribute != "site" {
        return Err(place.attribute("refsite", "goes with site only"));
    }
    let crank = *attribute == "cranksite";
    if !crank && (actuator.slider_site.is_some() || actuator.crank_length != 0.0) {
        return Err(place.attribute("slidersite", "goes with cranksite only"));
    }
    Ok(match *attribute {
        "tendon" => {
            let tendon = named(m, place, attribute, ObjectType::Tendon, name)?;
            (TransmissionType::Tendon, [tendon as i32, -1])
        }
        "site" => {
            let site = named(m, place, attribute, ObjectType::Site, name)?;
            let reference = match &actuator.reference_site {
                Some(name) => named(m, place, "refsite", ObjectType::Site, name)? as i32,
                None => -1,
            };
            (TransmissionType::Site, [site as i32, reference])
        }
        "cranksite" => {
            let pin = named(m, place, attribute, ObjectType::Site, name)?;
            let slider = actuator
                .slider_site
                .as_ref()
                .ok_or_else(|| place.attribute("slidersite", "missing: a slider-crank needs it"))?;
            let slider = named(m, place, "slidersite", ObjectType::Site, slider)?;
            if actuator.crank_length <= 0.0 {
                return Err(place.attribute("cranklength", "must be positive"));
            }
            (TransmissionType::SliderCrank, [pin as i32, slider as i32])
        }
        "body" => {
            let body = named(m, place, attribute, ObjectType::Body, name)?;
            (TransmissionType::Body, [body as i32, -1])
        }
        _ => {
            let joint = named(m, place, attribute, ObjectType::Joint, name)?;
            let kind = match *attribute {
                "joint" => TransmissionType::Joint,
                _ => TransmissionType::JointInParent,
            };
            (kind, [joint as i32, -1])
        }
    })
}

/// The range of a servo: `inheritrange` times the range of its target.
fn inherited(
    m: &CompiledModel,
    actuator: &Actuator,
    kind: TransmissionType,
    id: i32,
) -> Result<[f64; 2]> {
    let id = usize::try_from(id).unwrap_or(0);
    let range = match kind {
        TransmissionType::Tendon => m.tendon_range[id],
        TransmissionType::Joint if m.jnt_type[id].is_scalar() => m.jnt_range[id],
        _ => [0.0; 2],
    };
    if range[0] == range[1] {
        let reason = "needs a slide, hinge or tendon with a range";
        return Err(actuator.place.attribute("inheritrange", reason));
    }
    let mean = 0.5 * (range[1] + range[0]);
    let radius = 0.5 * (range[1] - range[0]) * actuator.inherit_range;
    Ok([mean - radius, mean + radius])
}
