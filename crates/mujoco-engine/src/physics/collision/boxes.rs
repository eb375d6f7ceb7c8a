//! Boxes against planes and spheres, and spheres against cylinders.

use super::{Hit, Push, Shape, spheres};
use crate::math::spatial::{
    MINVAL, Vec3, add, add_scaled, dot, normalize, rotate, rotate_back, scale, sub,
};

/// Contacts at the lowest corners, at most four.
pub(super) fn plane_box(plane: Shape<'_>, cuboid: Shape<'_>, margin: f64, push: Push<'_>) {
    let normal = plane.axis();
    let height = dot(sub(cuboid.pos, plane.pos), normal);
    let mut count = 0;
    for i in 0..8 {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        let size = cuboid.size;
        let local = [sign(1) * size[0], sign(2) * size[1], sign(4) * size[2]];
        let corner = rotate(cuboid.mat, local);
        let below = dot(normal, corner);
        let dist = height + below;
        if dist > margin || below > 0.0 {
            continue;
        }
        let pos = add(add(corner, cuboid.pos), scale(normal, -dist / 2.0));
        push(Hit::new(dist, pos, normal));
        count += 1;
        if count == 4 {
            return;
        }
    }
}

/// The contact at the point of the box nearest to the sphere; for a centre inside the box, at the
/// nearest face.
pub(super) fn sphere_box(
    (centre, radius): (Vec3, f64),
    cuboid: Shape<'_>,
    margin: f64,
    push: Push<'_>,
) {
    let size = cuboid.size;
    let center = rotate_back(cuboid.mat, sub(centre, cuboid.pos));
    let clamped: Vec3 = std::array::from_fn(|k| {
        if size[k] > 0.0 {
            center[k].max(-size[k]).min(size[k])
        } else {
            center[k]
        }
    });
    let (towards, mut dist) = normalize(sub(clamped, center));
    if dist - radius > margin {
        return;
    }
    let (pos, normal);
    if dist <= MINVAL {
        let mut closest = (size[0] + size[1] + size[2]) * 2.0;
        let mut face = 0;
        for i in 0..6 {
            let sign = if i % 2 == 1 { 1.0 } else { -1.0 };
            let depth = (sign * size[i / 2] - center[i / 2]).abs();
            if closest > depth {
                (closest, face) = (depth, i);
            }
        }
        let mut nearest = [0.0; 3];
        nearest[face / 2] = if face % 2 == 1 { -1.0 } else { 1.0 };
        pos = add_scaled(center, nearest, (radius - closest) / 2.0);
        normal = rotate(cuboid.mat, nearest);
        dist = -closest;
    } else {
        let deepest = add_scaled(center, towards, radius);
        pos = add_scaled(add_scaled([0.0; 3], clamped, 0.5), deepest, 0.5);
        normal = rotate(cuboid.mat, towards);
    }
    let pos = add(rotate(cuboid.mat, pos), cuboid.pos);
    push(Hit::new(dist - radius, pos, normal));
}

/// The contact with the side, an end or the rim of the cylinder, whichever is nearest.
pub(super) fn sphere_cylinder(sphere: Shape<'_>, cylinder: Shape<'_>, margin: f64, push: Push<'_>) {
    let (axis, &[radius, half, _]) = (cylinder.axis(), cylinder.size);
    let vec = sub(sphere.pos, cylinder.pos);
    let x = dot(axis, vec);
    let along = scale(axis, x);
    let across = sub(vec, along);
    let square = dot(across, across);
    let (mut side, mut cap) = (x.abs() < half, square < radius * radius);
    if side && cap {
        if half - x.abs() < radius - square.sqrt() {
            side = false;
        } else {
            cap = false;
        }
    }
    let sphere_radius = sphere.size[0];
    let axes = (sphere.axis(), axis);
    let point = |centre: Vec3, radius: f64, push: Push<'_>| {
        if let Some(hit) = spheres(sphere.pos, sphere_radius, centre, radius, axes, margin) {
            push(hit);
        }
    };
    if side {
        point(add(along, cylinder.pos), radius, push);
    } else if cap {
        let sign = if x > 0.0 { 1.0 } else { -1.0 };
        let outwards = scale(axis, sign);
        let end = add_scaled(cylinder.pos, axis, sign * half);
        let dist = dot(sub(sphere.pos, end), outwards) - sphere_radius;
        if dist <= margin {
            let pos = add_scaled(sphere.pos, outwards, -(dist * 0.5 + sphere_radius));
            push(Hit::new(dist, pos, scale(outwards, -1.0)));
        }
    } else {
        let rim = scale(across, radius / square.sqrt());
        let end = scale(axis, if x > 0.0 { half } else { -half });
        point(add(add(end, rim), cylinder.pos), 0.0, push);
    }
}
