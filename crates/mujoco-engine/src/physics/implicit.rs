//! Integrators that are implicit in velocities: MuJoCo's `implicit` and `implicitfast`.

use super::actuation::{disabled, next};
use super::free::Free;
use super::inertia::{self, factor_damped, solve as solve_m};
use super::passive::polynomials;
use super::tendon::pulling;
use super::velocity::joints;
use super::{fluid_slopes, muscle};
use crate::math::dense::{self, dot_sparse};
use crate::math::spatial::{Vec6, dot6, mul_inertia};
use crate::model::{BiasType, Disable, GainType, Integrator, JointType, TransmissionType};
use crate::{Data, Model};

pub(super) type Mat6 = [[f64; 6]; 6];

/// Computes and factors the matrix of `implicitfast`.
#[inline(never)]
pub(super) fn factor(m: &Model, d: &mut Data) {
    assemble_fast(m, d);
    factor_damped(m, d);
}

/// Computes `M - dt * d(force)/d(velocity)` for `implicitfast`, which leaves out the derivatives of
/// Coriolis and centrifugal forces.
fn assemble_fast(m: &Model, d: &mut Data) {
    let mut slopes = std::mem::take(&mut d.work.qh);
    slopes.clear();
    slopes.resize(d.qm.len(), 0.0);
    let plan = m.plan();
    let mut buffers = std::mem::take(&mut d.work.implicit);
    let Buffers { jac, free, .. } = &mut buffers;
    free.iter_mut().for_each(Free::clear);
    smooth(m, d, jac, &mut |row, column, value| {
        if let Some(free) = free.iter_mut().find(|free| free.has(row)) {
            free.add(row, column, value);
            return;
        }
        let row = plan.m_row(row);
        if let Ok(place) = plan.m_colind[row.clone()].binary_search(&column) {
            slopes[row.start + place] += value;
        }
    });
    for (slope, inertia) in slopes.iter_mut().zip(&d.qm) {
        *slope = inertia + *slope * -m.opt.timestep;
    }
    (d.work.qh, d.work.implicit) = (slopes, buffers);
}

/// Replaces the forces `acc_sum` by the accelerations of `implicitfast`. For bodies with a free
/// joint and no child joints, the equations include the derivatives of the gyroscopic forces.
pub(super) fn solve_fast(m: &Model, d: &mut Data) {
    let mut buffers = std::mem::take(&mut d.work.implicit);
    let free = &mut buffers.free;
    free.iter_mut().for_each(|free| free.solve(m, d));
    let work = &mut d.work;
    let (inverses, way) = (&work.qh_diag_inv, &mut work.way);
    solve_m(m, &work.qh, inverses, way, &mut work.acc_sum);
    for free in free {
        free.put(&mut work.acc_sum);
    }
    work.implicit = buffers;
}

/// The buffers of `implicit`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    /// For each row of the matrix: the columns that can be nonzero. For a degree of freedom, these
    /// are its ancestors, the degree of freedom itself, and its descendants.
    columns: Vec<Vec<usize>>,
    slopes: Vec<f64>,
    lu: Vec<f64>,
    /// Derivatives of a body's spatial vectors by each velocity.
    velocity: Vec<Vec6>,
    acceleration: Vec<Vec6>,
    force: Vec<Vec6>,
    part: Vec<f64>,
    /// The velocities of a point of a body by each degree of freedom.
    jac: Vec<Vec6>,
    /// For `implicitfast`: the bodies with a free joint and no child joints.
    free: Vec<Free>,
}

impl Buffers {
    pub(crate) fn new(m: &Model) -> Self {
        let n = m.nv();
        let mut buffers = Self::default();
        if matches!(
            m.opt.integrator,
            Integrator::Implicit | Integrator::ImplicitFast
        ) {
            buffers.jac.reserve(n);
        }
        if m.opt.integrator == Integrator::ImplicitFast {
            buffers.free.extend(Free::all(m));
        }
        if m.opt.integrator != Integrator::Implicit {
            return buffers;
        }
        let columns = |i| (0..n).filter(|&j| related(m, i, j)).collect();
        let zeros = vec![[0.0; 6]; m.nbody() * n];
        Self {
            columns: (0..n).map(columns).collect(),
            slopes: vec![0.0; n * n],
            lu: vec![0.0; n * n],
            velocity: zeros.clone(),
            acceleration: zeros.clone(),
            force: zeros,
            part: Vec::with_capacity(n),
            ..buffers
        }
    }
}

#[cfg(test)]
impl Buffers {
    pub(crate) fn poison(&mut self) {
        use crate::physics::work::Poison;
        for vector in [&mut self.slopes, &mut self.lu, &mut self.part] {
            vector.poison();
        }
        // the other derivatives are zeros where no velocity moves a body, and never written there
        self.jac.poison();
    }
}

/// The product of the matrix of the integrator, `implicit` or `implicitfast`, with the accelerations
/// `x`.
pub(super) fn multiply(m: &Model, d: &mut Data, x: &[f64]) -> Vec<f64> {
    let n = m.nv();
    let mut forces = vec![0.0; n];
    if m.opt.integrator == Integrator::ImplicitFast {
        assemble_fast(m, d);
        inertia::multiply(m, &d.work.qh, &mut d.work.way, x, &mut forces);
        for free in &d.work.implicit.free {
            free.multiply(m, d, x, &mut forces);
        }
        return forces;
    }
    let mut b = std::mem::take(&mut d.work.implicit);
    assemble(m, d, &mut b);
    for ((force, columns), row) in forces.iter_mut().zip(&b.columns).zip(b.lu.chunks(n)) {
        *force = dense::dot_at(row, x, columns);
    }
    d.work.implicit = b;
    forces
}

/// Replaces the forces `x` by the accelerations of `implicit`: MuJoCo's `mj_implicitSkip`.
#[inline(never)]
pub(super) fn solve(m: &Model, d: &Data, b: &mut Buffers, x: &mut [f64]) {
    assemble(m, d, b);
    factor_lu(&mut b.lu, &b.columns);
    solve_lu(&b.lu, &b.columns, &mut b.part, x);
}

/// Computes `M - dt * d(force)/d(velocity)`.
fn assemble(m: &Model, d: &Data, b: &mut Buffers) {
    let n = m.nv();
    b.slopes.fill(0.0);
    let (slopes, jac) = (&mut b.slopes, &mut b.jac);
    smooth(m, d, jac, &mut |row, column, value| {
        slopes[row * n + column] += value;
    });
    subtract_bias(m, d, b);
    b.lu.fill(0.0);
    for i in 0..n {
        let row = m.plan().m_row(i);
        for (&j, value) in m.plan().m_colind[row.clone()].iter().zip(&d.qm[row]) {
            (b.lu[i * n + j], b.lu[j * n + i]) = (*value, *value);
        }
    }
    for (lu, slope) in b.lu.iter_mut().zip(&b.slopes) {
        *lu += slope * -m.opt.timestep;
    }
}

/// Whether degree of freedom `i` is an ancestor of `j`, or the reverse.
fn related(m: &Model, i: usize, j: usize) -> bool {
    let moves = |i: usize, j: usize| m.plan().chain(m.dof_bodyid[i]).contains(&j);
    moves(i, j) || moves(j, i)
}

/// Passes each derivative of the forces of actuators, the medium and dampers to `add`: MuJoCo's
/// `mjd_actuator_vel` and `mjd_passive_vel`. `jac` is a buffer.
fn smooth(m: &Model, d: &Data, jac: &mut Vec<Vec6>, add: &mut impl FnMut(usize, usize, f64)) {
    actuators(m, d, add);
    if m.plan().passive {
        fluid_slopes::medium(m, d, jac, add);
    }
    if m.opt.disables(Disable::Damper) {
        return;
    }
    for i in 0..m.nv() {
        let slope = polynomials::slope(m.dof_damping[i], m.dof_dampingpoly[i], d.qvel[i]);
        add(i, i, -slope);
    }
    let paths = &m.plan().paths;
    for (t, row) in paths.rows.iter().enumerate() {
        let (linear, higher) = (m.tendon_damping[t], m.tendon_dampingpoly[t]);
        let damping = polynomials::slope(linear, higher, d.ten_velocity[t]);
        if damping != 0.0 {
            let (columns, j) = (&paths.columns[row.clone()], &d.ten_j[row.clone()]);
            add_square(columns, j, -damping, add);
        }
    }
}

/// Adds `factor J' J`.
fn add_square(columns: &[usize], j: &[f64], factor: f64, add: &mut impl FnMut(usize, usize, f64)) {
    for (&dof, part) in columns.iter().zip(j) {
        let scale = part * factor;
        for (&column, other) in columns.iter().zip(j) {
            add(dof, column, other * scale);
        }
    }
}

fn actuators(m: &Model, d: &Data, add: &mut impl FnMut(usize, usize, f64)) {
    if m.opt.disables(Disable::Actuation) {
        return;
    }
    for i in 0..m.nu() {
        if disabled(m, i) {
            continue;
        }
        let force = d.actuator_force[i];
        let [low, high] = m.actuator_forcerange[i];
        if m.actuator_forcelimited[i] && (force <= low || force >= high) {
            continue;
        }
        if m.revision.leaves_clamped_forces() && saturated(m, d, i) {
            continue;
        }
        let mut slope = 0.0;
        if m.actuator_biastype[i] == BiasType::Affine {
            slope = m.actuator_biasprm[i].0[2];
        }
        let gain = gain_slope(m, d, i);
        if gain != 0.0 {
            slope += gain
                * match usize::try_from(m.actuator_actadr[i]) {
                    Err(_) => {
                        if m.revision.derives_at_clamped_controls() {
                            d.work.ctrl[i]
                        } else {
                            // MuJoCo 3.12 ignores the range of the control here
                            d.ctrl[i]
                        }
                    }
                    Ok(adr) if m.actuator_actearly[i] => next(m, d, i, adr, d.act_dot[adr]),
                    Ok(adr) => d.act[adr],
                };
        }
        if slope != 0.0 {
            let (columns, moments) = d.work.moments.row(i);
            add_square(columns, moments, slope, add);
        }
    }
}

/// Whether the total actuator force on the joint or tendon of actuator `i` reaches the force range
/// of the joint or tendon: MuJoCo's `mjd_actuatorDerivSkip`, from 4.0 on.
fn saturated(m: &Model, d: &Data, i: usize) -> bool {
    let id = m.actuator_trnid[i][0] as usize;
    match m.actuator_trntype[i] {
        TransmissionType::Joint | TransmissionType::JointInParent if m.jnt_actfrclimited[id] => {
            let ([low, high], force) = (m.jnt_actfrcrange[id], d.qfrc_actuator[m.jnt_dofadr[id]]);
            force <= low || force >= high
        }
        TransmissionType::Tendon if m.tendon_actfrclimited[id] => {
            let forces = pulling(m, id).map(|k| d.actuator_force[k]);
            let sum = forces.fold(0.0, |sum, force| sum + force);
            let [low, high] = m.tendon_actfrcrange[id];
            sum <= low + low.abs() * 1e-10 || sum >= high - high.abs() * 1e-10
        }
        _ => false,
    }
}

/// The derivative of an actuator's gain by its velocity.
fn gain_slope(m: &Model, d: &Data, i: usize) -> f64 {
    match m.actuator_gaintype[i] {
        GainType::Affine => m.actuator_gainprm[i].0[2],
        GainType::Muscle => muscle::gain_slope(m, d, i),
        GainType::Fixed => 0.0,
    }
}

/// Subtracts the derivatives of Coriolis and centrifugal forces: MuJoCo's `mjd_rne_vel`.
fn subtract_bias(m: &Model, d: &Data, b: &mut Buffers) {
    let n = m.nv();
    b.force.fill([0.0; 6]);
    for body in 1..m.nbody() {
        let (from, to) = (m.body_parentid[body] * n, body * n);
        b.velocity.copy_within(from..from + n, to);
        b.acceleration.copy_within(from..from + n, to);
        let velocity = &mut b.velocity[to..to + n];
        let acceleration = &mut b.acceleration[to..to + n];
        add_axes(m, d, body, velocity, acceleration);
        let inertia = by_columns(|v| mul_inertia(&d.cinert[body], v));
        let momentum = mul_inertia(&d.cinert[body], &d.cvel[body]);
        let turned = product(&force_by_force(&d.cvel[body]), &inertia);
        let mut both = force_by_velocity(&momentum);
        for (row, turned) in both.iter_mut().zip(&turned) {
            add6(row, turned);
        }
        for column in 0..n {
            let mut sum = apply(&acceleration[column], &inertia);
            add6(&mut sum, &apply(&velocity[column], &both));
            b.force[to + column] = sum;
        }
    }
    for body in (1..m.nbody()).rev() {
        let parent = m.body_parentid[body];
        for column in 0..n {
            let own = b.force[body * n + column];
            add6(&mut b.force[parent * n + column], &own);
        }
    }
    for (j, columns) in b.columns.iter().enumerate() {
        for &column in columns {
            let force = &b.force[m.dof_bodyid[j] * n + column];
            b.slopes[j * n + column] -= dot6(force, &d.cdof[j]);
        }
    }
}

/// Adds a body's motion axes to the derivatives `velocity`, and the derivatives of `cdof_dot qvel`
/// to the derivatives `acceleration`: MuJoCo's `mjd_comVel_vel`.
fn add_axes(m: &Model, d: &Data, body: usize, velocity: &mut [Vec6], acceleration: &mut [Vec6]) {
    for joint in joints(m, body) {
        let first = m.jnt_dofadr[joint];
        // the axes of a free joint's translation are constant
        let fixed = match m.jnt_type[joint] {
            JointType::Free => first + 3,
            _ => first,
        };
        let all = first..first + m.jnt_type[joint].nv();
        for k in first..fixed {
            add6(&mut velocity[k], &d.cdof[k]);
            add6(&mut acceleration[k], &d.cdof_dot[k]);
        }
        for k in fixed..all.end {
            add6(&mut acceleration[k], &d.cdof_dot[k]);
            let by = motion_by_velocity(&d.cdof[k]);
            for (sum, v) in acceleration.iter_mut().zip(&*velocity) {
                let rate = apply(v, &by);
                for k6 in 0..6 {
                    sum[k6] += rate[k6] * d.qvel[k];
                }
            }
        }
        let axes = &d.cdof[fixed..all.end];
        for (velocity, axis) in velocity[fixed..all.end].iter_mut().zip(axes) {
            add6(velocity, axis);
        }
    }
}

fn add6(sum: &mut Vec6, x: &Vec6) {
    for (sum, x) in sum.iter_mut().zip(x) {
        *sum += x;
    }
}

/// The matrix of the linear function `f`.
fn by_columns(f: impl Fn(&Vec6) -> Vec6) -> Mat6 {
    let mut matrix = [[0.0; 6]; 6];
    for k in 0..6 {
        let mut unit = [0.0; 6];
        unit[k] = 1.0;
        for (row, value) in matrix.iter_mut().zip(f(&unit)) {
            row[k] = value;
        }
    }
    matrix
}

/// Returns `matrix * x`. The sums have the order in which MuJoCo multiplies by the transpose of a
/// matrix.
fn apply(x: &Vec6, matrix: &Mat6) -> Vec6 {
    let mut sum = [0.0; 6];
    for (k, x) in x.iter().enumerate() {
        if *x != 0.0 {
            for (sum, row) in sum.iter_mut().zip(matrix) {
                *sum += row[k] * x;
            }
        }
    }
    sum
}

fn product(a: &Mat6, b: &Mat6) -> Mat6 {
    a.map(|row| {
        let mut sum = [0.0; 6];
        for (x, b) in row.iter().zip(b) {
            if *x != 0.0 {
                for (sum, b) in sum.iter_mut().zip(b) {
                    *sum += b * x;
                }
            }
        }
        sum
    })
}

/// The derivative of [`cross_motion`](crate::math::spatial::cross_motion) by its first factor.
fn motion_by_velocity(v: &Vec6) -> Mat6 {
    let [a, b, c, x, y, z] = *v;
    [
        [0.0, c, -b, 0.0, 0.0, 0.0],
        [-c, 0.0, a, 0.0, 0.0, 0.0],
        [b, -a, 0.0, 0.0, 0.0, 0.0],
        [0.0, z, -y, 0.0, c, -b],
        [-z, 0.0, x, -c, 0.0, a],
        [y, -x, 0.0, b, -a, 0.0],
    ]
}

/// The derivative of [`cross_force`](crate::math::spatial::cross_force) by the motion.
fn force_by_velocity(f: &Vec6) -> Mat6 {
    let [a, b, c, x, y, z] = *f;
    [
        [0.0, c, -b, 0.0, z, -y],
        [-c, 0.0, a, -z, 0.0, x],
        [b, -a, 0.0, y, -x, 0.0],
        [0.0, z, -y, 0.0, 0.0, 0.0],
        [-z, 0.0, x, 0.0, 0.0, 0.0],
        [y, -x, 0.0, 0.0, 0.0, 0.0],
    ]
}

/// The derivative of [`cross_force`](crate::math::spatial::cross_force) by the force.
fn force_by_force(v: &Vec6) -> Mat6 {
    let [a, b, c, x, y, z] = *v;
    [
        [0.0, -c, b, 0.0, -z, y],
        [c, 0.0, -a, z, 0.0, -x],
        [-b, a, 0.0, -y, x, 0.0],
        [0.0, 0.0, 0.0, 0.0, -c, b],
        [0.0, 0.0, 0.0, c, 0.0, -a],
        [0.0, 0.0, 0.0, -b, a, 0.0],
    ]
}

/// Factors a sparse matrix whose row `i` has the columns `columns[i]`: MuJoCo's
/// `mju_factorLUSparse`.
fn factor_lu(lu: &mut [f64], columns: &[Vec<usize>]) {
    let n = columns.len();
    for i in (0..n).rev() {
        let pivot = lu[i * n + i];
        // the columns before `i` are ancestors of `i`: each of them has all the columns of row `i`
        // beyond it
        let before = &columns[i][..columns[i].partition_point(|&k| k < i)];
        for &j in before.iter().rev() {
            let share = lu[j * n + i] / pivot;
            lu[j * n + i] = share;
            for &k in before {
                lu[j * n + k] -= lu[i * n + k] * share;
            }
        }
    }
}

/// MuJoCo's `mju_solveLUSparse`.
fn solve_lu(lu: &[f64], columns: &[Vec<usize>], part: &mut Vec<f64>, x: &mut [f64]) {
    let n = columns.len();
    let mut sum = |i: usize, columns: &[usize], x: &[f64]| {
        part.clear();
        part.extend(columns.iter().map(|&k| lu[i * n + k]));
        dot_sparse(part, columns, x)
    };
    let place = |i: usize| columns[i].partition_point(|&k| k < i);
    for i in (0..n).rev() {
        let after = &columns[i][place(i) + 1..];
        if !after.is_empty() {
            x[i] -= sum(i, after, x);
        }
    }
    for i in 0..n {
        let before = &columns[i][..place(i)];
        if !before.is_empty() {
            x[i] -= sum(i, before, x);
        }
        x[i] /= lu[i * n + i];
    }
}
