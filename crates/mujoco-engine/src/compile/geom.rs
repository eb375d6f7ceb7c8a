//! Geoms and sites.

use super::constants::{bounding_radius, hfield_radius};
use super::fluid;
use super::inertia::{self, Inertia};
use super::mesh::Mesh;
use crate::Result;
use crate::math::spatial::{EPS, add};
use crate::mjcf::orientation::{from_z, turned, unit, within};
use crate::mjcf::spec::{Frame, Geom, Site, Spec, Wrap};
use crate::mjcf::xml::Place;
use crate::model::bounds::{Bounds, shape_box};
use crate::model::{CompiledModel, Fluid, GeomType, ObjectType};

/// Adds a geom, unless `discardvisual` leaves it out; returns its mass, and its centre and axes in
/// the body's frame.
pub(super) fn add_geom(
    m: &mut CompiledModel,
    spec: &Spec,
    meshes: &[Mesh],
    body: usize,
    geom: &Geom,
) -> Result<Inertia> {
    let Geom { place, shape, .. } = geom;
    let mut size = geom.size;
    let mesh = mesh_of(geom, spec)?;
    let field = hfield_of(geom, spec)?;
    if let Some(id) = field {
        let [x, y, height, base] = spec.hfields[id].size;
        size = [x, y, 0.25 * height + 0.5 * base];
    }
    let own = match geom.fromto {
        None => {
            let quat = geom.orientation.resolve(&geom.compiler);
            (geom.pos.unwrap_or_default(), quat)
        }
        Some(ends) => {
            if matches!(
                shape,
                GeomType::Plane | GeomType::Hfield | GeomType::Sphere | GeomType::Mesh
            ) {
                return Err(place.attribute(
                    "fromto",
                    "only capsules, cylinders, ellipsoids and boxes have ends: give type=\"capsule\"",
                ));
            }
            if mesh.is_some() {
                let reason = "does not go with mesh, which has a place of its own";
                return Err(place.attribute("fromto", reason));
            }
            let positioned = geom.pos.is_some_and(|pos| pos != [0.0; 3]);
            between(place, ends, &mut size, positioned)?
        }
    };
    if geom.fromto.is_some() && matches!(shape, GeomType::Ellipsoid | GeomType::Box) {
        size = [size[0], size[0], size[1]];
    }
    let own = match mesh {
        Some(id) => own_frame(geom, spec, &meshes[id], &mut size, own)?,
        None => own,
    };
    let (pos, quat) = within(geom.frame, own);
    check_size(geom, size)?;
    // the mesh itself, not one that a shape was fitted to
    let surface = mesh
        .filter(|_| *shape == GeomType::Mesh)
        .map(|id| &meshes[id]);
    let weld = m.body_weldid[body];
    if *shape == GeomType::Plane && weld != 0 && m.body_mocapid[weld] < 0 {
        let reason = "a plane belongs to the world, a mocap body, or a body fixed to one";
        return Err(place.attribute("type", reason));
    }
    let volume = match surface {
        Some(mesh) => mesh.volume,
        None => inertia::volume(*shape, size, geom.shell),
    };
    let mass = match geom.mass {
        // MuJoCo ignores the `mass` of a shape without volume
        Some(mass) if mass == 0.0 || volume > EPS => mass,
        Some(_) => 0.0,
        None => geom.density * volume,
    };
    let of_mesh = mesh.and_then(|id| spec.meshes[id].material.as_ref());
    let material = match geom.material.as_ref().or(of_mesh) {
        None => -1,
        Some(name) => {
            let found = spec.materials.iter().position(|of| of.name == *name);
            let missing = || place.attribute("material", format!("there is no material {name:?}"));
            found.ok_or_else(missing)? as i32
        }
    };
    let inertia = Inertia {
        mass,
        pos,
        quat,
        moments: match surface {
            Some(mesh) => mesh.moments(mass),
            None => inertia::moments(*shape, mass, size, geom.shell),
        },
    };
    let discards = spec.compiler.discard_visual;
    if discards && is_visual(geom, spec) {
        return Ok(inertia);
    }
    let radius = match field {
        Some(id) => hfield_radius(spec.hfields[id].size),
        None => bounding_radius(*shape, size),
    };
    if ![pos[0], pos[1], pos[2], radius]
        .iter()
        .all(|x| x.is_finite())
    {
        let reason = "its place in its frames, or the radius of the sphere around it, is larger than the largest number";
        return Err(place.error(reason));
    }
    m.names.geom.push(geom.name.clone());
    m.geom_type.push(*shape);
    m.geom_bodyid.push(body);
    m.geom_contype.push(geom.contype);
    m.geom_conaffinity.push(geom.conaffinity);
    m.geom_condim.push(geom.condim);
    m.geom_priority.push(geom.priority);
    m.geom_size.push(size);
    m.geom_rbound.push(radius);
    m.geom_aabb.push(match surface {
        Some(Mesh { lower, upper, .. }) => {
            let half = |sign: f64| [0, 1, 2].map(|k| (upper[k] + sign * lower[k]) / 2.0);
            flat([half(1.0), half(-1.0)])
        }
        None => flat(shape_box(*shape, size)),
    });
    let kept = surface.is_some() || !spec.revision.forgets_fitted_meshes();
    let data = field.or(mesh.filter(|_| kept));
    m.geom_dataid.push(data.map_or(-1, |id| id as i32));
    m.geom_fluid.push(if geom.fluid_ellipsoid {
        Fluid(fluid::coefficients(*shape, size, geom.fluid))
    } else {
        Fluid::default()
    });
    m.geom_surfacevel.push(geom.surface_velocity);
    m.geom_pos.push(pos);
    m.geom_quat.push(quat);
    m.geom_friction.push(geom.friction);
    m.geom_solmix.push(geom.solmix);
    m.geom_solref.push(geom.solref);
    m.geom_solimp.push(geom.solimp);
    m.geom_margin.push(geom.margin);
    m.geom_gap.push(geom.gap);
    m.geom_adhesion.push(geom.adhesion);
    m.geom_rgba.push(single(geom.rgba));
    m.geom_group.push(geom.group);
    m.geom_matid.push(if discards { -1 } else { material });
    Ok(inertia)
}

/// Whether a geom has no contacts, and no other element refers to it.
pub(super) fn is_visual(geom: &Geom, spec: &Spec) -> bool {
    let is = |name: &String| geom.name.as_ref() == Some(name);
    let wraps = spec.tendons.iter().flat_map(|tendon| &tendon.wraps);
    let sensors = spec.sensors.iter();
    geom.contype == 0
        && geom.conaffinity == 0
        && !spec
            .pairs
            .iter()
            .any(|pair| pair.geoms.iter().flatten().any(is))
        && !wraps
            .into_iter()
            .any(|(_, wrap)| matches!(wrap, Wrap::Geom(name, _) if is(name)))
        && !sensors
            .flat_map(|sensor| sensor.object.iter().chain(&sensor.reference))
            .any(|target| target.kind == ObjectType::Geom && is(&target.name))
}

/// The mesh of a geom.
fn mesh_of(geom: &Geom, spec: &Spec) -> Result<Option<usize>> {
    let error = |name, reason: &str| Err(geom.place.attribute(name, reason));
    let Some(name) = &geom.mesh else {
        return match geom.shape {
            GeomType::Mesh => error("mesh", "missing: it must be given for type=\"mesh\""),
            _ => Ok(None),
        };
    };
    let Some(id) = spec.meshes.iter().position(|mesh| mesh.name == *name) else {
        return error("mesh", &format!("there is no mesh {name:?}"));
    };
    if geom.shape == GeomType::Mesh && geom.shell {
        let reason = "is an attribute of the mesh here: give it inertia=\"shell\"";
        return error("shellinertia", reason);
    }
    Ok(Some(id))
}

/// The height field of a geom.
fn hfield_of(geom: &Geom, spec: &Spec) -> Result<Option<usize>> {
    let error = |reason: &str| Err(geom.place.attribute("hfield", reason));
    match (&geom.hfield, geom.shape) {
        (None, GeomType::Hfield) => error("missing: it must be given for type=\"hfield\""),
        (None, _) => Ok(None),
        (Some(name), GeomType::Hfield) => {
            let id = spec.hfields.iter().position(|field| field.name == *name);
            match id {
                None => error(&format!("there is no height field {name:?}")),
                id => Ok(id),
            }
        }
        (Some(_), _) => error("goes only with type=\"hfield\""),
    }
}

/// The frame of a geom with a mesh, moved to the mesh's, or to the centre of a shape that is fitted
/// to the mesh. Sets the size.
fn own_frame(
    geom: &Geom,
    spec: &Spec,
    mesh: &Mesh,
    size: &mut [f64; 3],
    own: Frame,
) -> Result<Frame> {
    let mut center = [0.0; 3];
    if geom.shape == GeomType::Mesh {
        *size = [0, 1, 2].map(|k| mesh.lower[k].abs().max(mesh.upper[k].abs()));
    } else {
        let fitted = mesh.fit(geom.shape, spec.compiler.fit_bounds, geom.fit_scale);
        let Some((fitted, at)) = fitted else {
            let reason = "only spheres, capsules, cylinders, ellipsoids and boxes fit to a mesh";
            return Err(geom.place.attribute("mesh", reason));
        };
        let numbers = match geom.shape {
            GeomType::Sphere => 1,
            GeomType::Capsule | GeomType::Cylinder => 2,
            _ => 3,
        };
        *size = size.map(|x| x * geom.fit_scale);
        size[..numbers].copy_from_slice(&fitted[..numbers]);
        center = at;
    }
    let at = add(
        turned(Some(([0.0; 3], mesh.orientation)), center),
        mesh.position,
    );
    Ok(within(Some(own), (at, mesh.orientation)))
}

/// The six numbers of a box.
fn flat([[a, b, c], [i, j, k]]: Bounds) -> [f64; 6] {
    [a, b, c, i, j, k]
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
        GeomType::Mesh | GeomType::Hfield => return Ok(()),
    };
    if size[..needed].iter().any(|x| *x <= 0.0) {
        let reason = format!("this shape has {what}, which must be positive");
        return Err(geom.place.attribute("size", reason));
    }
    Ok(())
}

/// Rounds a colour to single precision, as MuJoCo stores it.
pub(super) fn single(rgba: [f64; 4]) -> [f64; 4] {
    rgba.map(|x| f64::from(x as f32))
}

/// Adds a site; `outer` is the frame of the text's body in the compiled one.
pub(super) fn add_site(
    m: &mut CompiledModel,
    body: usize,
    site: &Site,
    outer: Option<Frame>,
) -> Result<()> {
    m.names.site.push(site.name.clone());
    m.site_bodyid.push(body);
    m.site_type.push(site.shape);
    let mut size = site.size;
    let own = match site.fromto {
        Some(ends) => between(&site.place, ends, &mut size, false)?,
        None => (site.pos, site.orientation.resolve(&site.compiler)),
    };
    if site.fromto.is_some() && ![3, 4, 5, 6].contains(&site.shape) {
        let reason = "only capsules, cylinders, ellipsoids and boxes have ends";
        return Err(site.place.attribute("fromto", reason));
    }
    if [4, 6].contains(&site.shape) && site.fromto.is_some() {
        size = [size[0], size[0], size[1]];
    }
    let (pos, quat) = within(outer, within(site.frame, own));
    m.site_size.push(size);
    m.site_pos.push(pos);
    m.site_quat.push(quat);
    m.site_rgba.push(single(site.rgba));
    m.site_group.push(site.group);
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
