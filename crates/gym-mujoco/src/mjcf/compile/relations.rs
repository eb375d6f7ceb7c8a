//! Contact pairs, equality constraints, tendons and keyframes.

use crate::mjcf::orientation::unit;
use crate::mjcf::spec::{Key, Spec, Wrap};
use crate::mjcf::xml::Place;
use crate::model::{
    CompiledModel, EqualityType, GeomType, JointType, ObjectType, WrapType, signature,
};
use crate::physics::spatial::{InTurn, Order};
use crate::{Result, Revision};

/// The object with the name, or an error.
pub(super) fn named(
    place: &Place,
    attribute: &str,
    kind: &str,
    names: &[Option<String>],
    name: &str,
) -> Result<usize> {
    let found = names.iter().position(|n| n.as_deref() == Some(name));
    found.ok_or_else(|| place.attribute(attribute, format!("there is no {kind} {name:?}")))
}

/// The slide or hinge of that name.
pub(super) fn scalar_joint(
    m: &CompiledModel,
    place: &Place,
    attribute: &str,
    name: &str,
) -> Result<usize> {
    let id = named(place, attribute, "joint", &m.names.joint, name)?;
    if m.jnt_type[id].is_scalar() {
        return Ok(id);
    }
    let reason = format!("{name:?} is free or a ball: only a slide or hinge is supported here");
    Err(place.attribute(attribute, reason))
}

pub(super) fn add_excludes(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for exclude in &spec.excludes {
        let id = |name: &str, attribute: &str| {
            named(&exclude.place, attribute, "body", &m.names.body, name)
        };
        let bodies = [
            id(&exclude.bodies[0], "body1")?,
            id(&exclude.bodies[1], "body2")?,
        ];
        m.exclude_signature.push(signature(bodies));
    }
    m.exclude_signature.sort_unstable();
    Ok(())
}

/// Adds the pairs of geoms, sorted by their bodies.
pub(super) fn add_pairs(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    let mut pairs = Vec::new();
    for pair in &spec.pairs {
        let place = &pair.place;
        let id = |geom: &Option<String>, attribute: &str| match geom {
            Some(name) => named(place, attribute, "geom", &m.names.geom, name),
            None => Err(place.attribute(attribute, "missing: it must be given")),
        };
        let geoms = [id(&pair.geoms[0], "geom1")?, id(&pair.geoms[1], "geom2")?];
        let bodies = geoms.map(|g| m.geom_bodyid[g]);
        // geoms in the order of their bodies
        let [g1, g2] = if bodies[0] > bodies[1] {
            [geoms[1], geoms[0]]
        } else {
            geoms
        };
        pairs.push((signature(bodies), g1, g2, pair));
    }
    pairs.sort_by_key(|(signature, ..)| *signature);
    for (_, g1, g2, pair) in pairs {
        m.pair_geom1.push(g1);
        m.pair_geom2.push(g2);
        m.pair_dim.push(pair.condim);
        m.pair_friction.push(pair.friction);
        m.pair_solref.push(pair.solref);
        m.pair_solreffriction.push(pair.solref_friction);
        m.pair_solimp.push(pair.solimp);
        m.pair_margin.push(pair.margin);
        m.pair_gap.push(pair.gap);
    }
    Ok(())
}

pub(super) fn add_tendons(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for tendon in &spec.tendons {
        let place = &tendon.place;
        m.names.tendon.push(tendon.name.clone());
        m.tendon_adr.push(m.wrap_objid.len());
        m.tendon_num.push(tendon.wraps.len());
        for (place, wrap) in &tendon.wraps {
            add_wrap(m, place, wrap)?;
        }
        check_path(
            place,
            &m.wrap_type[m.wrap_type.len() - tendon.wraps.len()..],
        )?;
        let limited = super::limited(
            tendon.limited,
            tendon.range,
            spec,
            place,
            ["range", "limited"],
        )?;
        // before 4.0, a force range without `limited` does not limit the force
        let old = spec.revision == Revision::V3_12;
        let force_limited = super::limited(
            tendon.force_limited.unwrap_or(old.then_some(false)),
            tendon.force_range,
            spec,
            place,
            ["actuatorfrcrange", "actuatorfrclimited"],
        )?;
        if tendon.spring_length[0] > tendon.spring_length[1] {
            return Err(place.attribute("springlength", "must rise"));
        }
        m.tendon_limited.push(limited);
        m.tendon_range.push(tendon.range);
        m.tendon_actfrclimited.push(force_limited);
        m.tendon_actfrcrange.push(tendon.force_range);
        m.tendon_margin.push(tendon.margin);
        m.tendon_stiffness.push(tendon.stiffness);
        m.tendon_damping.push(tendon.damping);
        m.tendon_frictionloss.push(tendon.friction_loss);
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
            let site = named(place, "site", "site", &m.names.site, name)?;
            (WrapType::Site, site as i32, 0.0)
        }
        Wrap::Geom(name, side) => {
            let geom = named(place, "geom", "geom", &m.names.geom, name)?;
            let kind = match m.geom_type[geom] {
                GeomType::Sphere => WrapType::Sphere,
                GeomType::Cylinder => WrapType::Cylinder,
                _ => {
                    let reason = "a tendon runs around spheres and cylinders only";
                    return Err(place.attribute("geom", reason));
                }
            };
            let side = match side {
                Some(name) => named(place, "sidesite", "site", &m.names.site, name)? as f64,
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

pub(super) fn add_keys(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    let mocap: Vec<usize> = (0..m.nbody()).filter(|b| m.body_mocapid[*b] >= 0).collect();
    let mpos: Vec<f64> = mocap.iter().flat_map(|b| m.body_pos[*b]).collect();
    let mquat: Vec<f64> = mocap.iter().flat_map(|b| m.body_quat[*b]).collect();
    let nothing = Key::default();
    let more = spec.nkey.saturating_sub(spec.keys.len());
    for key in spec.keys.iter().chain(std::iter::repeat_n(&nothing, more)) {
        let fitting = |name: &str, given: &Option<Vec<f64>>, default: &[f64], least: usize| {
            let Some(numbers) = given else {
                return Ok(default.to_vec());
            };
            let (have, need) = (numbers.len(), default.len());
            if (least..=need).contains(&have) {
                // the missing numbers are those of the initial state
                return Ok([&numbers[..], &default[have..]].concat());
            }
            Err(key
                .place
                .attribute(name, format!("{have} numbers, and the model needs {need}")))
        };
        // lists for joints and actuators may be shorter than in the model; lists for mocap bodies
        // may not
        let mut qpos = fitting("qpos", &key.qpos, &m.qpos0, 0)?;
        normalize_quaternions(m, &mut qpos);
        let qvel = fitting("qvel", &key.qvel, &vec![0.0; m.nv()], 0)?;
        let act = fitting("act", &key.act, &vec![0.0; m.na()], 0)?;
        let ctrl = fitting("ctrl", &key.ctrl, &vec![0.0; m.nu()], 0)?;
        let mpos = fitting("mpos", &key.mpos, &mpos, mpos.len())?;
        let mut mquat = fitting("mquat", &key.mquat, &mquat, mquat.len())?;
        for quat in mquat.chunks_mut(4) {
            normalize(quat);
        }
        m.names.key.push(key.name.clone());
        m.key_time.push(key.time);
        m.key_qpos.push(qpos);
        m.key_qvel.push(qvel);
        m.key_act.push(act);
        m.key_ctrl.push(ctrl);
        m.key_mpos.push(mpos);
        m.key_mquat.push(mquat);
    }
    Ok(())
}

fn normalize_quaternions(m: &CompiledModel, qpos: &mut [f64]) {
    for j in 0..m.njnt() {
        let start = match m.jnt_type[j] {
            JointType::Free => m.jnt_qposadr[j] + 3,
            JointType::Ball => m.jnt_qposadr[j],
            _ => continue,
        };
        normalize(&mut qpos[start..start + 4]);
    }
}

fn normalize(quat: &mut [f64]) {
    let long = unit([quat[0], quat[1], quat[2], quat[3]]).0;
    quat.copy_from_slice(&InTurn::normalize_quat((), long));
}
