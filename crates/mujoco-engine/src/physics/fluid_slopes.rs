//! Derivatives of the forces of a medium by velocities, for implicit integrators.

use std::array::from_fn;
use std::f64::consts::PI;

use super::fluid::{inverse, largest_axes, moment_of, semiaxes};
use super::implicit::Mat6;
use super::jacobian::moves_at;
use super::sensor::object_velocity;
use crate::math::spatial::{
    MINVAL, Mat3, Vec3, Vec6, join, norm, rotate_back, rotation, scale, sub, translation,
};
use crate::model::{Integrator, ObjectType};
use crate::{Data, Model, Revision};

/// A matrix of three rows.
type Square = [Vec3; 3];

/// Passes each derivative to `add`: MuJoCo's `mjd_inertiaBoxFluid` and `mjd_ellipsoidFluid`.
/// `jac` is a buffer.
pub(super) fn medium(
    m: &Model,
    d: &Data,
    jac: &mut Vec<Vec6>,
    add: &mut impl FnMut(usize, usize, f64),
) {
    for &(b, edges) in &m.plan().boxes {
        match edges {
            Some(edges) => of_box(m, d, b, edges, jac, add),
            None => of_ellipsoids(m, d, b, jac, add),
        }
    }
}

/// Lists the velocities of a point of a body, in the axes of `mat`, by each degree of freedom.
fn list_columns(
    m: &Model,
    d: &Data,
    (body, pos, mat): (usize, Vec3, &Mat3),
    columns: &mut Vec<Vec6>,
) {
    columns.clear();
    columns.extend(m.plan().chain(body).iter().map(|&dof| {
        let moves = moves_at(m, &d.cdof, &d.subtree_com, dof, body, pos);
        let turns = rotation(&d.cdof[dof]);
        join(rotate_back(mat, turns), rotate_back(mat, moves))
    }));
}

/// Adds `J_i' b J_j` of two rows of the Jacobian: MuJoCo's `addJTBJ`.
fn add_product(
    (dofs, columns): (&[usize], &[Vec6]),
    (i, j): (usize, usize),
    b: f64,
    add: &mut impl FnMut(usize, usize, f64),
) {
    if b == 0.0 {
        return;
    }
    for (&row, own) in dofs.iter().zip(columns) {
        if own[i] == 0.0 {
            continue;
        }
        let factor = own[i] * b;
        for (&column, other) in dofs.iter().zip(columns) {
            add(row, column, other[j] * factor);
        }
    }
}

/// The velocity of an object relative to the medium, in the axes of the object.
fn velocity(m: &Model, d: &Data, kind: ObjectType, id: usize, mat: &Mat3) -> Vec6 {
    let velocity = object_velocity(m, d, kind, id, true);
    let v = sub(translation(&velocity), rotate_back(mat, m.opt.wind));
    join(rotation(&velocity), v)
}

fn of_box(
    m: &Model,
    d: &Data,
    b: usize,
    edges: Vec3,
    jac: &mut Vec<Vec6>,
    add: &mut impl FnMut(usize, usize, f64),
) {
    let mat = &d.ximat[b];
    let (density, viscosity) = (m.opt.density, m.opt.viscosity);
    let speed = velocity(m, d, ObjectType::Body, b, mat);
    list_columns(m, d, (b, d.xipos[b], mat), jac);
    let jac = (m.plan().chain(b), &jac[..]);
    if viscosity > 0.0 {
        let diameter = (edges[0] + edges[1] + edges[2]) / 3.0;
        let turning = -PI * diameter * diameter * diameter * viscosity;
        (0..3).for_each(|k| add_product(jac, (k, k), turning, add));
        let moving = -3.0 * PI * diameter * viscosity;
        (3..6).for_each(|k| add_product(jac, (k, k), moving, add));
    }
    if density > 0.0 {
        const OTHERS: [[usize; 2]; 3] = [[1, 2], [0, 2], [0, 1]];
        for (k, [i, j]) in OTHERS.into_iter().enumerate() {
            let (a, c) = (edges[i], edges[j]);
            let moment = -density * edges[k] * (a * a * a * a + c * c * c * c);
            let turning = moment * 2.0 * speed[k].abs() / 64.0;
            add_product(jac, (k, k), turning, add);
        }
        for (k, [i, j]) in OTHERS.into_iter().enumerate() {
            let moving = -0.5 * density * edges[i] * edges[j] * 2.0 * speed[3 + k].abs();
            add_product(jac, (3 + k, 3 + k), moving, add);
        }
    }
}

fn of_ellipsoids(
    m: &Model,
    d: &Data,
    body: usize,
    jac: &mut Vec<Vec6>,
    add: &mut impl FnMut(usize, usize, f64),
) {
    let first = usize::try_from(m.body_geomadr[body]).unwrap_or(0);
    for g in first..first + m.body_geomnum[body] {
        let fluid = &m.geom_fluid[g].0;
        if fluid[0] == 0.0 {
            continue;
        }
        let mat = &d.geom_xmat[g];
        let speed = velocity(m, d, ObjectType::Geom, g, mat);
        let (w, v) = (rotation(&speed), translation(&speed));
        let size = semiaxes(m.geom_type[g], m.geom_size[g]);
        let (density, viscosity) = (m.opt.density, m.opt.viscosity);
        let [_, blunt, slender, angular, kutta, magnus, ..] = *fluid;

        let mut b: Mat6 = [[0.0; 6]; 6];
        let volume = 4.0 / 3.0 * PI * size[0] * size[1] * size[2];
        let magnus = magnus * density * volume;
        let (by_w, by_v) = cross_slopes(scale(w, magnus), scale(v, magnus));
        put(&mut b, 3, 0, &by_w);
        put(&mut b, 3, 3, &by_v);
        let shape = Projected::new(v, size, m.revision);
        put(&mut b, 3, 3, &kutta_lift(&shape, density, kutta));
        let drag = drag(&shape, (density, viscosity), size, (blunt, slender));
        put(&mut b, 3, 3, &drag);
        let torque = torque(w, (density, viscosity), size, (slender, angular));
        put(&mut b, 0, 0, &torque);

        let part = |first: usize| -> Vec3 { from_fn(|k| density * fluid[first + k]) };
        let times = |a: Vec3, b: Vec3| -> Vec3 { from_fn(|k| a[k] * b[k]) };
        let (masses, inertias) = (part(6), part(9));
        let (linear, turning) = (times(masses, v), times(inertias, w));
        for (momentum, factors, other, (row, own, by)) in [
            (turning, inertias, w, (0, 0, 0)),
            (linear, masses, v, (0, 3, 3)),
            (linear, masses, w, (3, 3, 0)),
        ] {
            let (by_momentum, by_other) = cross_slopes(momentum, other);
            put(&mut b, row, by, &by_other);
            let by_own = by_momentum.map(|row| times(row, factors));
            put(&mut b, row, own, &by_own);
        }

        if m.opt.integrator == Integrator::ImplicitFast && !m.plan().free_bodies.contains(&body) {
            b = from_fn(|i| from_fn(|j| 0.5 * (b[i][j] + b[j][i])));
        }
        list_columns(m, d, (body, d.geom_xpos[g], mat), jac);
        let jac = (m.plan().chain(body), &jac[..]);
        for (i, row) in b.iter().enumerate() {
            for (j, b) in row.iter().enumerate() {
                add_product(jac, (i, j), *b, add);
            }
        }
    }
}

/// Adds a square to a part of the matrix.
fn put(b: &mut Mat6, row: usize, column: usize, square: &Square) {
    for (b, square) in b[row..].iter_mut().zip(square) {
        for (b, x) in b[column..].iter_mut().zip(square) {
            *b += x;
        }
    }
}

/// The derivatives of `a x b` by `a` and by `b`.
fn cross_slopes(a: Vec3, b: Vec3) -> (Square, Square) {
    let by_first = [[0.0, b[2], -b[1]], [-b[2], 0.0, b[0]], [b[1], -b[0], 0.0]];
    let by_second = [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]];
    (by_first, by_second)
}

/// Adds `factor vector` to a row.
fn add_row(row: &mut Vec3, vector: Vec3, factor: f64) {
    for (x, y) in row.iter_mut().zip(vector) {
        *x += y * factor;
    }
}

/// The derivative of the torque by the angular velocity: MuJoCo's `mjd_viscous_torque`.
fn torque(
    w: Vec3,
    (density, viscosity): (f64, f64),
    size: Vec3,
    (slender, angular): (f64, f64),
) -> Square {
    let [most, middle] = largest_axes(size);
    let diameter = 2.0 / 3.0 * (size[0] + size[1] + size[2]);
    let linear = viscosity * (PI * diameter * diameter * diameter);
    let moment_most = 8.0 / 15.0 * PI * middle * (most * most) * (most * most);
    let moments: Vec3 = from_fn(|k| {
        let own = moment_of(size, k);
        angular * own + slender * (moment_most - own)
    });
    let turned: Vec3 = from_fn(|k| w[k] * moments[k]);
    let density = density / f64::max(MINVAL, norm(turned));
    let squares: Vec3 = from_fn(|k| -density * w[k] * moments[k] * moments[k]);
    let mut slope = [[0.0; 3]; 3];
    let diagonal = w[0] * squares[0] + w[1] * squares[1] + w[2] * squares[2] - linear;
    for (k, row) in slope.iter_mut().enumerate() {
        row[k] = diagonal;
        add_row(row, squares, w[k]);
    }
    slope
}

/// The squares of the areas of the faces of the box around an ellipsoid.
fn faces([x, y, z]: Vec3) -> Vec3 {
    [y * z, z * x, x * y].map(|area| area * area)
}

/// The outer product of a vector with itself.
fn outer([x, y, z]: Vec3) -> Square {
    let (xy, yz, xz) = (x * y, y * z, x * z);
    [[x * x, xy, xz], [xy, y * y, yz], [xz, yz, z * z]]
}

/// The velocity of an ellipsoid, its faces, and what is projected along the velocity. From 3.17 on the
/// velocity has length 1 and the faces are those of an ellipsoid whose longest semiaxis is 1, divided by
/// `above`, as for the forces: else the limits of small divisors count for small bodies.
struct Projected {
    v: Vec3,
    /// The squares of the areas of the faces of the box around the ellipsoid.
    faces: Vec3,
    /// The sum of the squares of `v`, each times its face; 1 from 3.17 on.
    above: f64,
    /// The sum of the squares of `v`, each times the square of its face.
    below: f64,
    /// The square of `v`; 1 from 3.17 on.
    square: f64,
    /// The unit of areas.
    area: f64,
    /// The length of the velocity before it is scaled.
    speed: f64,
    /// The unit of the velocity.
    unit: f64,
    /// The unit of the velocity, divided by the length of the scaled velocity.
    direction: f64,
}

impl Projected {
    fn new(v: Vec3, size: Vec3, revision: Revision) -> Self {
        let weighted = |weights: Vec3, [x, y, z]: Vec3| {
            weights[0] * (x * x) + weights[1] * (y * y) + weights[2] * (z * z)
        };
        let squared = |faces: Vec3| faces.map(|face| face * face);
        let speed = norm(v);
        if revision.scales_ellipsoids() {
            let most = largest_axes(size)[0];
            let v = scale(v, inverse(speed));
            let faces = faces(scale(size, inverse(most)));
            let above = weighted(faces, v);
            let faces = scale(faces, inverse(above));
            Self {
                v,
                faces,
                above: 1.0,
                below: weighted(squared(faces), v),
                square: 1.0,
                area: most * most * above.sqrt(),
                speed,
                unit: speed,
                direction: speed,
            }
        } else {
            let faces = faces(size);
            Self {
                v,
                faces,
                above: weighted(faces, v),
                below: weighted(squared(faces), v),
                square: weighted([1.0; 3], v),
                area: 1.0,
                speed,
                unit: 1.0,
                direction: 1.0 / f64::max(MINVAL, speed),
            }
        }
    }
}

/// The derivative of the drag by the velocity: MuJoCo's `mjd_viscous_drag`.
fn drag(
    shape: &Projected,
    (density, viscosity): (f64, f64),
    size: Vec3,
    (blunt, slender): (f64, f64),
) -> Square {
    let [most, middle] = largest_axes(size);
    let diameter = 2.0 / 3.0 * (size[0] + size[1] + size[2]);
    let area_most = PI * most * middle;
    let [a, b, c] = shape.faces;
    let [x, y, z] = shape.v;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let (above, below) = (shape.above, shape.below);
    let bend = PI * shape.area / f64::max(MINVAL, (above * above * above * below).sqrt());
    let area = PI * shape.area * (below / f64::max(MINVAL, above)).sqrt();
    let linear = viscosity * 3.0 * PI * diameter;
    let quadratic = density * (area * blunt + slender * (area_most - area));
    let outward = -quadratic * shape.direction;
    let by_area = density * shape.speed * (blunt - slender);
    let area_slope = [
        by_area * bend * a * x * (b * yy * (a - b) + c * zz * (a - c)),
        by_area * bend * b * y * (a * xx * (b - a) + c * zz * (b - c)),
        by_area * bend * c * z * (a * xx * (c - a) + b * yy * (c - b)),
    ];
    let mut slope = outer(shape.v);
    for (k, row) in slope.iter_mut().enumerate() {
        row[k] += xx + yy + zz;
        for x in &mut *row {
            *x *= outward;
        }
        add_row(row, area_slope, -shape.v[k]);
        row[k] -= linear;
    }
    slope
}

/// The derivative of the lift by the velocity: MuJoCo's `mjd_kutta_lift`.
fn kutta_lift(shape: &Projected, density: f64, kutta: f64) -> Square {
    let faces = shape.faces;
    let [a, b, c] = faces;
    let [x, y, z] = shape.v;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let (above, below, square) = (shape.above, shape.below, shape.square);
    let factor = PI * kutta * density * shape.area * shape.unit;
    let factor = factor / f64::max(MINVAL, (below * above * square).sqrt());
    let along = [
        yy * (a - b) + zz * (a - c),
        xx * (b - a) + zz * (b - c),
        xx * (c - a) + yy * (c - b),
    ];
    let share = above / f64::max(MINVAL, below);
    let cosine = above / f64::max(MINVAL, square);
    let inner: Vec3 = from_fn(|k| faces[k] * faces[k] * share - faces[k] + cosine);
    let mut slope = outer(shape.v);
    for (k, row) in slope.iter_mut().enumerate() {
        for (j, x) in row.iter_mut().enumerate() {
            let part = (faces[j] - faces[k]) * (2.0 * above) + inner[j] * along[k];
            *x *= part;
        }
        row[k] -= along[k] * above;
        for x in &mut *row {
            *x *= factor;
        }
    }
    slope
}
