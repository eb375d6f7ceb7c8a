//! Equality constraints.

use super::{named, scalar_joint};
use crate::Result;
use crate::mjcf::orientation::unit;
use crate::mjcf::spec::Spec;
use crate::model::{CompiledModel, EqualityType, ObjectType};

pub(super) fn add_equalities(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for equality in &spec.equalities {
        let (kind, place) = (equality.kind, &equality.place);
        let (objects, attributes) = match kind {
            EqualityType::Joint => (ObjectType::Joint, ["joint1", "joint2"]),
            EqualityType::Tendon => (ObjectType::Tendon, ["tendon1", "tendon2"]),
            _ if equality.sites => (ObjectType::Site, ["site1", "site2"]),
            _ => (ObjectType::Body, ["body1", "body2"]),
        };
        // if the second body is not named, the world is the second body
        let missing = if objects == ObjectType::Body { 0 } else { -1 };
        let id = |number: usize| match (&equality.names[number], attributes[number]) {
            (None, _) => Ok(missing),
            (Some(name), attribute) if kind == EqualityType::Joint => {
                scalar_joint(m, place, attribute, name).map(|id| id as i32)
            }
            (Some(name), attribute) => {
                named(m, place, attribute, objects, name).map(|id| id as i32)
            }
        };
        let (first, second) = (id(0)?, id(1)?);
        if first == second {
            return Err(place.error("relates an object to itself"));
        }
        m.names.equality.push(equality.name.clone());
        m.eq_type.push(kind);
        m.eq_objtype.push(objects);
        m.eq_obj1id.push(first);
        m.eq_obj2id.push(second);
        m.eq_active0.push(equality.active);
        m.eq_solref.push(equality.solref);
        m.eq_solimp.push(equality.solimp);
        let mut data = equality.data;
        if kind == EqualityType::Weld && m.revision.normalizes_weld_poses() {
            // MuJoCo 3.12 normalises the relative pose later, as in a step
            let pose = unit([data[6], data[7], data[8], data[9]]).0;
            data[6..10].copy_from_slice(&pose);
        }
        m.eq_data.push(data);
    }
    Ok(())
}
