//! Bodies with their joints, geoms and sites: ids, frames, masses.

use super::MOST;
use crate::Result;
use crate::mjcf::fluid;
use crate::mjcf::inertia::{self, Inertia};
use crate::mjcf::orientation::{from_z, unit, within};
use crate::mjcf::spec::{Body, Frame, Geom, Inertial, Joint, Moments, Spec};
use crate::mjcf::xml::Place;
use crate::model::{CompiledModel, Fluid, GeomType, JointType, bounding_radius};
use crate::physics::spatial::EPS;
use crate::physics::spatial::rotate_quat;

const IDENTITY: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

pub(super) fn add_body(m: &mut CompiledModel, spec: &Spec, id: usize, body: &Body) -> Result<()> {
    let parent = body.parent;
    m.names.body.push(body.name.clone());
    m.body_parentid.push(parent);
    m.body_rootid.push(if id == 0 || parent == 0 {
        id
    } else {
        m.body_rootid[parent]
    });
    m.body_weldid
        .push(if id == 0 || body.mocap || !body.joints.is_empty() {
            id
        } else {
            m.body_weldid[parent]
        });
    let own = (body.pos, body.orientation.resolve(&spec.compiler));
    let (pos, quat) = within(body.frame, own);
    m.body_pos.push(pos);
    m.body_quat.push(quat);
    m.body_gravcomp.push(body.gravcomp);
    m.body_mocapid.push(if body.mocap {
        if parent != 0 || !body.joints.is_empty() {
            let reason = "a mocap body belongs to the world and has no joints";
            return Err(body.place.attribute("mocap", reason));
        }
        m.nmocap() as i32
    } else {
        -1
    });

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
    let [first, last] = spec.compiler.inertia_groups;
    // the world has no mass
    let weighs = id > 0 && from_geoms(body, spec);
    for geom in &body.geoms {
        let weighs = weighs && (first..=last).contains(&geom.group);
        check_mesh(geom, spec, weighs)?;
        let part = add_geom(m, spec, id, geom)?;
        if weighs {
            parts.push(part);
        }
    }
    let inertia = inertia_of(body, id, spec, &parts)?;
    m.body_mass.push(inertia.mass);
    m.body_ipos.push(inertia.pos);
    m.body_iquat.push(inertia.quat);
    m.body_inertia.push(inertia.moments);

    for site in &body.sites {
        m.names.site.push(site.name.clone());
        m.site_bodyid.push(id);
        m.site_type.push(site.shape);
        let mut size = site.size;
        let own = match site.fromto {
            Some(ends) => between(&site.place, ends, &mut size, false)?,
            None => (site.pos, site.orientation.resolve(&spec.compiler)),
        };
        if site.fromto.is_some() && ![3, 4, 5, 6].contains(&site.shape) {
            let reason = "only capsules, cylinders, ellipsoids and boxes have ends";
            return Err(site.place.attribute("fromto", reason));
        }
        if [4, 6].contains(&site.shape) && site.fromto.is_some() {
            size = [size[0], size[0], size[1]];
        }
        let (pos, quat) = within(site.frame, own);
        m.site_size.push(size);
        m.site_pos.push(pos);
        m.site_quat.push(quat);
        m.site_rgba.push(single(site.rgba));
    }
    if m.nbody() > MOST || m.ngeom() > MOST || m.nv() > MOST {
        let reason =
            format!("more than {MOST} bodies, geoms or degrees of freedom are not supported");
        return Err(body.place.error(reason));
    }
    Ok(())
}

/// The id of the first of `count` elements, if the next free id is `next`; -1 if `count` is 0.
fn address(next: usize, count: usize) -> i32 {
    if count == 0 { -1 } else { next as i32 }
}

/// The last degree of freedom of a body, or of its nearest ancestor that has one; -1 if there is
/// none.
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
    let (free, ball) = (*kind == JointType::Free, *kind == JointType::Ball);
    let names = ["range", "limited"];
    let range = if ball {
        // a ball joint limits the angle from its initial orientation
        [-1.0, joint.range[1]]
    } else {
        joint.range
    };
    let unlimited = free || (ball && joint.range == [0.0; 2] && joint.limited.is_none());
    let limited = !unlimited && super::limited(joint.limited, range, spec, place, names)?;
    if ball && limited && joint.range[0] != 0.0 {
        return Err(place.attribute("range", "of a ball joint begins with 0"));
    }
    let names = ["actuatorfrcrange", "actuatorfrclimited"];
    let force_limited = !free
        && !ball
        && super::limited(joint.force_limited, joint.force_range, spec, place, names)?;
    if free && body.parent != 0 {
        return Err(place.attribute(
            "type",
            "a free joint belongs to a body directly in the world",
        ));
    }
    if free && body.joints.len() > 1 {
        return Err(place.attribute("type", "a free joint must be the only joint of its body"));
    }
    let earlier = &body.joints[..m.njnt() - m.body_jntadr[body_id].max(0) as usize];
    let turned_by_ball = earlier.iter().any(|joint| joint.kind == JointType::Ball);
    if turned_by_ball && matches!(kind, JointType::Ball | JointType::Hinge) {
        return Err(place.attribute("type", "nothing that turns follows a ball joint"));
    }
    let to_radians = spec.compiler.degree && matches!(kind, JointType::Hinge | JointType::Ball);
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
    m.jnt_pos.push(if free {
        [0.0; 3]
    } else {
        within(joint.frame, (joint.pos, IDENTITY)).0
    });
    m.jnt_axis.push(if free || ball {
        [0.0, 0.0, 1.0]
    } else {
        unit(turned(joint.frame, joint.axis)).0
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
    m.jnt_actfrclimited.push(force_limited);
    m.jnt_actfrcrange.push(joint.force_range);
    m.jnt_actgravcomp.push(joint.actuator_gravcomp);
    if free {
        let (pos, quat) = (m.body_pos[body_id], m.body_quat[body_id]);
        m.qpos0.extend(pos.iter().chain(&quat));
        m.qpos_spring.extend(pos.iter().chain(&quat));
    } else if ball {
        m.qpos0.extend(IDENTITY);
        m.qpos_spring.extend(IDENTITY);
    } else {
        m.qpos0.push(angle(joint.reference));
        m.qpos_spring.push(angle(joint.spring_reference));
    }
    for _ in 0..kind.nv() {
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
        m.dof_frictionloss.push(joint.friction_loss);
        m.dof_solref.push(joint.solref_friction);
        m.dof_solimp.push(joint.solimp_friction);
    }
    Ok(())
}

/// The frame and the size of a geom or site that has `fromto`: the centre of the segment, the z
/// axis along it, and half its length as the second size. `fromto` and a position exclude each
/// other.
fn between(
    place: &Place,
    [x0, y0, z0, x1, y1, z1]: [f64; 6],
    size: &mut [f64; 3],
    positioned: bool,
) -> Result<Frame> {
    if positioned {
        return Err(place.attribute("fromto", "does not go with pos, which it implies"));
    }
    let (along, length) = unit([x0 - x1, y0 - y1, z0 - z1]);
    size[1] = length / 2.0;
    if size[1] < EPS {
        return Err(place.attribute("fromto", "the ends are too close"));
    }
    let pos = [(x0 + x1) / 2.0, (y0 + y1) / 2.0, (z0 + z1) / 2.0];
    Ok((pos, from_z(along)))
}

/// Turns a direction from `frame` to its body's frame.
pub(super) fn turned(frame: Option<Frame>, direction: [f64; 3]) -> [f64; 3] {
    match frame {
        Some((_, quat)) if quat != IDENTITY => rotate_quat(direction, quat),
        _ => direction,
    }
}

/// Adds a geom; returns its mass, and its centre and axes in the body's frame.
fn add_geom(m: &mut CompiledModel, spec: &Spec, body: usize, geom: &Geom) -> Result<Inertia> {
    let Geom { place, shape, .. } = geom;
    let mut size = geom.size;
    let own = match geom.fromto {
        None => (
            geom.pos.unwrap_or_default(),
            geom.orientation.resolve(&spec.compiler),
        ),
        Some(ends) => {
            if matches!(shape, GeomType::Plane | GeomType::Sphere | GeomType::Mesh) {
                return Err(place.attribute(
                    "fromto",
                    "only capsules, cylinders, ellipsoids and boxes have ends: give type=\"capsule\"",
                ));
            }
            between(
                place,
                ends,
                &mut size,
                geom.pos.is_some_and(|pos| pos != [0.0; 3]),
            )?
        }
    };
    if geom.fromto.is_some() && matches!(shape, GeomType::Ellipsoid | GeomType::Box) {
        size = [size[0], size[0], size[1]];
    }
    let (pos, quat) = within(geom.frame, own);
    check_size(geom, size)?;
    if *shape == GeomType::Plane && m.body_weldid[body] != 0 {
        return Err(place.attribute(
            "type",
            "a plane belongs to the world or to a body fixed to it",
        ));
    }
    let volume = inertia::volume(*shape, size, geom.shell);
    let mass = match geom.mass {
        // MuJoCo ignores the `mass` of a shape without volume
        Some(mass) if mass == 0.0 || volume > EPS => mass,
        Some(_) => 0.0,
        None => geom.density * volume,
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
    m.geom_rbound.push(bounding_radius(*shape, size));
    m.geom_fluid.push(if geom.fluid_ellipsoid {
        Fluid(fluid::coefficients(*shape, size, geom.fluid))
    } else {
        Fluid::default()
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
        moments: inertia::moments(*shape, mass, size, geom.shell),
    })
}

/// Returns an error for a mesh that affects more than rendering, because the engine does not read
/// its surface. `weighs`: whether the mass of the geom counts.
fn check_mesh(geom: &Geom, spec: &Spec, weighs: bool) -> Result<()> {
    let error = |name, reason: &str| Err(geom.place.attribute(name, reason));
    let Some(mesh) = &geom.mesh else {
        return match geom.shape {
            GeomType::Mesh => error("mesh", "missing: it must be given for type=\"mesh\""),
            _ => Ok(()),
        };
    };
    if !spec.meshes.contains(mesh) {
        return error("mesh", &format!("there is no mesh {mesh:?}"));
    }
    if geom.shape != GeomType::Mesh {
        return error(
            "mesh",
            "a shape fitted to a mesh is not supported: give the shape's size",
        );
    }
    if geom.contype != 0 || geom.conaffinity != 0 {
        return error(
            "type",
            "a mesh that collides is not supported: set contype and conaffinity to 0 to only show \
             it, and give other geoms for contacts",
        );
    }
    if weighs && geom.mass != Some(0.0) && geom.density != 0.0 {
        return error(
            "type",
            "the mass of a mesh is not supported: give its body an element inertial, or the geom \
             mass=\"0\"",
        );
    }
    if geom.fluid_ellipsoid {
        return error("fluidshape", "the fluid forces on a mesh are not supported");
    }
    Ok(())
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
        GeomType::Ellipsoid => (3, "three half axes (or one and fromto)"),
        GeomType::Box => (3, "three half sizes (or one and fromto)"),
        GeomType::Mesh => return Ok(()),
    };
    if size[..needed].iter().any(|x| *x <= 0.0) {
        return Err(geom.place.attribute(
            "size",
            format!("this shape has {what}, which must be positive"),
        ));
    }
    Ok(())
}

/// Rounds a colour to single precision, as MuJoCo stores it.
pub(super) fn single(rgba: [f64; 4]) -> [f64; 4] {
    rgba.map(|x| f64::from(x as f32))
}

/// Whether the geoms of a body give its inertia.
fn from_geoms(body: &Body, spec: &Spec) -> bool {
    let stated = spec.compiler.inertia_from_geom;
    stated.unwrap_or(body.inertial.is_none())
}

/// The inertia of a body: from its geoms `parts`, or from its element `inertial`.
///
/// Without both, the inertial frame is the body's frame in its parent, as in MuJoCo.
fn inertia_of(body: &Body, id: usize, spec: &Spec, parts: &[Inertia]) -> Result<Inertia> {
    let compiler = &spec.compiler;
    let heavy: Vec<Inertia> = parts
        .iter()
        .copied()
        .filter(|part| part.mass > EPS)
        .collect();
    let combined = inertia::combine(&heavy, spec.revision);
    let (mut inertia, place) = match (combined, &body.inertial) {
        (Some(combined), _) => (combined, &body.place),
        (None, Some(inertial)) => (explicit(inertial, spec), &inertial.place),
        (None, None) => {
            let (pos, quat) = (body.pos, body.orientation.resolve(compiler));
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
    if id > 0 {
        inertia.mass = inertia.mass.max(compiler.bound_mass);
        inertia.moments = inertia.moments.map(|x| x.max(compiler.bound_inertia));
    }
    let [a, b, c] = inertia.moments;
    if inertia.moments.iter().any(|x| *x < 0.0) {
        return Err(place.error(format!(
            "the moments of inertia {a}, {b}, {c} must not be negative"
        )));
    }
    if a + b < c || a + c < b || b + c < a {
        if !compiler.balance_inertia {
            return Err(place.error(format!(
                "the moments of inertia {a}, {b}, {c} are impossible: two must sum to at least the third"
            )));
        }
        inertia.moments = [(a + b + c) / 3.0; 3];
    }
    Ok(inertia)
}

fn explicit(inertial: &Inertial, spec: &Spec) -> Inertia {
    let (moments, quat) = match inertial.moments {
        Moments::Principal(moments) => (moments, inertial.orientation.resolve(&spec.compiler)),
        Moments::Full(full) => inertia::principal_axes(full, spec.revision),
    };
    Inertia {
        mass: inertial.mass,
        pos: inertial.pos,
        quat,
        moments,
    }
}
