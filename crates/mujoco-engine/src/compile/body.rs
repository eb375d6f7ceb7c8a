//! Bodies: ids, frames, masses.

use super::inertia::{self, Inertia};
use super::mesh::Mesh;
use super::{geom, joint};
use crate::Result;
use crate::math::spatial::EPS;
use crate::mjcf::MOST;
use crate::mjcf::orientation::within;
use crate::mjcf::spec::{Body, Inertial, Moments, Spec};
use crate::model::CompiledModel;

/// Adds a body with its joints, geoms and sites; `meshes` are those of the model.
pub(super) fn add_body(
    m: &mut CompiledModel,
    spec: &Spec,
    meshes: &[Mesh],
    id: usize,
    body: &Body,
) -> Result<()> {
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
        joint::add_joint(m, spec, id, body, joint)?;
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

    m.body_geomnum.push(body.geoms.len());
    m.body_geomadr.push(address(m.ngeom(), body.geoms.len()));
    let mut parts = Vec::with_capacity(body.geoms.len());
    let [first, last] = spec.compiler.inertia_groups;
    // the world has no mass
    let weighs = id > 0 && from_geoms(body, spec);
    for geom in &body.geoms {
        let part = geom::add_geom(m, spec, meshes, id, geom)?;
        if weighs && (first..=last).contains(&geom.group) {
            parts.push(part);
        }
    }
    let inertia = inertia_of(body, id, spec, &parts)?;
    m.body_mass.push(inertia.mass);
    m.body_ipos.push(inertia.pos);
    m.body_iquat.push(inertia.quat);
    m.body_inertia.push(inertia.moments);

    for site in &body.sites {
        geom::add_site(m, spec, id, site)?;
    }
    if m.nbody() > MOST || m.ngeom() > MOST || m.nv() > MOST {
        let reason =
            format!("more than {MOST} bodies, geoms or degrees of freedom are not supported");
        return Err(body.place.error(reason));
    }
    Ok(())
}

/// The id of the first of `count` elements, if the next free id is `next`; -1 if `count` is 0.
pub(super) fn address(next: usize, count: usize) -> i32 {
    if count == 0 { -1 } else { next as i32 }
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
    let heavy = parts.iter().filter(|part| part.mass > EPS);
    let heavy: Vec<Inertia> = heavy.copied().collect();
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
