//! Bodies: ids, frames, masses.

use super::fuse::Kept;
use super::inertia::{self, Inertia, MINVAL};
use super::mesh::Mesh;
use super::{geom, joint};
use crate::Result;
use crate::math::spatial::{EPS, InTurn, Order, rotate_back};
use crate::mjcf::MOST;
use crate::mjcf::orientation::{IDENTITY, within};
use crate::mjcf::spec::{Body, Frame, Inertial, Moments, Spec};
use crate::model::{CompiledModel, JointType};

const TOO_HEAVY: &str = "its mass, or its moments of inertia, are larger than the largest number: give it a smaller size, \
                         density or mass";

/// Adds a body and its parts; `meshes` are those of the model. Returns the text's frame of the body in
/// the compiled one, if `align` moved it.
pub(super) fn add_body(
    m: &mut CompiledModel,
    spec: &Spec,
    meshes: &[Mesh],
    id: usize,
    kept: &Kept<'_>,
) -> Result<Option<Frame>> {
    let Kept {
        body, parent, pose, ..
    } = *kept;
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
    m.body_pos.push(pose.0);
    m.body_quat.push(pose.1);
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
        joint::add_joint(m, (id, parent), body, joint)?;
    }
    m.body_dofnum.push(m.nv() - first_dof);
    m.body_dofadr.push(address(first_dof, m.nv() - first_dof));
    let last_dof = if m.nv() > first_dof {
        m.nv() as i32 - 1
    } else {
        m.last_dof(parent)
    };
    m.body_treeid
        .push(usize::try_from(last_dof).map_or(-1, |dof| m.dof_treeid[dof] as i32));

    let first_geom = m.ngeom();
    let mut parts = add_geoms(m, spec, meshes, id, body)?;
    let mut inertia = inertia_of(body, id == 0, spec, &parts)?;
    for &(fused, pose) in &kept.fused {
        let first = m.ngeom();
        let fused_parts = add_geoms(m, spec, meshes, id, fused)?;
        for g in first..m.ngeom() {
            (m.geom_pos[g], m.geom_quat[g]) = within(Some(pose), (m.geom_pos[g], m.geom_quat[g]));
        }
        let part = inertia_of(fused, false, spec, &fused_parts)?;
        if id > 0 && part.mass >= MINVAL {
            inertia = inertia::accumulate(&inertia, &part, pose, spec.revision);
        }
        parts.extend(fused_parts.into_iter().map(|part| {
            let (pos, quat) = within(Some(pose), (part.pos, part.quat));
            Inertia { pos, quat, ..part }
        }));
    }
    let all = || {
        [body]
            .into_iter()
            .chain(kept.fused.iter().map(|(body, _)| *body))
    };
    if spec.revision.fuses_first() && id > 0 && !kept.fused.is_empty() && all().all(from_geoms) {
        inertia = inertia_of(body, false, spec, &parts)?;
    }
    let count = m.ngeom() - first_geom;
    m.body_geomnum.push(count);
    m.body_geomadr.push(address(first_geom, count));
    let aligned = aligns(spec, body).then(|| align(m, id, &mut inertia, first_geom));
    m.body_mass.push(inertia.mass);
    m.body_ipos.push(inertia.pos);
    m.body_iquat.push(inertia.quat);
    m.body_inertia.push(inertia.moments);

    for site in &body.sites {
        geom::add_site(m, id, site, aligned)?;
    }
    for &(fused, pose) in &kept.fused {
        for site in &fused.sites {
            geom::add_site(m, id, site, Some(pose))?;
        }
    }
    if m.nbody() > MOST || m.ngeom() > MOST || m.nv() > MOST {
        let reason =
            format!("more than {MOST} bodies, geoms or degrees of freedom are not supported");
        return Err(body.place.error(reason));
    }
    Ok(aligned)
}

/// Adds the geoms of `body` to the compiled body `id`; returns those that have mass.
fn add_geoms(
    m: &mut CompiledModel,
    spec: &Spec,
    meshes: &[Mesh],
    id: usize,
    body: &Body,
) -> Result<Vec<Inertia>> {
    let mut parts = Vec::with_capacity(body.geoms.len());
    let [first, last] = body.compiler.inertia_groups;
    // the world has no mass
    let weighs = !std::ptr::eq(body, &raw const spec.bodies[0]) && from_geoms(body);
    for geom in &body.geoms {
        let part = geom::add_geom(m, spec, meshes, id, geom)?;
        if weighs && (first..=last).contains(&geom.group) {
            if !part.is_finite() {
                return Err(geom.place.error(TOO_HEAVY));
            }
            parts.push(part);
        }
    }
    Ok(parts)
}

/// Whether the frame of a body becomes that of its inertia: that of a body with a free joint and
/// without children, if the joint or the compiler says so.
fn aligns(spec: &Spec, body: &Body) -> bool {
    let [joint] = &body.joints[..] else {
        return false;
    };
    let asked = joint.align.unwrap_or(body.compiler.align_free);
    let is_parent = |id: usize| std::ptr::eq(body, &raw const spec.bodies[id]);
    joint.kind == JointType::Free
        && asked
        && !spec.bodies[1..].iter().any(|body| is_parent(body.parent))
}

/// Moves the frame of the body `id` to its inertia, and its geoms accordingly; returns the old frame
/// in the new one.
fn align(m: &mut CompiledModel, id: usize, inertia: &mut Inertia, first_geom: usize) -> Frame {
    let (pos, quat) = within(
        Some((m.body_pos[id], m.body_quat[id])),
        (inertia.pos, inertia.quat),
    );
    (m.body_pos[id], m.body_quat[id]) = (pos, quat);
    for qpos in [&mut m.qpos0, &mut m.qpos_spring] {
        let first = qpos.len() - 7;
        qpos[first..]
            .copy_from_slice(&[pos[0], pos[1], pos[2], quat[0], quat[1], quat[2], quat[3]]);
    }
    let [w, x, y, z] = inertia.quat;
    let back = rotate_back(&InTurn::quat_to_mat(inertia.quat), inertia.pos);
    let old = (back.map(|x| -x), [w, -x, -y, -z]);
    (inertia.pos, inertia.quat) = ([0.0; 3], IDENTITY);
    for g in first_geom..m.ngeom() {
        (m.geom_pos[g], m.geom_quat[g]) = within(Some(old), (m.geom_pos[g], m.geom_quat[g]));
    }
    old
}

/// The id of the first of `count` elements, if the next free id is `next`; -1 if `count` is 0.
pub(super) fn address(next: usize, count: usize) -> i32 {
    if count == 0 { -1 } else { next as i32 }
}

/// Whether the geoms of a body give its inertia.
fn from_geoms(body: &Body) -> bool {
    let stated = body.compiler.inertia_from_geom;
    stated.unwrap_or(body.inertial.is_none())
}

/// The inertia of a body: from its geoms `parts`, or from its element `inertial`.
///
/// Without both, the inertial frame is the body's frame in its parent, as in MuJoCo.
fn inertia_of(body: &Body, world: bool, spec: &Spec, parts: &[Inertia]) -> Result<Inertia> {
    let compiler = &body.compiler;
    let heavy = parts.iter().filter(|part| part.mass > EPS);
    let heavy: Vec<Inertia> = heavy.copied().collect();
    let combined = inertia::combine(&heavy, spec.revision);
    let (mut inertia, place) = match (combined, &body.inertial) {
        (Some(combined), _) => (combined, &body.place),
        (None, Some(inertial)) => (explicit(inertial, body, spec), &inertial.place),
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
    if !world {
        inertia.mass = inertia.mass.max(compiler.bound_mass);
        inertia.moments = inertia.moments.map(|x| x.max(compiler.bound_inertia));
    }
    if !inertia.is_finite() {
        return Err(place.error(TOO_HEAVY));
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

fn explicit(inertial: &Inertial, body: &Body, spec: &Spec) -> Inertia {
    let (moments, quat) = match inertial.moments {
        Moments::Principal(moments) => (moments, inertial.orientation.resolve(&body.compiler)),
        Moments::Full(full) => inertia::principal_axes(full, spec.revision),
    };
    Inertia {
        mass: inertial.mass,
        pos: inertial.pos,
        quat,
        moments,
    }
}
