//! Forces of springs, dampers and the medium.

pub(super) mod polynomials;

use std::f64::consts::PI;

use super::adhesion;
use super::fluid::ellipsoids;
use super::jacobian::apply;
use crate::math::number::{Number, get, of};
use crate::math::spatial::{
    InTurn, Order, Pairwise, Vec3, add, cross, dot, rotate, rotate_back, rotation, scale, sub,
    translation, velocity_at,
};
use crate::model::JointType;
use crate::{Data, Model};

/// Computes `qfrc_passive`: springs, dampers, fluid, then gravity compensation: MuJoCo's
/// `mj_passive`.
#[inline(always)]
pub fn passive(m: &Model, d: &mut Data) {
    let plan = m.plan();
    d.qfrc_passive.fill(0.0);
    if !plan.passive {
        return;
    }
    if plan.polynomials {
        polynomials::forces(m, d);
    } else {
        springs_and_dampers(m, d);
    }
    if !plan.boxes.is_empty() {
        d.work.fluid.fill(0.0);
        fluid(m, d);
        for (force, fluid) in d.qfrc_passive.iter_mut().zip(&d.work.fluid) {
            *force += fluid;
        }
    }
    if plan.adhesive {
        adhesion::pull(m, d);
    }
    if plan.gravcomp {
        lift(m, d);
    }
}

/// Adds the forces of springs and dampers that are linear.
#[inline(always)]
fn springs_and_dampers(m: &Model, d: &mut Data) {
    let plan = m.plan();
    for &j in &plan.springs {
        let stiffness = m.jnt_stiffness[j];
        let (p, i) = (m.jnt_qposadr[j], m.jnt_dofadr[j]);
        match m.jnt_type[j] {
            JointType::Free => {
                for k in 0..3 {
                    d.qfrc_passive[i + k] += (d.qpos[p + k] - m.qpos_spring[p + k]) * -stiffness;
                }
                turned_spring(m, d, p + 3, i + 3, stiffness);
            }
            JointType::Ball => turned_spring(m, d, p, i, stiffness),
            _ => d.qfrc_passive[i] = spring_force(d.qpos[p], m.qpos_spring[p], stiffness),
        }
    }
    if plan.paths.elastic.is_empty() {
        let dampers = d.qvel.iter().zip(&plan.damping);
        for (force, (velocity, damping)) in d.qfrc_passive.iter_mut().zip(dampers) {
            *force += damper_force((), *velocity, *damping);
        }
    } else {
        elastic_tendons(m, d);
    }
}

/// The force of a spring at position `q`.
#[inline(always)]
pub(in crate::physics) fn spring_force<N: Number>(q: N, rest: f64, stiffness: N) -> N {
    -(q - rest) * stiffness
}

/// The force of a damper at a velocity.
#[inline(always)]
pub(in crate::physics) fn damper_force<N: Number>(at: N::At, velocity: N, damping: f64) -> N {
    if damping == 0.0 {
        N::of(at, 0.0)
    } else {
        -velocity * damping
    }
}

/// Adds the spring of a ball or free joint's orientation.
fn turned_spring(m: &Model, d: &mut Data, p: usize, i: usize, stiffness: f64) {
    let turned = turn(m, d, p);
    for (force, turned) in d.qfrc_passive[i..i + 3].iter_mut().zip(turned) {
        *force += turned * -stiffness;
    }
}

/// The rotation of the joint at position index `p` from the spring's reference.
fn turn(m: &Model, d: &Data, p: usize) -> Vec3 {
    let quat = |q: &[f64]| [q[p], q[p + 1], q[p + 2], q[p + 3]];
    let (now, rest) = (quat(&d.qpos), quat(&m.qpos_spring));
    if m.revision.adds_in_pairs() {
        Pairwise::sub_quat(Pairwise::normalize_quat((), now), rest)
    } else {
        InTurn::sub_quat(InTurn::normalize_quat((), now), rest)
    }
}

/// Adds the forces of tendons' springs to `qfrc_passive`, then the forces of all dampers.
#[inline(never)]
fn elastic_tendons(m: &Model, d: &mut Data) {
    let plan = m.plan();
    let damper = &mut d.work.damper;
    for (i, force) in damper.iter_mut().enumerate() {
        *force = damper_force((), d.qvel[i], plan.damping[i]);
    }
    for &(t, stiffness, damping) in &plan.paths.elastic {
        let spring = tendon_spring_force(d.ten_length[t], m.tendon_lengthspring[t], stiffness);
        let damp = -d.ten_velocity[t] * damping;
        if spring == 0.0 && damp == 0.0 {
            continue;
        }
        let row = plan.paths.rows[t].clone();
        for (&dof, j) in plan.paths.columns[row.clone()].iter().zip(&d.ten_j[row]) {
            d.qfrc_passive[dof] += j * spring;
            damper[dof] += j * damp;
        }
    }
    for (force, damper) in d.qfrc_passive.iter_mut().zip(damper) {
        *force += *damper;
    }
}

/// The force of a tendon's spring at a length. There is none between the lengths `slack`.
pub(super) fn tendon_spring_force(length: f64, slack: [f64; 2], stiffness: f64) -> f64 {
    -stretch(length, slack) * stiffness
}

/// The difference of a length from the range in which a spring is slack.
pub(super) fn stretch(length: f64, [lower, upper]: [f64; 2]) -> f64 {
    if length > upper {
        length - upper
    } else if length < lower {
        length - lower
    } else {
        0.0
    }
}

/// Adds gravity compensation, except for joints whose actuators apply it: MuJoCo's `mj_gravcomp`.
#[inline(never)]
fn lift(m: &Model, d: &mut Data) {
    let mut forces = std::mem::take(&mut d.work.gravcomp);
    forces.fill(0.0);
    for b in 1..m.nbody() {
        let part = m.body_gravcomp[b];
        if part != 0.0 {
            let force = scale(m.opt.gravity, -(m.body_mass[b] * part));
            apply(m, d, force, [0.0; 3], (b, d.xipos[b]), &mut forces);
        }
    }
    for (i, force) in forces.iter().enumerate() {
        if !m.jnt_actgravcomp[m.dof_jntid[i]] {
            d.qfrc_passive[i] += force;
        }
    }
    d.work.gravcomp = forces;
}

/// Adds the fluid forces on each body, by the inertia box model or the ellipsoid model: MuJoCo's
/// `mj_inertiaBoxFluidModel`.
#[inline(always)]
fn fluid(m: &Model, d: &mut Data) {
    for &(b, edges) in &m.plan().boxes {
        let Some(edges) = edges else {
            let mut forces = std::mem::take(&mut d.work.fluid);
            ellipsoids(m, d, b, &mut forces);
            d.work.fluid = forces;
            continue;
        };
        let medium = Medium {
            xipos: &d.xipos,
            ximat: &d.ximat,
            subtree_com: &d.subtree_com,
            cvel: &d.cvel,
            cdof: &d.cdof,
            fluid: &mut d.work.fluid,
        };
        box_in_medium::<f64>(m, (), (b, edges), medium);
    }
}

/// The arrays that the fluid forces depend on, and these forces, of one world or of several.
pub(in crate::physics) struct Medium<'a, C> {
    pub(in crate::physics) xipos: &'a [[C; 3]],
    pub(in crate::physics) ximat: &'a [[C; 9]],
    pub(in crate::physics) subtree_com: &'a [[C; 3]],
    pub(in crate::physics) cvel: &'a [[C; 6]],
    pub(in crate::physics) cdof: &'a [[C; 6]],
    pub(in crate::physics) fluid: &'a mut [C],
}

/// Adds the fluid forces on a body that is approximated by a box.
#[inline(always)]
pub(in crate::physics) fn box_in_medium<N: Number>(
    m: &Model,
    at: N::At,
    (b, edges): (usize, [f64; 3]),
    medium: Medium<'_, N::Cell>,
) {
    let (density, viscosity, fluid) = (m.opt.density, m.opt.viscosity, medium.fluid);
    let mat = &get::<N, 9>(at, &medium.ximat[b]);
    let com = &medium.subtree_com[m.body_rootid[b]];
    let offset = sub(get::<N, 3>(at, &medium.xipos[b]), get(at, com));
    let velocity = get::<N, 6>(at, &medium.cvel[b]);
    let w = rotate_back(mat, rotation(&velocity));
    let v = rotate_back(mat, velocity_at(&velocity, offset));
    let v = sub(v, rotate_back(mat, m.opt.wind));

    let (mut torque, mut force) = (of::<N, 3>(at, [0.0; 3]), of::<N, 3>(at, [0.0; 3]));
    if viscosity > 0.0 {
        let diameter = (edges[0] + edges[1] + edges[2]) / 3.0;
        torque = scale(w, -PI * diameter * diameter * diameter * viscosity);
        force = scale(v, -3.0 * PI * diameter * viscosity);
    }
    if density > 0.0 {
        for (k, [i, j]) in [[1, 2], [0, 2], [0, 1]].into_iter().enumerate() {
            let (a, c) = (edges[i], edges[j]);
            force[k] = force[k] - v[k].abs() * (0.5 * density * a * c) * v[k];
            let moment = density * edges[k] * (a * a * a * a + c * c * c * c);
            torque[k] = torque[k] - w[k].abs() * moment * w[k] * (1.0 / 64.0);
        }
    }
    let (torque, force) = (rotate(mat, torque), rotate(mat, force));
    for &dof in m.plan().chain(b) {
        let axis = get::<N, 6>(at, &medium.cdof[dof]);
        let moves = add(translation(&axis), cross(rotation(&axis), offset));
        let sum = N::get(at, &fluid[dof]) + dot(moves, force);
        (sum + dot(rotation(&axis), torque)).put(at, &mut fluid[dof]);
    }
}
