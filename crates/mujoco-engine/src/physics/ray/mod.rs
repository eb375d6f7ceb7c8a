//! Intersections of rays with geoms.

pub(super) mod surface;

use crate::math::spatial::{MINVAL, Mat3, Vec3, dot, rotate_back, sub};
use crate::model::GeomType;
use crate::{Data, Model};

/// The distance, in lengths of `along`, from `point` to the nearest visible geom on the ray, and
/// that geom: MuJoCo's `mj_ray`. Geoms of the body `except` are ignored.
///
/// The first ray to a mesh sorts the mesh's triangles, unless the model has range finders: then they
/// are sorted when the model is made.
#[must_use]
pub fn ray(
    m: &Model,
    d: &Data,
    point: [f64; 3],
    along: [f64; 3],
    except: Option<usize>,
) -> Option<(f64, usize)> {
    ray_among(m, d, point, along, |g| {
        let opacity = match usize::try_from(m.geom_matid[g]) {
            Ok(material) => m.mat_rgba[material][3],
            Err(_) => m.geom_rgba[g][3],
        };
        Some(m.geom_bodyid[g]) != except && opacity != 0.0
    })
}

/// [`ray`] among the geoms that `is_seen` selects, visible or not.
#[must_use]
pub fn ray_among(
    m: &Model,
    d: &Data,
    point: [f64; 3],
    along: [f64; 3],
    is_seen: impl Fn(usize) -> bool,
) -> Option<(f64, usize)> {
    let mut nearest: Option<(f64, usize)> = None;
    for g in (0..m.ngeom()).filter(|g| is_seen(*g)) {
        let place = (d.geom_xpos[g], &d.geom_xmat[g]);
        let distance = match m.geom_type[g] {
            GeomType::Mesh => surface::mesh(m, g, place, point, along, &mut |_| {}),
            GeomType::Hfield => surface::hfield(m, g, place, point, along, &mut |_| {}),
            kind => ray_shape(kind.into(), place, m.geom_size[g], point, along),
        };
        if distance >= 0.0 && nearest.is_none_or(|(least, _)| distance < least) {
            nearest = Some((distance, g));
        }
    }
    nearest
}

/// The distance at which a ray meets a shape, given by MuJoCo's number of its type; -1 for none:
/// MuJoCo's `mju_rayGeom`.
#[must_use]
pub fn ray_shape(
    shape: u8,
    (pos, mat): (Vec3, &Mat3),
    size: Vec3,
    point: Vec3,
    along: Vec3,
) -> f64 {
    let Ok(shape) = GeomType::try_from(shape) else {
        return -1.0;
    };
    let local = || (rotate_back(mat, sub(point, pos)), rotate_back(mat, along));
    let near = |square: f64| near(pos, square, point, along);
    let [r, half, _] = size;
    match shape {
        GeomType::Sphere => sphere(sub(point, pos), along, r * r),
        GeomType::Plane => plane(size, local()),
        GeomType::Capsule if near((r + half) * (r + half)) => capsule(size, local()),
        GeomType::Cylinder if near(r * r + half * half) => cylinder(size, local()),
        GeomType::Box if near(dot(size, size)) => cuboid(size, local()),
        GeomType::Ellipsoid => {
            let (p, v) = local();
            let s = size.map(|x| 1.0 / (x * x));
            let a = s[0] * v[0] * v[0] + s[1] * v[1] * v[1] + s[2] * v[2] * v[2];
            let b = s[0] * v[0] * p[0] + s[1] * v[1] * p[1] + s[2] * v[2] * p[2];
            let c = s[0] * p[0] * p[0] + s[1] * p[1] * p[1] + s[2] * p[2] * p[2] - 1.0;
            least(quadratic(a, b, c))
        }
        _ => -1.0,
    }
}

/// Whether a ray meets a sphere around a shape, given by the square of its radius.
fn near(pos: Vec3, square: f64, point: Vec3, along: Vec3) -> bool {
    sphere(sub(point, pos), along, square) >= 0.0
}

/// The solutions of `a x^2 + 2 b x + c = 0` in ascending order; -1 twice if there are none.
fn quadratic(a: f64, b: f64, c: f64) -> [f64; 2] {
    let det = b * b - a * c;
    if det < 0.0 || a < MINVAL {
        return [-1.0; 2];
    }
    let root = det.sqrt();
    [(-b - root) / a, (-b + root) / a]
}

/// The smaller solution that is not negative.
fn least([first, second]: [f64; 2]) -> f64 {
    if first >= 0.0 {
        first
    } else if second >= 0.0 {
        second
    } else {
        -1.0
    }
}

/// The smaller of two distances; a negative `found` means no hit yet.
fn nearer(found: f64, x: f64) -> f64 {
    if found < 0.0 || x < found { x } else { found }
}

fn sphere(from: Vec3, v: Vec3, square: f64) -> f64 {
    let (a, b, c) = (dot(v, v), dot(v, from), dot(from, from) - square);
    least(quadratic(a, b, c))
}

fn plane(size: Vec3, (p, v): (Vec3, Vec3)) -> f64 {
    if v[2] > -MINVAL {
        return -1.0;
    }
    let x = -p[2] / v[2];
    let within = |k: usize| size[k] <= 0.0 || (p[k] + x * v[k]).abs() <= size[k];
    if x >= 0.0 && within(0) && within(1) {
        x
    } else {
        -1.0
    }
}

/// The distance to the lateral surface between the ends.
fn side([r, half, _]: Vec3, p: Vec3, v: Vec3) -> f64 {
    let a = v[0] * v[0] + v[1] * v[1];
    let b = v[0] * p[0] + v[1] * p[1];
    let c = p[0] * p[0] + p[1] * p[1] - r * r;
    let x = least(quadratic(a, b, c));
    if x >= 0.0 && (p[2] + x * v[2]).abs() <= half {
        x
    } else {
        -1.0
    }
}

fn capsule(size: Vec3, (p, v): (Vec3, Vec3)) -> f64 {
    let [r, half, _] = size;
    let mut x = side(size, p, v);
    for end in [half, -half] {
        let from = [p[0], p[1], p[2] - end];
        let solutions = quadratic(dot(v, v), dot(v, from), dot(from, from) - r * r);
        for solution in solutions {
            let z = p[2] + solution * v[2];
            let beyond = if end > 0.0 { z >= half } else { z <= -half };
            if solution >= 0.0 && beyond {
                x = nearer(x, solution);
            }
        }
    }
    x
}

fn cylinder(size: Vec3, (p, v): (Vec3, Vec3)) -> f64 {
    let [r, half, _] = size;
    let mut x = -1.0;
    if v[2].abs() > MINVAL {
        for end in [-half, half] {
            let solution = (end - p[2]) / v[2];
            let (x0, y0) = (p[0] + solution * v[0], p[1] + solution * v[1]);
            if solution >= 0.0 && x0 * x0 + y0 * y0 <= r * r {
                x = nearer(x, solution);
            }
        }
    }
    let round = side(size, p, v);
    if round >= 0.0 { nearer(x, round) } else { x }
}

/// The distances of the faces of a box; -1 for those that the ray does not meet.
fn faces(size: Vec3, (p, v): (Vec3, Vec3)) -> [f64; 6] {
    let mut found = [-1.0; 6];
    for (i, [j, k]) in [[1, 2], [0, 2], [0, 1]].into_iter().enumerate() {
        if v[i].abs() <= MINVAL {
            continue;
        }
        for (side, end) in [-size[i], size[i]].into_iter().enumerate() {
            let solution = (end - p[i]) / v[i];
            let within = |k: usize| (p[k] + solution * v[k]).abs() <= size[k];
            if solution >= 0.0 && within(j) && within(k) {
                found[2 * i + side] = solution;
            }
        }
    }
    found
}

fn cuboid(size: Vec3, ray: (Vec3, Vec3)) -> f64 {
    let met = faces(size, ray).into_iter().filter(|x| *x >= 0.0);
    met.fold(-1.0, nearer)
}
