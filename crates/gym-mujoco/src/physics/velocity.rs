//! Velocities of bodies, and the forces that follow from them: Coriolis, centrifugal,
//! gravitational.

use super::spatial::{Vec6, add_to, cross_force, cross_motion, dot6, mul_inertia};
use crate::model::JointType;
use crate::{Data, Model};

/// `cvel` and `cdof_dot`: MuJoCo's `mj_comVel`.
#[inline(always)]
pub fn com_vel(m: &Model, d: &mut Data) {
    for b in 1..m.nbody() {
        let mut vel = d.cvel[m.body_parentid[b]];
        for j in joints(m, b) {
            let mut i = m.jnt_dofadr[j];
            let free = m.jnt_type[j] == JointType::Free;
            if free {
                d.cdof_dot[i..i + 3].fill([0.0; 6]);
                add_to(&mut vel, &along(&d.cdof[i..i + 3], &d.qvel[i..i + 3]), 1.0);
                i += 3;
            }
            if free || m.jnt_type[j] == JointType::Ball {
                for k in i..i + 3 {
                    d.cdof_dot[k] = cross_motion(&vel, &d.cdof[k]);
                }
                add_to(&mut vel, &along(&d.cdof[i..i + 3], &d.qvel[i..i + 3]), 1.0);
            } else {
                d.cdof_dot[i] = cross_motion(&vel, &d.cdof[i]);
                add_to(&mut vel, &d.cdof[i], d.qvel[i]);
            }
        }
        d.cvel[b] = vel;
    }
}

/// The sum of axes, each times its velocity, as one motion: MuJoCo's `mju_mulDofVec`.
#[inline(always)]
pub(super) fn along(axes: &[Vec6], velocities: &[f64]) -> Vec6 {
    let mut sum = [0.0; 6];
    for (axis, &velocity) in axes.iter().zip(velocities) {
        add_to(&mut sum, axis, velocity);
    }
    sum
}

/// The joints of a body.
pub(super) fn joints(m: &Model, body: usize) -> std::ops::Range<usize> {
    usize::try_from(m.body_jntadr[body]).map_or(0..0, |first| first..first + m.body_jntnum[body])
}

/// The degrees of freedom of a body.
pub(crate) fn dofs(m: &Model, body: usize) -> std::ops::Range<usize> {
    usize::try_from(m.body_dofadr[body]).map_or(0..0, |first| first..first + m.body_dofnum[body])
}

/// `qfrc_bias` by recursive Newton-Euler without accelerations: MuJoCo's `mj_rne`.
#[inline(always)]
pub fn rne(m: &Model, d: &mut Data) {
    let (acc, force) = (&mut d.work.acc, &mut d.work.body_force);
    // slices of one length: an index is checked once for all of them
    let (n, nv) = (m.nbody(), m.nv());
    let (acc, force, parents) = (&mut acc[..n], &mut force[..n], &m.body_parentid[..n]);
    let (cinert, cvel) = (&d.cinert[..n], &d.cvel[..n]);
    let (cdof_dot, qvel) = (&d.cdof_dot[..nv], &d.qvel[..nv]);
    let g = m.plan().gravity;
    acc[0] = [0.0, 0.0, 0.0, -g[0], -g[1], -g[2]];
    force[0] = [0.0; 6];
    for b in 1..n {
        let own = dofs(m, b);
        let mut a = acc[parents[b]];
        if own.len() == 1 {
            add_to(&mut a, &cdof_dot[own.start], qvel[own.start]);
        } else {
            add_to(&mut a, &along(&cdof_dot[own.clone()], &qvel[own]), 1.0);
        }
        acc[b] = a;
        let mut f = mul_inertia(&cinert[b], &a);
        let momentum = mul_inertia(&cinert[b], &cvel[b]);
        add_to(&mut f, &cross_force(&cvel[b], &momentum), 1.0);
        force[b] = f;
    }
    for b in (1..n).rev() {
        let f = force[b];
        add_to(&mut force[parents[b]], &f, 1.0);
    }
    for ((bias, cdof), &b) in d.qfrc_bias.iter_mut().zip(&d.cdof).zip(&m.dof_bodyid) {
        *bias = dot6(cdof, &force[b]);
    }
}
