//! From a [`Spec`] to the figures of a model: ids, frames, masses.

use std::collections::HashSet;

use super::inertia::{self, Inertia, MINVAL};
use super::orientation::{EPS, from_z, norm, unit};
use super::spec::{Body, Geom, Inertial, Joint, Moments, Spec};
use super::xml::Place;
use crate::Result;
use crate::model::{CompiledModel, GeomType, JointType};
use crate::physics::spatial::{InTurn, Order};

/// The most bodies, geoms and degrees of freedom, as the engine's matrices are dense; and the most
/// of everything that is looked up by its name.
pub(super) const MOST: usize = 1000;

/// The figures, but for those that follow from the inertia matrix in the initial configuration.
pub(super) fn compile(spec: &Spec) -> Result<CompiledModel> {
    let mut m = CompiledModel {
        model: spec.name.clone(),
        revision: spec.revision,
        opt: spec.option.clone(),
        ..CompiledModel::default()
    };
    check_counts(spec)?;
    for (id, body) in spec.bodies.iter().enumerate() {
        add_body(&mut m, spec, id, body)?;
    }
    scale_mass(&mut m, spec.compiler.total_mass);
    check_mass(&m, spec)?;
    add_subtree_masses(&mut m);
    mark_simple(&mut m);
    add_looks(&mut m, spec)?;
    add_excludes(&mut m, spec)?;
    add_tendons(&mut m, spec)?;
    add_motors(&mut m, spec)?;
    add_keys(&mut m, spec)?;
    check_names(spec)?;
    Ok(m)
}

fn add_body(m: &mut CompiledModel, spec: &Spec, id: usize, body: &Body) -> Result<()> {
    let parent = body.parent;
    let degree = spec.compiler.degree;
    m.names.body.push(body.name.clone());
    m.body_parentid.push(parent);
    m.body_rootid.push(if id == 0 || parent == 0 {
        id
    } else {
        m.body_rootid[parent]
    });
    m.body_weldid.push(if id == 0 || !body.joints.is_empty() {
        id
    } else {
        m.body_weldid[parent]
    });
    m.body_pos.push(body.pos);
    m.body_quat.push(body.orientation.resolve(degree));

    let first_dof = m.nv();
    m.body_jntnum.push(body.joints.len());
    m.body_jntadr.push(address(m.njnt(), body.joints.len()));
    for joint in &body.joints {
        add_joint(m, spec, id, body, joint)?;
    }
    m.body_dofnum.push(m.nv() - first_dof);
    m.body_dofadr.push(address(first_dof, m.nv() - first_dof));
    let last_dof = if m.nv() > first_dof {
        m.nv() as i32 - 1
    } else {
        last_dof(m, parent)
    };
    m.body_treeid
        .push(usize::try_from(last_dof).map_or(-1, |dof| m.dof_treeid[dof] as i32));

    m.body_geomnum.push(body.geoms.len());
    m.body_geomadr.push(address(m.ngeom(), body.geoms.len()));
    let mut parts = Vec::with_capacity(body.geoms.len());
    for geom in &body.geoms {
        parts.push(add_geom(m, spec, id, geom)?);
    }
    // the world has no mass
    parts.truncate(if id == 0 { 0 } else { parts.len() });
    let inertia = inertia_of(body, spec, &parts)?;
    m.body_mass.push(inertia.mass);
    m.body_ipos.push(inertia.pos);
    m.body_iquat.push(inertia.quat);
    m.body_inertia.push(inertia.moments);

    for site in &body.sites {
        m.names.site.push(site.name.clone());
        m.site_bodyid.push(id);
        m.site_type.push(site.shape);
        m.site_size.push(site.size);
        m.site_pos.push(site.pos);
        m.site_quat.push(site.orientation.resolve(degree));
        m.site_rgba.push(single(site.rgba));
    }
    if m.nbody() > MOST || m.ngeom() > MOST || m.nv() > MOST {
        let reason =
            format!("more than {MOST} bodies, geoms or degrees of freedom are not supported");
        return Err(body.place.error(reason));
    }
    Ok(())
}

/// The first of so many elements; -1 if there is none.
fn address(next: usize, count: usize) -> i32 {
    if count == 0 { -1 } else { next as i32 }
}

/// The last degree of freedom of a body or of its nearest ancestor that has one; -1 if none has.
fn last_dof(m: &CompiledModel, mut body: usize) -> i32 {
    while body > 0 && m.body_dofnum[body] == 0 {
        body = m.body_parentid[body];
    }
    if m.body_dofnum[body] == 0 {
        -1
    } else {
        m.body_dofadr[body] + m.body_dofnum[body] as i32 - 1
    }
}

fn add_joint(
    m: &mut CompiledModel,
    spec: &Spec,
    body_id: usize,
    body: &Body,
    joint: &Joint,
) -> Result<()> {
    let Joint { place, kind, .. } = joint;
    let free = *kind == JointType::Free;
    let limited = !free
        && limited(joint.limited, joint.range, spec.compiler.autolimits).ok_or_else(|| {
            place.attribute(
                "range",
                "needs limited=\"true\" here, where autolimits is false",
            )
        })?;
    if free && body.parent != 0 {
        return Err(place.attribute(
            "type",
            "a free joint belongs to a body directly in the world",
        ));
    }
    if free && body.joints.len() > 1 {
        return Err(place.attribute("type", "a free joint must be the only joint of its body"));
    }
    if limited && joint.range[0] >= joint.range[1] {
        return Err(place.attribute("range", "the lower limit must be less than the upper one"));
    }
    let to_radians = spec.compiler.degree && *kind == JointType::Hinge;
    let angle = |x: f64| {
        if to_radians {
            x * (std::f64::consts::PI / 180.0)
        } else {
            x
        }
    };
    m.names.joint.push(joint.name.clone());
    m.jnt_type.push(*kind);
    m.jnt_qposadr.push(m.nq());
    m.jnt_dofadr.push(m.nv());
    m.jnt_bodyid.push(body_id);
    m.jnt_limited.push(limited);
    m.jnt_pos.push(if free { [0.0; 3] } else { joint.pos });
    m.jnt_axis.push(if free {
        [0.0, 0.0, 1.0]
    } else {
        unit(joint.axis).0
    });
    m.jnt_range.push(if limited {
        joint.range.map(angle)
    } else {
        joint.range
    });
    m.jnt_margin.push(joint.margin);
    m.jnt_stiffness.push(joint.stiffness);
    m.jnt_solref.push(joint.solref);
    m.jnt_solimp.push(joint.solimp);
    if free {
        let (pos, quat) = (body.pos, m.body_quat[body_id]);
        m.qpos0.extend(pos.iter().chain(&quat));
        m.qpos_spring.extend(pos.iter().chain(&quat));
    } else {
        m.qpos0.push(angle(joint.reference));
        m.qpos_spring.push(angle(joint.spring_reference));
    }
    for _ in 0..if free { 6 } else { 1 } {
        let dof = m.nv();
        let first_of_body = dof == 0 || m.dof_bodyid[dof - 1] != body_id;
        let parent = if first_of_body {
            last_dof(m, body.parent)
        } else {
            dof as i32 - 1
        };
        let new_tree = m.dof_treeid.last().map_or(0, |tree| tree + 1);
        m.dof_bodyid.push(body_id);
        m.dof_jntid.push(m.njnt() - 1);
        m.dof_parentid.push(parent);
        m.dof_treeid
            .push(usize::try_from(parent).map_or(new_tree, |parent| m.dof_treeid[parent]));
        m.dof_armature.push(joint.armature);
        m.dof_damping.push(joint.damping);
    }
    Ok(())
}

/// Whether a range holds, which by default it does where it is given; `None` where that must be
/// said and is not.
fn limited(stated: Option<bool>, range: [f64; 2], autolimits: bool) -> Option<bool> {
    match stated {
        Some(limited) => Some(limited),
        None if range == [0.0; 2] => Some(false),
        None => autolimits.then_some(true),
    }
}

/// Adds a geom and returns its mass and where it is in its body.
fn add_geom(m: &mut CompiledModel, spec: &Spec, body: usize, geom: &Geom) -> Result<Inertia> {
    let Geom { place, shape, .. } = geom;
    let (mut size, mut pos, mut quat) = (
        geom.size,
        geom.pos.unwrap_or_default(),
        geom.orientation.resolve(spec.compiler.degree),
    );
    if let Some([x0, y0, z0, x1, y1, z1]) = geom.fromto {
        if !matches!(shape, GeomType::Capsule | GeomType::Cylinder) {
            return Err(place.attribute(
                "fromto",
                "only capsules and cylinders have ends: give type=\"capsule\"",
            ));
        }
        if geom.pos.is_some() {
            return Err(place.attribute("fromto", "does not go with pos, which it implies"));
        }
        let (along, length) = unit([x0 - x1, y0 - y1, z0 - z1]);
        size[1] = length / 2.0;
        if size[1] < EPS {
            return Err(place.attribute("fromto", "the ends are too close"));
        }
        pos = [(x0 + x1) / 2.0, (y0 + y1) / 2.0, (z0 + z1) / 2.0];
        quat = from_z(along);
    }
    check_size(geom, size)?;
    if *shape == GeomType::Plane && m.body_weldid[body] != 0 {
        return Err(place.attribute(
            "type",
            "a plane belongs to the world or to a body fixed to it",
        ));
    }
    let volume = inertia::volume(*shape, size);
    let mass = geom.mass.unwrap_or(geom.density * volume);
    // a shape without volume has no inertia, even with a mass
    let dense = if volume > MINVAL || geom.mass.is_none() {
        mass
    } else {
        0.0
    };
    let material = match &geom.material {
        None => -1,
        Some(name) => match spec
            .materials
            .iter()
            .position(|material| material.name == *name)
        {
            Some(id) => id as i32,
            None => {
                return Err(place.attribute("material", format!("there is no material {name:?}")));
            }
        },
    };
    m.names.geom.push(geom.name.clone());
    m.geom_type.push(*shape);
    m.geom_bodyid.push(body);
    m.geom_contype.push(geom.contype);
    m.geom_conaffinity.push(geom.conaffinity);
    m.geom_condim.push(geom.condim);
    m.geom_priority.push(geom.priority);
    m.geom_size.push(size);
    m.geom_rbound.push(match shape {
        GeomType::Plane => 0.0,
        GeomType::Sphere => size[0],
        GeomType::Capsule => size[0] + size[1],
        GeomType::Cylinder => (size[0] * size[0] + size[1] * size[1]).sqrt(),
    });
    m.geom_pos.push(pos);
    m.geom_quat.push(quat);
    m.geom_friction.push(geom.friction);
    m.geom_solmix.push(geom.solmix);
    m.geom_solref.push(geom.solref);
    m.geom_solimp.push(geom.solimp);
    m.geom_margin.push(geom.margin);
    m.geom_gap.push(geom.gap);
    m.geom_rgba.push(single(geom.rgba));
    m.geom_matid.push(material);
    Ok(Inertia {
        mass,
        pos,
        quat,
        moments: inertia::moments(*shape, dense, size),
    })
}

fn check_size(geom: &Geom, size: [f64; 3]) -> Result<()> {
    let (needed, what) = match geom.shape {
        GeomType::Plane => {
            return if size[2] <= 0.0 || size[0] < 0.0 || size[1] < 0.0 {
                Err(geom.place.attribute(
                    "size",
                    "a plane has two half sizes, which may be 0, and a positive spacing",
                ))
            } else {
                Ok(())
            };
        }
        GeomType::Sphere => (1, "a radius"),
        GeomType::Capsule => (2, "a radius and a half length (or fromto)"),
        GeomType::Cylinder => (2, "a radius and a half length (or fromto)"),
    };
    if size[..needed].iter().any(|x| *x <= 0.0) {
        return Err(geom.place.attribute(
            "size",
            format!("this shape has {what}, which must be positive"),
        ));
    }
    Ok(())
}

/// Colours have single precision in MuJoCo.
fn single(rgba: [f64; 4]) -> [f64; 4] {
    rgba.map(|x| f64::from(x as f32))
}

/// The mass of a body: that of its element `inertial`, or that of its geoms.
///
/// Where there is neither, MuJoCo takes the body's frame in its parent for the inertial frame, and
/// so does this.
fn inertia_of(body: &Body, spec: &Spec, parts: &[Inertia]) -> Result<Inertia> {
    let degree = spec.compiler.degree;
    let heavy: Vec<Inertia> = parts
        .iter()
        .copied()
        .filter(|part| part.mass > EPS)
        .collect();
    let from_geoms = spec.compiler.inertia_from_geom;
    let from_geoms = from_geoms.unwrap_or(body.inertial.is_none());
    let combined = if from_geoms {
        inertia::combine(&heavy, spec.revision)
    } else {
        None
    };
    let (inertia, place) = match (combined, &body.inertial) {
        (Some(combined), _) => (combined, &body.place),
        (None, Some(inertial)) => (explicit(inertial, spec), &inertial.place),
        (None, None) => {
            let (pos, quat) = (body.pos, body.orientation.resolve(degree));
            (
                Inertia {
                    mass: 0.0,
                    pos,
                    quat,
                    moments: [0.0; 3],
                },
                &body.place,
            )
        }
    };
    let [a, b, c] = inertia.moments;
    if inertia.moments.iter().any(|x| *x < 0.0) {
        return Err(place.error(format!(
            "the moments of inertia {a}, {b}, {c} must not be negative"
        )));
    }
    if a + b < c || a + c < b || b + c < a {
        return Err(place.error(format!(
            "the moments of inertia {a}, {b}, {c} are impossible: two must sum to at least the third"
        )));
    }
    Ok(inertia)
}

fn explicit(inertial: &Inertial, spec: &Spec) -> Inertia {
    let (moments, quat) = match inertial.moments {
        Moments::Principal(moments) => {
            let quat = inertial.orientation.resolve(spec.compiler.degree);
            (moments, quat)
        }
        Moments::Full(full) => inertia::principal_axes(full, spec.revision),
    };
    Inertia {
        mass: inertial.mass,
        pos: inertial.pos,
        quat,
        moments,
    }
}

fn scale_mass(m: &mut CompiledModel, total: Option<f64>) {
    let Some(total) = total else { return };
    let scale = (total / m.body_mass[1..].iter().sum::<f64>().max(MINVAL)).max(MINVAL);
    m.body_mass[1..].iter_mut().for_each(|mass| *mass *= scale);
    m.body_inertia[1..]
        .iter_mut()
        .flatten()
        .for_each(|moment| *moment *= scale);
}

/// Refuses bodies that can move and have no mass: nothing would resist a force on them.
fn check_mass(m: &CompiledModel, spec: &Spec) -> Result<()> {
    let mut heavy: Vec<bool> = (0..m.nbody())
        .map(|b| {
            m.body_mass[b] >= MINVAL && m.body_inertia[b].iter().all(|moment| *moment >= MINVAL)
        })
        .collect();
    for b in (1..m.nbody()).rev() {
        if m.body_jntnum[b] > 0 {
            if !heavy[b] {
                return Err(spec.bodies[b].place.error(
                    "it has joints and therefore needs mass and inertia: give it a geom, or an <inertial>",
                ));
            }
        } else {
            heavy[m.body_parentid[b]] |= heavy[b];
        }
    }
    Ok(())
}

fn add_subtree_masses(m: &mut CompiledModel) {
    m.body_subtreemass.clone_from(&m.body_mass);
    for b in (1..m.nbody()).rev() {
        m.body_subtreemass[m.body_parentid[b]] += m.body_subtreemass[b];
    }
}

/// Marks bodies whose part of the inertia matrix is diagonal: without children, directly in the
/// world or in a fixed child of it, with the inertial frame in the body's, moved along coordinate
/// axes and then turned about at most one.
fn mark_simple(m: &mut CompiledModel) {
    for b in 0..m.nbody() {
        let own_frame = norm(&m.body_ipos[b]) < EPS && norm(&m.body_iquat[b][1..]) < EPS;
        let parent = m.body_parentid[b];
        let rooted = parent == 0 || (m.body_parentid[parent] == 0 && m.body_jntnum[parent] == 0);
        m.body_simple.push(u8::from(own_frame && rooted));
        m.body_simple[parent] &= u8::from(parent == 0);
        let (mut turns, mut slides) = (false, 0);
        let first = usize::try_from(m.body_jntadr[b]).unwrap_or(0);
        for j in first..first + m.body_jntnum[b] {
            let aligned = m.jnt_axis[j].iter().filter(|x| x.abs() > EPS).count() == 1;
            if turns || norm(&m.jnt_pos[j]) >= EPS || !aligned {
                m.body_simple[b] = 0;
            }
            turns |= m.jnt_type[j] == JointType::Hinge;
            slides += usize::from(m.jnt_type[j] == JointType::Slide);
        }
        if m.body_simple[b] == 1 && slides > 0 && slides == m.body_jntnum[b] {
            m.body_simple[b] = 2;
        }
    }
    m.dof_simplenum = vec![0; m.nv()];
    let mut count = 0;
    for i in (0..m.nv()).rev() {
        count = if m.body_simple[m.dof_bodyid[i]] > 0 {
            count + 1
        } else {
            0
        };
        m.dof_simplenum[i] = count;
    }
}

fn add_looks(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for (id, body) in spec.bodies.iter().enumerate() {
        for camera in &body.cameras {
            let target = match &camera.target {
                Some(name) => Some(m.body_id(name).ok_or_else(|| {
                    camera
                        .place
                        .attribute("target", format!("there is no body {name:?}"))
                })?),
                None if camera.mode >= 3 => {
                    return Err(camera
                        .place
                        .attribute("target", "missing: this mode needs it"));
                }
                None => None,
            };
            m.names.camera.push(camera.name.clone());
            m.cam_mode.push(camera.mode);
            m.cam_bodyid.push(id);
            m.cam_targetbodyid.push(target.map_or(-1, |id| id as i32));
            m.cam_pos.push(camera.pos);
            m.cam_quat
                .push(camera.orientation.resolve(spec.compiler.degree));
            m.cam_fovy.push(camera.fovy);
        }
    }
    for light in spec.bodies.iter().flat_map(|body| &body.lights) {
        m.light_type.push(u8::from(light.directional));
        m.light_pos.push(light.pos);
        m.light_dir.push(light.dir);
    }
    m.mat_rgba = spec
        .materials
        .iter()
        .map(|material| single(material.rgba))
        .collect();
    Ok(())
}

fn add_excludes(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for exclude in &spec.excludes {
        let id = |name: &str, attribute: &str| {
            m.body_id(name).ok_or_else(|| {
                exclude
                    .place
                    .attribute(attribute, format!("there is no body {name:?}"))
            })
        };
        let bodies = [
            id(&exclude.bodies[0], "body1")?,
            id(&exclude.bodies[1], "body2")?,
        ];
        let (first, second) = (bodies[0].min(bodies[1]), bodies[0].max(bodies[1]));
        m.exclude_signature
            .push(((first as u32) << 16) + second as u32);
    }
    m.exclude_signature.sort_unstable();
    Ok(())
}

/// The slide or hinge of that name.
fn scalar_joint(m: &CompiledModel, place: &Place, name: &str) -> Result<usize> {
    let found = m
        .names
        .joint
        .iter()
        .position(|joint| joint.as_deref() == Some(name));
    match found {
        Some(id) if m.jnt_type[id] == JointType::Free => Err(place.attribute(
            "joint",
            format!("{name:?} is free: only a slide or hinge is supported here"),
        )),
        Some(id) => Ok(id),
        None => Err(place.attribute("joint", format!("there is no joint {name:?}"))),
    }
}

fn add_tendons(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for tendon in &spec.tendons {
        m.names.tendon.push(tendon.name.clone());
        m.tendon_adr.push(m.wrap_objid.len());
        m.tendon_num.push(tendon.terms.len());
        for term in &tendon.terms {
            let joint = scalar_joint(m, &term.place, &term.joint)?;
            m.wrap_objid.push(joint);
            m.wrap_prm.push(term.coefficient);
        }
    }
    Ok(())
}

fn add_motors(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for motor in &spec.motors {
        let place = &motor.place;
        let name = motor
            .joint
            .as_ref()
            .ok_or_else(|| place.attribute("joint", "missing: it must be given"))?;
        let joint = scalar_joint(m, place, name)?;
        let limited = limited(
            motor.ctrl_limited,
            motor.ctrl_range,
            spec.compiler.autolimits,
        )
        .ok_or_else(|| {
            place.attribute(
                "ctrlrange",
                "needs ctrllimited=\"true\" here, where autolimits is false",
            )
        })?;
        if limited && motor.ctrl_range[0] >= motor.ctrl_range[1] {
            return Err(place.attribute(
                "ctrlrange",
                "the lower limit must be less than the upper one",
            ));
        }
        m.names.actuator.push(motor.name.clone());
        m.actuator_trnid.push([joint as i32, -1]);
        m.actuator_gear.push(motor.gear);
        m.actuator_ctrllimited.push(limited);
        m.actuator_ctrlrange.push(motor.ctrl_range);
    }
    Ok(())
}

fn add_keys(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for key in &spec.keys {
        let fitting = |name: &str, given: &Option<Vec<f64>>, default: &[f64]| match given {
            Some(numbers) if numbers.len() != default.len() => {
                let (have, need) = (numbers.len(), default.len());
                Err(key
                    .place
                    .attribute(name, format!("{have} numbers, and the model needs {need}")))
            }
            Some(numbers) => Ok(numbers.clone()),
            None => Ok(default.to_vec()),
        };
        let mut qpos = fitting("qpos", &key.qpos, &m.qpos0)?;
        normalize_quaternions(m, &mut qpos);
        let qvel = fitting("qvel", &key.qvel, &vec![0.0; m.nv()])?;
        let ctrl = fitting("ctrl", &key.ctrl, &vec![0.0; m.nu()])?;
        m.key_time.push(key.time);
        m.key_qpos.push(qpos);
        m.key_qvel.push(qvel);
        m.key_ctrl.push(ctrl);
    }
    for _ in m.key_time.len()..spec.nkey {
        m.key_time.push(0.0);
        m.key_qpos.push(m.qpos0.clone());
        m.key_qvel.push(vec![0.0; m.nv()]);
        m.key_ctrl.push(vec![0.0; m.nu()]);
    }
    Ok(())
}

fn normalize_quaternions(m: &CompiledModel, qpos: &mut [f64]) {
    for j in (0..m.njnt()).filter(|j| m.jnt_type[*j] == JointType::Free) {
        let start = m.jnt_qposadr[j] + 3;
        let quat = std::array::from_fn(|k| qpos[start + k]);
        qpos[start..start + 4].copy_from_slice(&InTurn::normalize_quat((), unit(quat).0));
    }
}

/// Refuses more of a kind than can be looked up in a moment.
fn check_counts(spec: &Spec) -> Result<()> {
    let sections = [
        ("materials", spec.materials.len()),
        ("excludes", spec.excludes.len()),
        ("tendons", spec.tendons.len()),
        ("motors", spec.motors.len()),
        ("keys", spec.keys.len()),
        (
            "terms of tendons",
            spec.tendons.iter().map(|tendon| tendon.terms.len()).sum(),
        ),
    ];
    match sections.iter().find(|(_, count)| *count > MOST) {
        Some((kind, count)) => {
            let reason = format!("{count} {kind}: more than {MOST} are not supported");
            Err(spec.bodies[0].place.error(reason))
        }
        None => Ok(()),
    }
}

/// Refuses two objects of a kind under one name.
fn check_names(spec: &Spec) -> Result<()> {
    let mut seen = HashSet::new();
    let mut check = |kind: &'static str, name: &Option<String>, place: &Place| match name {
        Some(name) if !seen.insert((kind, name.clone())) => {
            Err(place.attribute("name", format!("there is a {kind} {name:?} already")))
        }
        _ => Ok(()),
    };
    for body in &spec.bodies {
        check("body", &body.name, &body.place)?;
        body.joints
            .iter()
            .try_for_each(|joint| check("joint", &joint.name, &joint.place))?;
        body.geoms
            .iter()
            .try_for_each(|geom| check("geom", &geom.name, &geom.place))?;
        body.sites
            .iter()
            .try_for_each(|site| check("site", &site.name, &site.place))?;
        body.cameras
            .iter()
            .try_for_each(|camera| check("camera", &camera.name, &camera.place))?;
    }
    spec.motors
        .iter()
        .try_for_each(|motor| check("actuator", &motor.name, &motor.place))?;
    spec.tendons
        .iter()
        .try_for_each(|tendon| check("tendon", &tendon.name, &tendon.place))
}
