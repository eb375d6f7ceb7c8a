//! Mass and inertia of bodies, from their geoms: MuJoCo's formulas, shape by shape.

use std::f64::consts::PI;

use crate::Revision;
use crate::math::axes::Axes;
use crate::math::libm;
pub(super) use crate::math::spatial::MINVAL;
use crate::math::spatial::{InTurn, Order, Quat, inertia_at};
use crate::mjcf::orientation::{IDENTITY, compose, unit, within};
use crate::mjcf::spec::Frame;
use crate::model::GeomType;

/// Mass, centre and principal moments of inertia of a body, or of a geom within its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inertia {
    pub(super) mass: f64,
    pub(super) pos: [f64; 3],
    pub(super) quat: Quat,
    pub(super) moments: [f64; 3],
}

impl Inertia {
    /// Whether all numbers are finite.
    pub(super) fn is_finite(&self) -> bool {
        let Self {
            mass,
            pos,
            quat,
            moments,
        } = self;
        let numbers = pos.iter().chain(quat).chain(moments);
        mass.is_finite() && numbers.copied().all(f64::is_finite)
    }
}

/// The volume of a shape; of a `shell`, its surface area.
pub(super) fn volume(shape: GeomType, [r, half, z]: [f64; 3], shell: bool) -> f64 {
    let height = 2.0 * half;
    match (shape, shell) {
        (GeomType::Plane | GeomType::Mesh, _) => 0.0,
        (GeomType::Sphere, false) => 4.0 * PI * r * r * r / 3.0,
        (GeomType::Sphere, true) => 4.0 * PI * r * r,
        (GeomType::Capsule, false) => PI * (r * r * height + 4.0 * r * r * r / 3.0),
        (GeomType::Capsule, true) => 4.0 * PI * r * r + 2.0 * PI * r * height,
        (GeomType::Cylinder, false) => PI * r * r * height,
        (GeomType::Cylinder, true) => 2.0 * PI * r * r + 2.0 * PI * r * height,
        (GeomType::Ellipsoid, false) => 4.0 * PI * r * half * z / 3.0,
        (GeomType::Ellipsoid, true) => {
            // Thomsen's approximation
            const P: f64 = 1.6075;
            let sum = libm::pow(r * half, P) + libm::pow(half * z, P) + libm::pow(z * r, P);
            4.0 * PI * libm::pow(sum / 3.0, 1.0 / P)
        }
        (GeomType::Box | GeomType::Hfield, false) => r * half * z * 8.0,
        (GeomType::Box | GeomType::Hfield, true) => 8.0 * (r * half + half * z + z * r),
    }
}

/// The principal moments of inertia of a shape with the mass `mass`, about its own axes. The mass
/// of a `shell` lies on its surface.
pub(super) fn moments(shape: GeomType, mass: f64, size: [f64; 3], shell: bool) -> [f64; 3] {
    if mass == 0.0 {
        return [0.0; 3];
    }
    if shell {
        return shell_moments(shape, mass, size);
    }
    let [r, half, _] = size;
    let height = 2.0 * half;
    let [xx, yy, zz] = size.map(|x| x * x);
    match shape {
        GeomType::Plane | GeomType::Mesh => [0.0; 3],
        GeomType::Sphere => [2.0 * mass * r * r / 5.0; 3],
        GeomType::Cylinder => {
            let across = mass * (3.0 * r * r + height * height) / 12.0;
            [across, across, mass * r * r / 2.0]
        }
        GeomType::Capsule => {
            let ball = mass * 4.0 * r / (4.0 * r + 3.0 * height);
            let tube = mass - ball;
            let ball_moment = 2.0 * ball * r * r / 5.0;
            let across = tube * (3.0 * r * r + height * height) / 12.0
                + (ball_moment + ball * height * (3.0 * r + 2.0 * height) / 8.0);
            [across, across, tube * r * r / 2.0 + ball_moment]
        }
        GeomType::Ellipsoid => [yy + zz, xx + zz, xx + yy].map(|x| mass * x / 5.0),
        GeomType::Box | GeomType::Hfield => [yy + zz, xx + zz, xx + yy].map(|x| mass * x / 3.0),
    }
}

fn shell_moments(shape: GeomType, mass: f64, size: [f64; 3]) -> [f64; 3] {
    let [r, half, _] = size;
    let height = 2.0 * half;
    match shape {
        GeomType::Plane | GeomType::Mesh => [0.0; 3],
        GeomType::Sphere => [2.0 * mass * r * r / 3.0; 3],
        GeomType::Capsule => {
            let (balls, tube) = (4.0 * PI * r * r, 2.0 * PI * r * height);
            let ball = mass * balls / (balls + tube);
            let tube = mass - ball;
            let ball_moment = 2.0 * ball * r * r / 3.0;
            let com = r / 2.0;
            let place = half + com;
            let across = tube * (6.0 * r * r + height * height) / 12.0
                + (ball_moment + ball * (place * place - com * com));
            [across, across, tube * r * r + ball_moment]
        }
        GeomType::Cylinder => {
            let (disk, tube) = (PI * r * r, 2.0 * PI * r * height);
            let disk = mass * disk / (2.0 * disk + tube);
            let tube = mass - 2.0 * disk;
            let (disk_x, disk_z) = (disk * r * r / 4.0 + disk * half * half, disk * r * r / 2.0);
            let across = tube * (6.0 * r * r + height * height) / 12.0 + 2.0 * disk_x;
            [across, across, tube * r * r + 2.0 * disk_z]
        }
        GeomType::Ellipsoid => {
            // the difference of two ellipsoids
            let solid = |size: [f64; 3]| volume(GeomType::Ellipsoid, size, false);
            let outer = size.map(|x| x + 1e-6);
            let (inside, outside) = (solid(size), solid(outer));
            let density = mass / (outside - inside);
            let less = moments(GeomType::Ellipsoid, inside * density, size, false);
            let more = moments(GeomType::Ellipsoid, outside * density, outer, false);
            std::array::from_fn(|k| more[k] - less[k])
        }
        GeomType::Box | GeomType::Hfield => {
            let [lx, ly, lz] = size.map(|x| 2.0 * x);
            let [xx, yy, zz] = size.map(|x| x * x);
            let (a0, a1, a2) = (lx * ly, ly * lz, lz * lx);
            let total = 2.0 * (a0 + a1 + a2);
            let [m0, m1, m2] = [a0, a1, a2].map(|area| mass * area / total);
            let x = m0 * zz
                + m2 * yy
                + m0 * ly * ly / 12.0
                + m1 * (ly * ly + lz * lz) / 12.0
                + m2 * lz * lz / 12.0;
            let y = m0 * zz
                + m1 * xx
                + m0 * lx * lx / 12.0
                + m1 * lz * lz / 12.0
                + m2 * (lx * lx + lz * lz) / 12.0;
            let z = m1 * xx
                + m2 * yy
                + m0 * (lx * lx + ly * ly) / 12.0
                + m1 * ly * ly / 12.0
                + m2 * lx * lx / 12.0;
            [2.0 * x, 2.0 * y, 2.0 * z]
        }
    }
}

/// The combined inertia of several parts; `None` if there are none.
pub(super) fn combine(parts: &[Inertia], revision: Revision) -> Option<Inertia> {
    match parts {
        [] => return None,
        [one] => return Some(*one),
        _ => {}
    }
    let mass: f64 = parts.iter().map(|part| part.mass).sum();
    let pos = std::array::from_fn(|i| {
        let moments = parts.iter().map(|part| part.mass * part.pos[i]);
        moments.sum::<f64>() / mass
    });
    let mut total = [0.0; 6];
    for part in parts {
        let [turned, shift] = about(part, pos);
        for ((sum, turned), shift) in total.iter_mut().zip(turned).zip(shift) {
            *sum = *sum + turned + shift;
        }
    }
    let (moments, quat) = principal_axes(total, revision);
    Some(Inertia {
        mass,
        pos,
        quat,
        moments,
    })
}

/// The inertia of a body and of another whose frame in it is `pose`: MuJoCo's `AccumulateInertia`.
pub(super) fn accumulate(
    body: &Inertia,
    other: &Inertia,
    pose: Frame,
    revision: Revision,
) -> Inertia {
    let (pos, quat) = within(Some(pose), (other.pos, other.quat));
    let moved = Inertia {
        pos,
        quat,
        ..*other
    };
    let both = [*body, moved];
    let mass = both[0].mass + both[1].mass;
    if mass < MINVAL {
        return Inertia {
            mass: 0.0,
            pos: [0.0; 3],
            quat: IDENTITY,
            moments: [0.0; 3],
        };
    }
    let pos = std::array::from_fn(|i| {
        (both[0].mass * both[0].pos[i] + both[1].mass * both[1].pos[i]) / mass
    });
    let [own, others] = both.map(|part| {
        let [turned, shift] = about(&part, pos);
        std::array::from_fn::<_, 6, _>(|k| turned[k] + shift[k])
    });
    let total = std::array::from_fn(|k| own[k] + others[k]);
    let (moments, quat) = principal_axes(total, revision);
    Inertia {
        mass,
        pos,
        quat,
        moments,
    }
}

/// The inertia matrix of a part about a point, as two terms: about its own centre, and what the
/// distance adds.
fn about(part: &Inertia, point: [f64; 3]) -> [[f64; 6]; 2] {
    let mat = InTurn::quat_to_mat(part.quat);
    let turned = inertia_at((), part.moments, &mat, [0.0; 3], part.mass);
    let [x, y, z] = std::array::from_fn(|i| part.pos[i] - point[i]);
    let m = part.mass;
    let shift = [
        m * (y * y + z * z),
        m * (x * x + z * z),
        m * (x * x + y * y),
        -m * x * y,
        -m * x * z,
        -m * y * z,
    ];
    [std::array::from_fn(|k| turned[k]), shift]
}

/// Principal moments of an inertia matrix (xx, yy, zz, xy, xz, yz), falling, and the orientation of
/// their axes.
pub(super) fn principal_axes(total: [f64; 6], revision: Revision) -> ([f64; 3], Quat) {
    principal_axes_within(total, revision, 4e-15)
}

/// [`principal_axes`] with another limit `rest` of the largest off-diagonal element, relative to
/// the largest element. The limit counts from MuJoCo 3.14 on.
pub(super) fn principal_axes_within(
    [xx, yy, zz, xy, xz, yz]: [f64; 6],
    revision: Revision,
    rest: f64,
) -> ([f64; 3], Quat) {
    let full = [xx, xy, xz, xy, yy, yz, xz, yz, zz];
    let axes = Axes {
        half_tangents: revision.turns_by_half_tangent(),
        rest,
        unit: |quat| unit(quat).0,
        product: |a, b| unit(compose(a, b)).0,
    };
    axes.of(&full)
}
