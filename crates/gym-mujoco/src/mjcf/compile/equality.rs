//! Equality constraints.

use super::{named, scalar_joint};
use crate::mjcf::orientation::unit;
use crate::mjcf::spec::Spec;
use crate::model::{CompiledModel, EqualityType, ObjectType};
use crate::{Result, Revision};

pub(super) fn add_equalities(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for equality in &spec.equalities {
        let (kind, place) = (equality.kind, &equality.place);
        let id = |name: &Option<String>, number: usize| {
            let Some(name) = name else { return Ok(-1) };
            let both = |one: &'static str, two: &'static str| [one, two][number];
            let id = match kind {
                EqualityType::Joint => scalar_joint(m, place, both("joint1", "joint2"), name)?,
                EqualityType::Tendon => {
                    let attribute = both("tendon1", "tendon2");
                    named(place, attribute, "tendon", &m.names.tendon, name)?
                }
                _ if equality.sites => {
                    named(place, both("site1", "site2"), "site", &m.names.site, name)?
                }
                _ => named(place, both("body1", "body2"), "body", &m.names.body, name)?,
            };
            Ok(id as i32)
        };
        let (first, second) = (id(&equality.names[0], 0)?, id(&equality.names[1], 1)?);
        let objects = match kind {
            EqualityType::Joint => ObjectType::Joint,
            EqualityType::Tendon => ObjectType::Tendon,
            _ if equality.sites => ObjectType::Site,
            _ => ObjectType::Body,
        };
        // if the second body is not named, the world is the second body
        let second = if objects == ObjectType::Body {
            second.max(0)
        } else {
            second
        };
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
        if kind == EqualityType::Weld && m.revision == Revision::V4_0 {
            // MuJoCo 3.12 normalises the relative pose later, as in a step
            let pose = unit([data[6], data[7], data[8], data[9]]).0;
            data[6..10].copy_from_slice(&pose);
        }
        m.eq_data.push(data);
    }
    Ok(())
}
