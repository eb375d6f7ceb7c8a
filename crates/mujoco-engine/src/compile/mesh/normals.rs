//! Normals of vertices, for pictures (`MakeNormal` in MuJoCo's `user_mesh.cc`): `f32`, with its
//! roundings.

use crate::math::spatial::{MINVAL, Mat3, Vec3, cross, dot, rotate_back};
use crate::mjcf::orientation::unit;

/// Unless `smooth`, a face whose normal has a smaller product with the vertex's does not count.
const SHARP: f64 = 0.8;

/// The mean normal of the faces at each vertex, by area.
pub(super) fn vertex_normals(points: &[Vec3], faces: &[[i32; 3]], smooth: bool) -> Vec<f32> {
    let mut normals = vec![0.0f32; 3 * points.len()];
    let add = |sums: &mut [f32], v: i32, normal: Vec3, area: f64| {
        for (sum, x) in sums[3 * v as usize..].iter_mut().zip(normal) {
            *sum = (f64::from(*sum) + x * area) as f32;
        }
    };
    for face in faces {
        let (normal, area) = face_normal(points, face);
        for &v in face {
            add(&mut normals, v, normal, area);
        }
    }
    if !smooth {
        let mut removed = vec![0.0f32; normals.len()];
        for face in faces {
            let (normal, area) = face_normal(points, face);
            for &v in face {
                let vertex = [0, 1, 2].map(|k| f64::from(normals[3 * v as usize + k]));
                if dot(normal, unit(vertex).0) < SHARP {
                    add(&mut removed, v, normal, area);
                }
            }
        }
        for (normal, removed) in normals.iter_mut().zip(removed) {
            *normal -= removed;
        }
    }
    for normal in normals.chunks_exact_mut(3) {
        let length = (normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]).sqrt();
        if f64::from(length) > MINVAL {
            for x in normal {
                *x /= length;
            }
        } else {
            normal.copy_from_slice(&[0.0, 0.0, 1.0]);
        }
    }
    normals
}

/// The unit normal and twice the area.
fn face_normal(points: &[Vec3], face: &[i32; 3]) -> (Vec3, f64) {
    let [a, b, c] = face.map(|v| points[v as usize]);
    unit(cross(
        [0, 1, 2].map(|k| b[k] - a[k]),
        [0, 1, 2].map(|k| c[k] - a[k]),
    ))
}

/// Turns back by `turn`, stretches by the inverse of `scale` and normalises the normals, when the
/// mesh is turned back and scaled.
pub(super) fn transform(normals: &mut [f32], turn: Option<&Mat3>, scale: Vec3) {
    if let Some(turn) = turn {
        rotate_all(normals, |normal| rotate_back(turn, normal));
    }
    if scale != [1.0; 3] {
        for normal in normals.chunks_exact_mut(3) {
            for (x, scale) in normal.iter_mut().zip(scale) {
                *x = (f64::from(*x) / scale) as f32;
            }
        }
    }
    for normal in normals.chunks_exact_mut(3) {
        let square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
        if f64::from(square) > MINVAL {
            let factor = 1.0 / square.sqrt();
            for x in normal {
                *x *= factor;
            }
        } else {
            normal.copy_from_slice(&[0.0, 0.0, 1.0]);
        }
    }
}

/// Rotates each normal in `f64`.
pub(super) fn rotate_all(normals: &mut [f32], rotate: impl Fn(Vec3) -> Vec3) {
    for normal in normals.chunks_exact_mut(3) {
        let rotated = rotate([0, 1, 2].map(|k| f64::from(normal[k])));
        for (x, rotated) in normal.iter_mut().zip(rotated) {
            *x = rotated as f32;
        }
    }
}
