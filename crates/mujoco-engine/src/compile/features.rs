//! Checks references between objects.

use super::check::same;
use crate::Result;
use crate::error::ensure;
use crate::model::{
    About, CompiledModel, DynamicsType, EqualityType, GeomType, ObjectType, TransmissionType,
    WrapType,
};

/// The largest number of values of all sensors.
const MOST_VALUES: usize = 1 << 20;

/// Checks ids of actuators, tendons, equality constraints, sensors and pairs.
pub(super) fn check(m: &CompiledModel) -> Result<()> {
    actuators(m)?;
    tendons(m)?;
    equalities(m)?;
    sensors(m)?;
    for (i, (&g1, &g2)) in m.pair_geom1.iter().zip(&m.pair_geom2).enumerate() {
        ensure!(
            g1 < m.ngeom() && g2 < m.ngeom() && g1 != g2,
            "pair {i} is of geoms {g1} and {g2}, and there are {}",
            m.ngeom()
        );
        ensure!(
            matches!(m.pair_dim[i], 1 | 3 | 4 | 6),
            "pair_dim[{i}] is {}: use 1, 3, 4 or 6",
            m.pair_dim[i]
        );
    }
    Ok(())
}

/// The number of objects of a kind.
fn count(m: &CompiledModel, kind: ObjectType) -> usize {
    match kind {
        ObjectType::Unknown => 0,
        ObjectType::Body | ObjectType::XBody => m.nbody(),
        ObjectType::Joint => m.njnt(),
        ObjectType::Geom => m.ngeom(),
        ObjectType::Site => m.nsite(),
        ObjectType::Camera => m.cam_bodyid.len(),
        ObjectType::Tendon => m.ntendon(),
        ObjectType::Actuator => m.nu(),
    }
}

fn exists(m: &CompiledModel, kind: ObjectType, id: i32) -> bool {
    usize::try_from(id).is_ok_and(|id| id < count(m, kind))
}

/// Whether a joint is a slide or a hinge.
fn scalar(m: &CompiledModel, id: i32) -> bool {
    let kind = usize::try_from(id).ok().and_then(|id| m.jnt_type.get(id));
    kind.is_some_and(|kind| kind.is_scalar())
}

fn actuators(m: &CompiledModel) -> Result<()> {
    let mut activations = 0;
    for i in 0..m.nu() {
        let [id, reference] = m.actuator_trnid[i];
        let kind = match m.actuator_trntype[i] {
            TransmissionType::Joint | TransmissionType::JointInParent => ObjectType::Joint,
            TransmissionType::Tendon => ObjectType::Tendon,
            TransmissionType::Site | TransmissionType::SliderCrank => ObjectType::Site,
            TransmissionType::Body => ObjectType::Body,
        };
        ensure!(
            exists(m, kind, id),
            "actuator_trnid[{i}] is {id}, and there are {} of this kind",
            count(m, kind)
        );
        ensure!(
            reference == -1 || (kind == ObjectType::Site && exists(m, kind, reference)),
            "actuator_trnid[{i}] refers to {reference}, which is no site of reference"
        );
        ensure!(
            m.actuator_trntype[i] != TransmissionType::SliderCrank
                || (reference >= 0 && m.actuator_cranklength[i] > 0.0),
            "actuator {i} is a slider-crank without a slider's site or a positive cranklength"
        );
        let active = m.actuator_dyntype[i] != DynamicsType::None;
        let expected = if active { activations } else { -1 };
        same("actuator_actadr", i, m.actuator_actadr[i], expected)?;
        activations += i32::from(active);
    }
    Ok(())
}

fn tendons(m: &CompiledModel) -> Result<()> {
    for t in 0..m.ntendon() {
        let (first, number) = (m.tendon_adr[t], m.tendon_num[t]);
        let end = first.checked_add(number);
        ensure!(
            number > 0 && end.is_some_and(|end| end <= m.wrap_objid.len()),
            "tendon {t} has no parts, or parts beyond the last"
        );
        let fixed = m.wrap_type[first] == WrapType::Joint;
        for w in first..first + number {
            let (kind, id) = (m.wrap_type[w], m.wrap_objid[w]);
            let fits = match kind {
                WrapType::Joint => scalar(m, id),
                WrapType::Pulley => id == -1,
                WrapType::Site => exists(m, ObjectType::Site, id),
                WrapType::Sphere | WrapType::Cylinder => exists(m, ObjectType::Geom, id),
            };
            ensure!(
                fits && (kind == WrapType::Joint) == fixed,
                "wrap_objid[{w}] is {id}, which does not fit its kind or its tendon"
            );
            let around = matches!(kind, WrapType::Sphere | WrapType::Cylinder);
            let side = m.wrap_prm[w].round();
            ensure!(
                !around || side < 0.0 || exists(m, ObjectType::Site, side as i32),
                "wrap_prm[{w}] is {side}, which is no side site (-1 for none)"
            );
        }
        let path = &m.wrap_type[first..first + number];
        ensure!(
            fixed || sound(path),
            "tendon {t} has a path that leads nowhere"
        );
    }
    Ok(())
}

/// Whether each geom of a path is between two sites, and each part after a pulley begins with a
/// site.
fn sound(path: &[WrapType]) -> bool {
    let site = |i: usize| path.get(i) == Some(&WrapType::Site);
    path.iter().enumerate().all(|(i, part)| match part {
        WrapType::Site | WrapType::Joint => true,
        WrapType::Pulley => site(i + 1),
        WrapType::Sphere | WrapType::Cylinder => i > 0 && site(i - 1) && site(i + 1),
    })
}

fn equalities(m: &CompiledModel) -> Result<()> {
    for i in 0..m.neq() {
        let (kind, objects) = (m.eq_type[i], m.eq_objtype[i]);
        let (first, second) = (m.eq_obj1id[i], m.eq_obj2id[i]);
        let fits = match kind {
            EqualityType::Connect | EqualityType::Weld => {
                matches!(objects, ObjectType::Body | ObjectType::Site)
                    && exists(m, objects, first)
                    && exists(m, objects, second)
            }
            EqualityType::Joint => scalar(m, first) && (second == -1 || scalar(m, second)),
            EqualityType::Tendon => {
                let tendon = |id| exists(m, ObjectType::Tendon, id);
                tendon(first) && (second == -1 || tendon(second))
            }
        };
        ensure!(
            fits && first != second,
            "equality constraint {i} relates {first} and {second}, which are not two such objects"
        );
    }
    Ok(())
}

fn sensors(m: &CompiledModel) -> Result<()> {
    let mut next = 0;
    for i in 0..m.nsensor() {
        for (kind, id) in [
            (m.sensor_objtype[i], m.sensor_objid[i]),
            (m.sensor_reftype[i], m.sensor_refid[i]),
        ] {
            let none = kind == ObjectType::Unknown && id == -1;
            ensure!(
                none || exists(m, kind, id),
                "sensor {i} refers to {id}, and there are {} of this kind",
                count(m, kind)
            );
        }
        ensure!(
            m.sensor_dim[i] == m.sensor_values(i) && m.sensor_adr[i] == next,
            "sensor_dim[{i}] or sensor_adr[{i}] does not fit the sensor"
        );
        next += m.sensor_dim[i];
        let about = m.sensor_type[i].about();
        let kinds = (m.sensor_objtype[i], m.sensor_reftype[i]);
        ensure!(
            measurable(about, kinds),
            "sensor {i} is not of these types of objects: {kinds:?}"
        );
        ensure!(
            next <= MOST_VALUES,
            "more than {MOST_VALUES} values of sensors are not supported"
        );
        for (kind, id) in [
            (m.sensor_objtype[i], m.sensor_objid[i]),
            (m.sensor_reftype[i], m.sensor_refid[i]),
        ] {
            ensure!(
                kind != ObjectType::Camera || !matches!(m.cam_mode[id as usize], 1 | 2),
                "sensor {i} refers to a camera that tracks a body, which is not supported"
            );
            let geoms = match (about, kind) {
                (About::Pair, ObjectType::Geom) => id as usize..id as usize + 1,
                (About::Pair, ObjectType::Body) => m.geoms_of(id as usize),
                _ => 0..0,
            };
            ensure!(
                !m.geom_type[geoms].contains(&GeomType::Hfield),
                "sensor {i} measures the distance of a height field, which is not supported"
            );
        }
    }
    Ok(())
}

/// Whether a sensor of objects of a kind can have an object and a reference object of these types.
fn measurable(about: About, (object, reference): (ObjectType, ObjectType)) -> bool {
    use ObjectType::{Actuator, Body, Camera, Geom, Joint, Site, Tendon, Unknown, XBody};
    let frame = |kind| matches!(kind, Body | XBody | Geom | Site | Camera);
    match about {
        About::Nothing => true,
        About::Site => object == Site,
        About::Joint | About::Ball => object == Joint,
        About::Tendon => object == Tendon,
        About::Actuator => object == Actuator,
        About::Body => matches!(object, Body | XBody),
        About::Frame => frame(object),
        About::Relative => frame(object) && (frame(reference) || reference == Unknown),
        About::Inside => frame(object) && reference == Site,
        About::Projection => (object, reference) == (Site, Camera),
        About::Contact => {
            let part = |kind| matches!(kind, Unknown | Body | XBody | Geom);
            (object == Site || part(object)) && part(reference)
        }
        About::Pair => {
            let part = |kind| matches!(kind, Body | Geom);
            part(object) && part(reference)
        }
        About::Ray => matches!(object, Site | Camera),
    }
}
