//! The model compiler: turns a [`Spec`] into a checked [`Model`].
//!
//! | file | part |
//! |---|---|
//! | `source` | models from texts and files |
//! | `body`, `joint`, `geom`, ... | a section of MJCF each: ids, frames |
//! | `fuse` | bodies without joints as parts of their parents |
//! | `inertia`, `fluid` | masses, principal axes, coefficients of shapes |
//! | `hfields` | height fields of a model, from its text or files |
//! | `mesh`, `hull`, `assets`, `textures` | meshes of files; their convex hulls; the meshes and textures of a model |
//! | `lengthrange` | the ranges of the lengths of muscles |
//! | `constants` | fields that follow from others, by stages of the engine |
//! | `complete`, `check`, `features`, `meshes`, `values` | fields left out; refusal of models that the engine cannot run |
//! | `figures` | the model as a table |

mod actuator;
mod assets;
mod body;
mod check;
mod complete;
mod constants;
mod contact;
mod equality;
mod features;
mod figures;
mod fluid;
mod fuse;
mod geom;
mod hfields;
pub mod hull;
mod inertia;
mod joint;
mod keyframe;
mod lengthrange;
pub mod mesh;
mod meshes;
mod sensor;
mod sleep;
mod source;
mod tendon;
mod textures;
mod values;

use std::collections::HashSet;

use self::constants::{mark_simple, with_constants};
use self::fuse::Kept;
use self::inertia::MINVAL;
use crate::math::libm;
use crate::mjcf::orientation::{IDENTITY, turned, within};
use crate::mjcf::spec::{Body, Compiler, Frame, Spec, Statistic};
use crate::mjcf::store::Assets;
use crate::mjcf::xml::Place;
use crate::model::{CompiledModel, ObjectType, Options};
use crate::{Model, Result};

/// Computes all fields except those that need the inertia matrix of the initial configuration.
pub(super) fn compile(spec: &Spec, mut assets: Assets<'_>) -> Result<Box<CompiledModel>> {
    let mut m = Box::new(CompiledModel {
        model: spec.name.clone(),
        revision: spec.revision,
        opt: spec.option.clone(),
        ..CompiledModel::default()
    });
    let meshes = assets::compile_meshes(spec, &mut assets)?;
    hfields::add_hfields(&mut m, spec, &mut assets)?;
    let kept = fuse::kept(spec);
    let mut looks = Vec::new();
    for (id, kept) in kept.iter().enumerate() {
        let aligned = body::add_body(&mut m, spec, &meshes, id, kept)?;
        looks.push((id, kept.body, aligned));
        let fused = kept.fused.iter();
        let moved = |pose| spec.revision.fuses_first().then_some(pose);
        looks.extend(fused.map(|&(body, pose)| (id, body, moved(pose))));
    }
    assets::add_meshes(&mut m, spec, meshes);
    scale_mass(&mut m, spec.compiler.total_mass);
    check_mass(&m, &kept)?;
    add_looks(&mut m, &looks)?;
    add_materials(&mut m, spec, &mut assets)?;
    contact::add_excludes(&mut m, spec)?;
    contact::add_pairs(&mut m, spec)?;
    tendon::add_tendons(&mut m, spec)?;
    mark_simple(&mut m);
    equality::add_equalities(&mut m, spec)?;
    actuator::add_actuators(&mut m, spec)?;
    sensor::add_sensors(&mut m, spec)?;
    sleep::add_policies(&mut m, spec, &kept)?;
    keyframe::add_keys(&mut m, spec)?;
    check_names(spec)?;
    Ok(m)
}

/// Completes the model: computes the remaining fields, and replaces computed statistics by the
/// values that the text gives.
pub(super) fn finish(m: Box<CompiledModel>, spec: &Spec) -> Result<Model> {
    let mut m = with_constants(m)?;
    state_statistics(&mut m, &spec.statistic);
    add_spring_dampers(&mut m, spec);
    lengthrange::add_length_ranges(&mut m, spec)?;
    if !m.tree_sleep_policy.is_empty() {
        m.opt.enableflags |= Options::SLEEP;
    }
    sleep::check_start(&m, spec)?;
    Model::new(*m)
}

/// Stiffness and damping of joints whose time constant and damping ratio are given: MuJoCo's
/// `AutoSpringDamper`.
fn add_spring_dampers(m: &mut CompiledModel, spec: &Spec) {
    let joints = spec.bodies.iter().flat_map(|body| &body.joints);
    for (j, joint) in joints.enumerate() {
        let [time, ratio] = joint.spring_damper;
        if time <= 0.0 || ratio <= 0.0 {
            continue;
        }
        let dofs = m.jnt_dofadr[j]..m.jnt_dofadr[j] + m.jnt_type[j].nv();
        let weights: f64 = m.dof_invweight0[dofs.clone()].iter().sum();
        let inertia = dofs.len() as f64 / weights.max(MINVAL);
        m.jnt_stiffness[j] = inertia / (time * time * ratio * ratio).max(MINVAL);
        m.dof_damping[dofs].fill(2.0 * inertia / time.max(MINVAL));
    }
}

/// Replaces computed statistics by the values that the text gives.
fn state_statistics(m: &mut CompiledModel, stated: &Statistic) {
    let stat = &mut m.stat;
    for (value, stated) in [
        (&mut stat.meaninertia, stated.meaninertia),
        (&mut stat.meanmass, stated.meanmass),
        (&mut stat.meansize, stated.meansize),
        (&mut stat.extent, stated.extent),
    ] {
        *value = stated.unwrap_or(*value);
    }
    stat.center = stated.center.unwrap_or(stat.center);
}

fn scale_mass(m: &mut CompiledModel, total: Option<f64>) {
    let Some(total) = total else { return };
    let scale = (total / m.body_mass[1..].iter().sum::<f64>().max(MINVAL)).max(MINVAL);
    m.body_mass[1..].iter_mut().for_each(|mass| *mass *= scale);
    let moments = m.body_inertia[1..].iter_mut().flatten();
    moments.for_each(|moment| *moment *= scale);
}

/// Refuses movable bodies without mass, with their place in the text.
fn check_mass(m: &CompiledModel, bodies: &[Kept<'_>]) -> Result<()> {
    let reason =
        "it has joints and therefore needs mass and inertia: give it a geom, or an <inertial>";
    match values::weightless(m) {
        Some(id) => Err(bodies[id].body.place.error(reason)),
        None => Ok(()),
    }
}

/// Adds cameras and lights. `bodies` are the compiled id of each body, the body, and its
/// frame in the compiled one.
fn add_looks(m: &mut CompiledModel, bodies: &[(usize, &Body, Option<Frame>)]) -> Result<()> {
    for &(id, body, outer) in bodies {
        for camera in &body.cameras {
            let target = match &camera.target {
                Some(name) => Some(m.body_id(name).ok_or_else(|| {
                    camera
                        .place
                        .attribute("target", format!("there is no body {name:?}"))
                })?),
                None => None,
            };
            m.names.camera.push(camera.name.clone());
            m.cam_mode.push(camera.mode);
            m.cam_bodyid.push(id);
            m.cam_targetbodyid.push(target.map_or(-1, |id| id as i32));
            let own = (camera.pos, camera.orientation.resolve(&camera.compiler));
            let (pos, quat) = within(outer, within(camera.frame, own));
            m.cam_pos.push(pos);
            m.cam_quat.push(quat);
            let intrinsic = camera.intrinsic()?;
            m.cam_projection.push(u8::from(camera.orthographic));
            m.cam_resolution.push(camera.resolution);
            m.cam_sensorsize.push(camera.sensor_size.map(f64::from));
            m.cam_intrinsic.push(intrinsic.map(f64::from));
            m.cam_fovy.push(if camera.has_sensor() {
                let half = f64::from(camera.sensor_size[1] / 2.0);
                let angle = libm::atan2(half, f64::from(intrinsic[1]));
                f64::from(angle as f32) * 360.0 / std::f64::consts::PI
            } else {
                camera.fovy
            });
        }
    }
    let lights = bodies.iter().flat_map(|(_, body, outer)| {
        let lights = body.lights.iter();
        lights.map(move |light| (light, *outer))
    });
    for (light, outer) in lights {
        if let Some(name) = &light.target
            && m.body_id(name).is_none()
        {
            let reason = format!("there is no body {name:?}");
            return Err(light.place.attribute("target", reason));
        }
        m.light_type.push(light.kind);
        let place = within(light.frame, (light.pos, IDENTITY));
        m.light_pos.push(within(outer, place).0);
        m.light_dir
            .push(turned(outer, turned(light.frame, light.dir)));
    }
    Ok(())
}

fn add_materials(m: &mut CompiledModel, spec: &Spec, assets: &mut Assets<'_>) -> Result<()> {
    let colors = spec.materials.iter().map(|material| material.rgba);
    if spec.compiler.discard_visual {
        return Ok(());
    }
    m.mat_rgba = colors.map(geom::single).collect();
    textures::add_textures(m, spec, assets)
}

/// Refuses two objects of a kind under one name.
fn check_names(spec: &Spec) -> Result<()> {
    let mut seen = HashSet::new();
    let of_bodies = spec.bodies.iter().flat_map(|body| {
        let joints = body.joints.iter().map(|x| ("joint", &x.name, &x.place));
        let geoms = body.geoms.iter().map(|x| ("geom", &x.name, &x.place));
        let sites = body.sites.iter().map(|x| ("site", &x.name, &x.place));
        let cameras = body.cameras.iter().map(|x| ("camera", &x.name, &x.place));
        let own = std::iter::once(("body", &body.name, &body.place));
        own.chain(joints).chain(geoms).chain(sites).chain(cameras)
    });
    let actuators = spec
        .actuators
        .iter()
        .map(|x| ("actuator", &x.name, &x.place));
    let tendons = spec.tendons.iter().map(|x| ("tendon", &x.name, &x.place));
    let sensors = spec.sensors.iter().map(|x| ("sensor", &x.name, &x.place));
    let equalities = spec
        .equalities
        .iter()
        .map(|x| ("equality", &x.name, &x.place));
    let keys = spec.keys.iter().chain(&spec.attached_keys);
    let keys = keys.map(|x| ("key", &x.name, &x.place));
    let others = actuators.chain(tendons).chain(sensors);
    let others = others.chain(equalities).chain(keys);
    for (kind, name, place) in of_bodies.chain(others) {
        if name.is_some() && !seen.insert((kind, name)) {
            let name = name.as_deref().unwrap_or_default();
            let article = if kind.starts_with(['a', 'e']) {
                "an"
            } else {
                "a"
            };
            let reason = format!("there is {article} {kind} {name:?} already");
            return Err(place.attribute("name", reason));
        }
    }
    Ok(())
}

/// Returns whether a joint, tendon or actuator limit is active. `stated` is the XML attribute. If
/// the attribute is missing, a limit is active if its range is in the XML.
fn limited(
    stated: Option<bool>,
    range: [f64; 2],
    compiler: &Compiler,
    place: &Place,
    [range_name, flag]: [&str; 2],
) -> Result<bool> {
    let limited = match stated {
        Some(limited) => limited,
        None if range == [0.0; 2] => false,
        None if compiler.autolimits => true,
        None => {
            let reason = format!("needs {flag}=\"true\" here, where autolimits is false");
            return Err(place.attribute(range_name, reason));
        }
    };
    if limited && range[0] >= range[1] {
        let reason = "the lower limit must be less than the upper one";
        return Err(place.attribute(range_name, reason));
    }
    Ok(limited)
}

/// The object with the name, or an error.
fn named(
    m: &CompiledModel,
    place: &Place,
    attribute: &str,
    kind: ObjectType,
    name: &str,
) -> Result<usize> {
    let word = match kind {
        ObjectType::Joint => "joint",
        ObjectType::Geom => "geom",
        ObjectType::Site => "site",
        ObjectType::Camera => "camera",
        ObjectType::Tendon => "tendon",
        ObjectType::Actuator => "actuator",
        _ => "body",
    };
    let missing = || place.attribute(attribute, format!("there is no {word} {name:?}"));
    m.id(kind, name).ok_or_else(missing)
}

/// The slide or hinge of that name.
fn scalar_joint(m: &CompiledModel, place: &Place, attribute: &str, name: &str) -> Result<usize> {
    let id = named(m, place, attribute, ObjectType::Joint, name)?;
    if m.jnt_type[id].is_scalar() {
        return Ok(id);
    }
    let reason = format!("{name:?} is free or a ball: only a slide or hinge is supported here");
    Err(place.attribute(attribute, reason))
}
