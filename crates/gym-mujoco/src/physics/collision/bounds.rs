//! The boxes around geoms: a last test before two geoms may touch.
//!
//! MuJoCo drops a pair of geoms whose bounding boxes are apart before it computes their contacts:
//! `mj_collideOBB`, called for bodies with several geoms. Only rounding can put the boxes apart
//! where the geoms touch, so the test runs only where all contacts are about as far as contacts can
//! be.

use super::super::spatial::{Vec3, add, column, dot, rotate};
use super::Shape;
use crate::model::GeomType;

/// Contacts that are further below the margin are never dropped by rounding: a plane's box has
/// sides of 1e10.
pub(super) const ROUNDING: f64 = 1e-5;

/// Sizes from here on count as infinite: MuJoCo's `mjMAXVAL`.
const INFINITE: f64 = 1e10;

/// The centre and the half sizes of the box around a geom, in its frame: MuJoCo's `geom_aabb`.
pub(crate) fn bounding_box(kind: GeomType, size: Vec3) -> [Vec3; 2] {
    let [r, half, z] = size;
    let centre = match kind {
        GeomType::Plane => [0.0, 0.0, -5e9],
        _ => [0.0; 3],
    };
    let half = match kind {
        GeomType::Plane => [1e10, 1e10, 5e9],
        GeomType::Sphere => [r, r, r],
        GeomType::Capsule => [r, r, r + half],
        GeomType::Cylinder => [r, r, half],
        GeomType::Ellipsoid | GeomType::Box => [r, half, z],
    };
    [centre, half]
}

/// Whether one of the six faces of two boxes separates them, with a margin between.
pub(super) fn apart(kind: (GeomType, GeomType), shapes: [Shape<'_>; 2], margin: f64) -> bool {
    let boxes = [(kind.0, shapes[0]), (kind.1, shapes[1])].map(|(kind, shape)| {
        let [centre, half] = bounding_box(kind, *shape.size);
        let axes = [0, 1, 2].map(|k| column(shape.mat, k));
        (add(rotate(shape.mat, centre), shape.pos), half, axes)
    });
    let endless = boxes.map(|(_, half, _)| half.iter().any(|&half| half >= INFINITE));
    (0..2).filter(|&k| !endless[1 - k]).any(|k| {
        boxes[k].2.into_iter().any(|normal| {
            let [a, b] = boxes.map(|(centre, half, axes)| {
                let part = |i: usize| (half[i] * dot(axes[i], normal)).abs();
                (dot(centre, normal), part(0) + part(1) + part(2))
            });
            a.1 + b.1 + margin < (b.0 - a.0).abs()
        })
    })
}
