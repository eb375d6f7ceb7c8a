//! Fluid forces on geoms by the ellipsoid model: MuJoCo's `mj_ellipsoidFluidModel`.

use std::f64::consts::PI;

use super::jacobian::apply;
use super::sensor::object_velocity;
use crate::math::spatial::{
    MINVAL, Vec3, add, cross, norm, rotate, rotate_back, rotation, scale, sub, translation,
};
use crate::model::{Fluid, GeomType, ObjectType};
use crate::{Data, Model, Revision};

/// Adds the forces on the geoms of a body.
#[inline(never)]
pub(super) fn ellipsoids(m: &Model, d: &Data, body: usize, out: &mut [f64]) {
    let first = usize::try_from(m.body_geomadr[body]).unwrap_or(0);
    for g in first..first + m.body_geomnum[body] {
        let fluid = &m.geom_fluid[g];
        if fluid.0[0] == 0.0 {
            continue;
        }
        let mat = &d.geom_xmat[g];
        let velocity = object_velocity(m, d, ObjectType::Geom, g, true);
        let w = rotation(&velocity);
        let v = sub(translation(&velocity), rotate_back(mat, m.opt.wind));
        let semiaxes = semiaxes(m.geom_type[g], m.geom_size[g]);
        let (mut torque, mut force) = added_mass(w, v, m.opt.density, fluid);
        let (medium, sum) = ((m.opt.density, m.opt.viscosity), (&mut torque, &mut force));
        drag((w, v), medium, semiaxes, fluid, m.revision, sum);
        let [torque, force] = [torque, force].map(|x| rotate(mat, scale(x, fluid.0[0])));
        apply(m, d, force, torque, (body, d.geom_xpos[g]), out);
    }
}

/// The semi-axes of the ellipsoid that approximates a shape.
pub(super) fn semiaxes(shape: GeomType, size: Vec3) -> Vec3 {
    match shape {
        GeomType::Sphere => [size[0]; 3],
        GeomType::Capsule => [size[0], size[0], size[1] + size[0]],
        GeomType::Cylinder => [size[0], size[0], size[1]],
        _ => size,
    }
}

/// Torque and force of the added mass: MuJoCo's `mj_addedMassForces`.
fn added_mass(w: Vec3, v: Vec3, density: f64, fluid: &Fluid) -> (Vec3, Vec3) {
    let part = |first: usize, x: Vec3| -> Vec3 {
        std::array::from_fn(|k| density * fluid.0[first + k] * x[k])
    };
    let (linear, angular) = (part(6, v), part(9, w));
    let torque = add(add([0.0; 3], cross(linear, v)), cross(angular, w));
    (torque, add([0.0; 3], cross(linear, w)))
}

fn square(x: f64) -> f64 {
    x * x
}

fn fourth(x: f64) -> f64 {
    (x * x) * (x * x)
}

/// The largest semiaxis, and the one between it and the smallest.
pub(super) fn largest_axes(size: Vec3) -> [f64; 2] {
    let most = size[0].max(size[1]).max(size[2]);
    let least = size[0].min(size[1]).min(size[2]);
    [most, size[0] + size[1] + size[2] - most - least]
}

/// What to multiply by instead of dividing by a length; 0 for hardly any.
pub(super) fn inverse(length: f64) -> f64 {
    if length > MINVAL { 1.0 / length } else { 0.0 }
}

/// The greatest moment of an ellipsoid's surface about axis `k`: MuJoCo's `ellipsoid_max_moment`.
pub(super) fn moment_of(size: Vec3, k: usize) -> f64 {
    let (own, a, b) = (size[k], size[(k + 1) % 3], size[(k + 2) % 3]);
    8.0 / 15.0 * PI * own * fourth(a.max(b))
}

/// Returns the area of the ellipsoid projected along the velocity, the surface normal of MuJoCo's
/// Kutta lift, and the factor from `normal x velocity` to the circulation.
fn projection(revision: Revision, v: Vec3, size: Vec3) -> (f64, (Vec3, f64)) {
    let faces = |[x, y, z]: Vec3| [y * z, z * x, x * y];
    if revision.scales_ellipsoids() {
        // computed from the direction alone, for an ellipsoid whose longest semi-axis is 1
        let most = size[0].max(size[1]).max(size[2]);
        let scaled = scale(size, inverse(most));
        let weights = faces(scaled).map(square);
        let along = scale(v, inverse(norm(v)));
        let above = weights[0] * along[0] * along[0]
            + weights[1] * along[1] * along[1]
            + weights[2] * along[2] * along[2];
        let weights = scale(weights, inverse(above));
        let term = |k: usize| along[k] * square(weights[k]) * along[k];
        let below = term(0) + term(1) + term(2);
        let area = PI * most * most * (above * below).sqrt();
        let normal = std::array::from_fn(|k| weights[k] * along[k]);
        (area, (normal, inverse(below)))
    } else {
        let faces = faces(size);
        let below = fourth(faces[0]) * square(v[0])
            + fourth(faces[1]) * square(v[1])
            + fourth(faces[2]) * square(v[2]);
        let above = square(faces[0] * v[0]) + square(faces[1] * v[1]) + square(faces[2] * v[2]);
        let area = PI * (below / above.max(MINVAL)).sqrt();
        let normal = std::array::from_fn(|k| square(faces[k]) * v[k]);
        (area, (normal, above / (norm(v) * below).max(MINVAL)))
    }
}

/// Adds lift and drag: MuJoCo's `mj_viscousForces`.
fn drag(
    (w, v): (Vec3, Vec3),
    (density, viscosity): (f64, f64),
    size: Vec3,
    fluid: &Fluid,
    revision: Revision,
    (torque, force): (&mut Vec3, &mut Vec3),
) {
    let [_, blunt, slender, angular, kutta, magnus, ..] = fluid.0;
    let volume = 4.0 / 3.0 * PI * size[0] * size[1] * size[2];
    let [most, middle] = largest_axes(size);
    let area_most = PI * most * middle;

    let magnus = cross(w, v).map(|x| x * (magnus * density * volume));

    let speed = norm(v);
    let (area, (surface, cos)) = projection(revision, v, size);
    let kutta = match revision.scales_ellipsoids() {
        true => area * (density * kutta * cos),
        false => kutta * density * cos * area,
    };
    let kutta = cross(cross(surface, v).map(|x| x * kutta), v);

    let diameter = 2.0 / 3.0 * (size[0] + size[1] + size[2]);
    let linear_viscous = 3.0 * PI * diameter;
    let angular_viscous = PI * diameter * diameter * diameter;

    let moment_most = 8.0 / 15.0 * PI * middle * fourth(most);
    let moments: Vec3 = std::array::from_fn(|k| {
        let own = moment_of(size, k);
        w[k] * (angular * own + slender * (moment_most - own))
    });
    let linear = viscosity * linear_viscous
        + density * speed * (area * blunt + slender * (area_most - area));
    let turning = viscosity * angular_viscous + density * norm(moments);
    for k in 0..3 {
        torque[k] -= turning * w[k];
        force[k] += magnus[k] + kutta[k] - linear * v[k];
    }
}
