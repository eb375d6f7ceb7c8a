//! Rangefinders: rays from a site along its z axis, or through the pixels of a camera.

use super::ray::{ray, surface};
use super::sensor::frame_of;
use crate::math::libm;
use crate::math::spatial::{
    MINVAL, Vec3, add, add_scaled, column, dot, normalize, rotate, rotate_back, scale, sub,
};
use crate::model::{GeomType, ObjectType, RAY};
use crate::{Data, Model};

/// Writes the values of a rangefinder.
pub(super) fn read(m: &Model, d: &Data, i: usize, out: &mut [f64]) {
    let bits = m.sensor_intprm[i][0].max(1);
    let id = usize::try_from(m.sensor_objid[i]).unwrap_or(0);
    if m.sensor_objtype[i] != ObjectType::Camera {
        let (origin, along) = (d.site_xpos[id], column(&d.site_xmat[id], 2));
        let hit = ray(m, d, origin, along, Some(m.site_bodyid[id]));
        write(m, d, bits, out, (origin, along), hit, None);
        return;
    }
    let [width, height] = m.cam_resolution[id].map(|pixels| usize::try_from(pixels).unwrap_or(0));
    let (body, pos, mat) = frame_of(m, d, ObjectType::Camera, id);
    let optics = Optics::new(m, id);
    let size = out.len() / (width * height).max(1);
    for (pixel, out) in out.chunks_exact_mut(size.max(1)).enumerate() {
        let at = [pixel % width, pixel / width].map(|x| x as f64 + 0.5);
        let [x, y] = [0, 1].map(|k| (at[k] - optics.center[k]) / optics.focal[k]);
        let (origin, along) = if m.cam_projection[id] == 0 {
            (pos, normalize(rotate(&mat, [x, -y, -1.0])).0)
        } else {
            let half = m.cam_fovy[id] / 2.0;
            let offset = rotate(&mat, [x * half, -y * half, 0.0]);
            (add(pos, offset), scale(column(&mat, 2), -1.0))
        };
        let hit = ray(m, d, origin, along, Some(body));
        write(
            m,
            d,
            bits,
            out,
            (origin, along),
            hit,
            Some((pos, column(&mat, 2))),
        );
    }
}

/// The focal lengths and the principal point of a camera, in pixels: MuJoCo's `mju_camIntrinsics`.
struct Optics {
    focal: [f64; 2],
    center: [f64; 2],
}

impl Optics {
    fn new(m: &Model, camera: usize) -> Self {
        let size = m.cam_resolution[camera].map(f64::from);
        let half = size.map(|x| x / 2.0);
        let sensor = m.cam_sensorsize[camera];
        if m.cam_projection[camera] != 0 {
            return Self {
                focal: half,
                center: half,
            };
        }
        if sensor[0] != 0.0 && sensor[1] != 0.0 {
            let intrinsic = m.cam_intrinsic[camera];
            // in single precision, as MuJoCo
            let pixels = |part: usize, axis: usize| {
                let on_sensor = intrinsic[2 * part + axis] as f32 / sensor[axis] as f32;
                f64::from(on_sensor * size[axis] as f32)
            };
            let of = |part: usize| [pixels(part, 0), pixels(part, 1)];
            return Self {
                focal: of(0),
                center: of(1),
            };
        }
        let (sin, cos) = libm::sin_cos(m.cam_fovy[camera] * std::f64::consts::PI / 360.0);
        Self {
            focal: [0.5 / (sin / cos) * size[1]; 2],
            center: half,
        }
    }
}

/// Writes the values of a ray that are asked for; `camera` has the position and the z axis.
fn write(
    m: &Model,
    d: &Data,
    bits: i32,
    mut out: &mut [f64],
    (origin, along): (Vec3, Vec3),
    hit: Option<(f64, usize)>,
    camera: Option<(Vec3, Vec3)>,
) {
    let dist = hit.map_or(-1.0, |(dist, _)| dist);
    let point = hit.map_or([0.0; 3], |_| add_scaled(origin, along, dist));
    let depth = match (hit, camera) {
        (None, _) => -1.0,
        (_, None) => dist,
        (_, Some((pos, axis))) => -dot(sub(point, pos), axis),
    };
    let values = [
        [dist, 0.0, 0.0],
        hit.map_or([0.0; 3], |_| along),
        origin,
        point,
        [0.0; 3],
        [depth, 0.0, 0.0],
    ];
    for (k, ((_, size), mut value)) in RAY.iter().zip(values).enumerate() {
        if bits & (1 << k) == 0 {
            continue;
        }
        if let (4, Some((dist, geom))) = (k, hit) {
            value = normal(m, d, geom, (origin, along), dist);
        }
        let (own, rest) = out.split_at_mut(*size);
        own.copy_from_slice(&value[..*size]);
        out = rest;
    }
}

/// The normal of a geom where a ray meets it.
fn normal(m: &Model, d: &Data, geom: usize, (origin, along): (Vec3, Vec3), dist: f64) -> Vec3 {
    let (pos, mat, size) = (d.geom_xpos[geom], &d.geom_xmat[geom], m.geom_size[geom]);
    let from = rotate_back(mat, sub(origin, pos));
    let v = rotate_back(mat, along);
    let at = add_scaled(from, v, dist);
    let [_, half, _] = size;
    // whether the ray meets the flat side at `end` of an axis
    let flat =
        |axis: usize, end: f64| v[axis].abs() > MINVAL && (end - from[axis]) / v[axis] == dist;
    let local = match m.geom_type[geom] {
        GeomType::Plane => return column(mat, 2),
        GeomType::Sphere => {
            return normalize(sub(add_scaled(origin, along, dist), pos)).0;
        }
        GeomType::Capsule => {
            let end = if at[2].abs() <= half {
                at[2]
            } else {
                half.copysign(at[2])
            };
            normalize([at[0], at[1], at[2] - end]).0
        }
        GeomType::Ellipsoid => {
            let s = size.map(|x| 1.0 / (x * x));
            normalize([0, 1, 2].map(|k| s[k] * at[k])).0
        }
        GeomType::Cylinder => match [-half, half].into_iter().find(|end| flat(2, *end)) {
            Some(end) => [0.0, 0.0, 1.0_f64.copysign(end)],
            None => normalize([at[0], at[1], 0.0]).0,
        },
        GeomType::Box => {
            let sides = (0..3).flat_map(|axis| [-1.0, 1.0].map(|sign| (axis, sign)));
            let mut met = sides.filter(|&(axis, sign)| flat(axis, sign * size[axis]));
            let mut normal = [0.0; 3];
            if let Some((axis, sign)) = met.next() {
                normal[axis] = sign;
            }
            normal
        }
        GeomType::Mesh | GeomType::Hfield => {
            return surface::normal(m, geom, (pos, mat), origin, along);
        }
    };
    rotate(mat, local)
}
