//! Tendons and their paths.

use super::{named, scalar_joint};
use crate::Result;
use crate::mjcf::spec::{Spec, Wrap};
use crate::mjcf::xml::Place;
use crate::model::{CompiledModel, GeomType, ObjectType, WrapType};

pub(super) fn add_tendons(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for tendon in &spec.tendons {
        let place = &tendon.place;
        m.names.tendon.push(tendon.name.clone());
        m.tendon_adr.push(m.wrap_objid.len());
        m.tendon_num.push(tendon.wraps.len());
        for (place, wrap) in &tendon.wraps {
            add_wrap(m, place, wrap)?;
        }
        let first = m.wrap_type.len() - tendon.wraps.len();
        check_path(place, &m.wrap_type[first..])?;
        let limited =
            |stated, range, names| super::limited(stated, range, &tendon.compiler, place, names);
        let of_range = limited(tendon.limited, tendon.range, ["range", "limited"])?;
        // before 4.0, a force range without `limited` does not limit the force
        let old = !spec.revision.limits_by_force_range();
        let stated = tendon.force_limited.unwrap_or(old.then_some(false));
        let names = ["actuatorfrcrange", "actuatorfrclimited"];
        let force_limited = limited(stated, tendon.force_range, names)?;
        if tendon.spring_length[0] > tendon.spring_length[1] {
            return Err(place.attribute("springlength", "must rise"));
        }
        m.tendon_limited.push(of_range);
        m.tendon_range.push(tendon.range);
        m.tendon_actfrclimited.push(force_limited);
        m.tendon_actfrcrange.push(tendon.force_range);
        m.tendon_margin.push(tendon.margin);
        let [stiffness, higher @ ..] = tendon.stiffness;
        m.tendon_stiffness.push(stiffness);
        m.tendon_stiffnesspoly.push(higher);
        let [damping, higher @ ..] = tendon.damping;
        m.tendon_damping.push(damping);
        m.tendon_dampingpoly.push(higher);
        m.tendon_frictionloss.push(tendon.friction_loss);
        m.tendon_armature.push(tendon.armature);
        let around = m.wrap_type[first..]
            .iter()
            .any(|kind| matches!(kind, WrapType::Sphere | WrapType::Cylinder));
        if around && tendon.armature != 0.0 {
            let reason = "does not go with a path around geoms";
            return Err(place.attribute("armature", reason));
        }
        m.tendon_lengthspring.push(tendon.spring_length);
        m.tendon_solref_lim.push(tendon.solref);
        m.tendon_solimp_lim.push(tendon.solimp);
        m.tendon_solref_fri.push(tendon.solref_friction);
        m.tendon_solimp_fri.push(tendon.solimp_friction);
        m.tendon_length0.push(0.0);
        m.tendon_invweight0.push(0.0);
    }
    Ok(())
}

fn add_wrap(m: &mut CompiledModel, place: &Place, wrap: &Wrap) -> Result<()> {
    let (kind, id, number) = match wrap {
        Wrap::Joint(name, coefficient) => {
            let joint = scalar_joint(m, place, "joint", name)?;
            (WrapType::Joint, joint as i32, *coefficient)
        }
        Wrap::Pulley(divisor) => (WrapType::Pulley, -1, *divisor),
        Wrap::Site(name) => {
            let site = named(m, place, "site", ObjectType::Site, name)?;
            (WrapType::Site, site as i32, 0.0)
        }
        Wrap::Geom(name, side) => {
            let geom = named(m, place, "geom", ObjectType::Geom, name)?;
            let kind = match m.geom_type[geom] {
                GeomType::Sphere => WrapType::Sphere,
                GeomType::Cylinder => WrapType::Cylinder,
                _ => {
                    let reason = "a tendon runs around spheres and cylinders only";
                    return Err(place.attribute("geom", reason));
                }
            };
            let side = match side {
                Some(name) => named(m, place, "sidesite", ObjectType::Site, name)? as f64,
                None => -1.0,
            };
            (kind, geom as i32, side)
        }
    };
    m.wrap_type.push(kind);
    m.wrap_objid.push(id);
    m.wrap_prm.push(number);
    Ok(())
}

/// Refuses tendon paths that MuJoCo does not support.
fn check_path(place: &Place, path: &[WrapType]) -> Result<()> {
    let at = |i: usize| path.get(i).copied();
    let before = |i: usize| i.checked_sub(1).and_then(at);
    let open = |part: Option<WrapType>| matches!(part, None | Some(WrapType::Pulley));
    for (i, part) in path.iter().enumerate() {
        let wrong = match part {
            WrapType::Joint => false,
            WrapType::Pulley => i + 1 == path.len() || before(i) == Some(WrapType::Pulley),
            WrapType::Site => open(before(i)) && open(at(i + 1)),
            _ => before(i) != Some(WrapType::Site) || at(i + 1) != Some(WrapType::Site),
        };
        if wrong {
            return Err(place.error(format!(
                "part {i} of the path: a pulley has sites behind it, a site a neighbour, and a geom is between sites"
            )));
        }
    }
    Ok(())
}
