//! Areas, volumes, centres and moments of inertia, summed over triangles in the order and with the
//! operations of MuJoCo (`ComputeFaceCentroid`, `ComputeVolume`, `ComputeSurfaceArea`,
//! `ComputeInertia` in `user_mesh.cc`).

use super::Inertia;
use crate::math::spatial::{MINVAL, Vec3, cross, dot};

/// The area of a triangle, its centre, and its unit normal unless it has no area.
pub(super) fn triangle([a, b, c]: [Vec3; 3]) -> (f64, Vec3, Vec3) {
    let center = [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0);
    let normal = cross(
        [0, 1, 2].map(|k| b[k] - a[k]),
        [0, 1, 2].map(|k| c[k] - a[k]),
    );
    let length = dot(normal, normal).sqrt();
    if length < MINVAL {
        return (0.0, center, normal);
    }
    (0.5 * length, center, normal.map(|x| x / length))
}

/// Triangles as corners.
pub(super) fn corners<'a>(
    points: &'a [Vec3],
    faces: &'a [[i32; 3]],
) -> impl Iterator<Item = [Vec3; 3]> + 'a {
    faces.iter().map(|face| face.map(|v| points[v as usize]))
}

/// The area of all triangles, and the mean of their centres by area.
pub(super) fn face_centroid(points: &[Vec3], faces: &[[i32; 3]]) -> (f64, Vec3) {
    let mut sum = [0.0; 3];
    let mut total = 0.0;
    for corners in corners(points, faces) {
        let (area, center, _) = triangle(corners);
        for k in 0..3 {
            sum[k] += area * center[k];
        }
        total += area;
    }
    (
        total,
        if total >= MINVAL {
            sum.map(|x| x / total)
        } else {
            sum
        },
    )
}

/// The volume, or of a shell the area, and the centre of mass. Pyramids from `origin` to each
/// triangle are summed.
pub(super) fn center_of_mass(
    points: &[Vec3],
    faces: &[[i32; 3]],
    origin: Vec3,
    inertia: Inertia,
) -> (f64, Vec3) {
    let mut sum = [0.0; 3];
    let mut total = 0.0;
    for corners in corners(points, faces) {
        let (area, center, normal) = triangle(corners);
        let weight = if inertia == Inertia::Shell {
            area
        } else {
            let out = [0, 1, 2].map(|k| center[k] - origin[k]);
            let volume = dot(out, normal) * area / 3.0;
            if inertia == Inertia::Legacy {
                volume.abs()
            } else {
                volume
            }
        };
        total += weight;
        for k in 0..3 {
            sum[k] += weight * (center[k] * 3.0 / 4.0 + origin[k] / 4.0);
        }
    }
    (
        total,
        if total >= MINVAL {
            sum.map(|x| x / total)
        } else {
            sum
        },
    )
}

/// The volume, or of a shell the area, and the moments of inertia (xx, yy, zz, xy, xz, yz) about
/// `center`, for density 1.
pub(super) fn moments(
    points: &[Vec3],
    faces: &[[i32; 3]],
    center: Vec3,
    inertia: Inertia,
) -> (f64, [f64; 6]) {
    const AXES: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];
    let centered: Vec<Vec3> = points
        .iter()
        .map(|p| [0, 1, 2].map(|k| p[k] - center[k]))
        .collect();
    let mut products = [0.0; 6];
    let mut total = 0.0;
    for [d, e, f] in corners(&centered, faces) {
        let (area, center, normal) = triangle([d, e, f]);
        let mut weight = if inertia == Inertia::Shell {
            area
        } else {
            dot(center, normal) * area / 3.0
        };
        if inertia == Inertia::Legacy {
            weight = weight.abs();
        }
        total += weight;
        let divisor = if inertia == Inertia::Shell {
            12.0
        } else {
            20.0
        };
        for (product, [i, j]) in products.iter_mut().zip(AXES) {
            *product += weight / divisor
                * (2.0 * (d[i] * d[j] + e[i] * e[j] + f[i] * f[j])
                    + d[i] * e[j]
                    + d[j] * e[i]
                    + d[i] * f[j]
                    + d[j] * f[i]
                    + e[i] * f[j]
                    + e[j] * f[i]);
        }
    }
    let [xx, yy, zz, xy, xz, yz] = products;
    (total, [yy + zz, xx + zz, xx + yy, -xy, -xz, -yz])
}
