//! Velocities of bodies, and the forces that follow from them: Coriolis, centrifugal,
//! gravitational.

use std::ops::Range;

use crate::math::number::{self, Number, get, put};
use crate::math::spatial::{add_to, cross_force, cross_motion, dot6, mul_inertia};
use crate::model::JointType;
use crate::{Data, Model};

/// The arrays that these stages read and write, of one world or of several.
pub(crate) struct Motion<'a, C> {
    pub(crate) qvel: &'a [C],
    pub(crate) cdof: &'a [[C; 6]],
    pub(crate) cvel: &'a mut [[C; 6]],
    pub(crate) cdof_dot: &'a mut [[C; 6]],
}

/// Computes `cvel` and `cdof_dot`: MuJoCo's `mj_comVel`.
#[inline(always)]
pub fn com_vel(m: &Model, d: &mut Data) {
    let motion = Motion {
        qvel: &d.qvel,
        cdof: &d.cdof,
        cvel: &mut d.cvel,
        cdof_dot: &mut d.cdof_dot,
    };
    com_vel_of::<f64>(m, (), motion);
}

/// [`com_vel`] for one world or several.
#[inline(always)]
pub(crate) fn com_vel_of<N: Number>(m: &Model, at: N::At, motion: Motion<'_, N::Cell>) {
    let plan = m.plan();
    let (qvel, cdof, cdof_dot) = (motion.qvel, motion.cdof, motion.cdof_dot);
    let cvel = &mut motion.cvel[..plan.bodies.len()];
    for (b, body) in plan.bodies.iter().enumerate().skip(1) {
        let mut vel = get::<N, 6>(at, &cvel[body.parent]);
        for joint in &plan.joints[body.joints.clone()] {
            let mut i = joint.dof;
            let free = joint.kind == JointType::Free;
            if free {
                for dot in &mut cdof_dot[i..i + 3] {
                    put(at, number::of::<N, 6>(at, [0.0; 6]), dot);
                }
                add_to(&mut vel, &along::<N>(at, cdof, qvel, i..i + 3), 1.0);
                i += 3;
            }
            if free || joint.kind == JointType::Ball {
                for k in i..i + 3 {
                    let dot = cross_motion(&vel, &get(at, &cdof[k]));
                    put(at, dot, &mut cdof_dot[k]);
                }
                add_to(&mut vel, &along::<N>(at, cdof, qvel, i..i + 3), 1.0);
            } else {
                let axis = get(at, &cdof[i]);
                put(at, cross_motion(&vel, &axis), &mut cdof_dot[i]);
                add_to(&mut vel, &axis, N::get(at, &qvel[i]));
            }
        }
        put(at, vel, &mut cvel[b]);
    }
}

/// The sum of motion axes, each times its velocity: MuJoCo's `mju_mulDofVec`.
#[inline(always)]
pub(super) fn along<N: Number>(
    at: N::At,
    axes: &[[N::Cell; 6]],
    velocities: &[N::Cell],
    dofs: Range<usize>,
) -> [N; 6] {
    if dofs.len() == 1 {
        // without a sum that starts at 0: a product may be -0
        let rate = N::get(at, &velocities[dofs.start]);
        return get::<N, 6>(at, &axes[dofs.start]).map(
            #[inline(always)]
            |x| x * rate,
        );
    }
    let mut sum = number::of(at, [0.0; 6]);
    for (axis, velocity) in axes[dofs.clone()].iter().zip(&velocities[dofs]) {
        add_to(&mut sum, &get(at, axis), N::get(at, velocity));
    }
    sum
}

/// The joints of a body.
pub(super) fn joints(m: &Model, body: usize) -> Range<usize> {
    m.plan().bodies[body].joints.clone()
}

/// The degrees of freedom of a body.
pub(crate) fn dofs(m: &Model, body: usize) -> Range<usize> {
    m.plan().bodies[body].dofs.clone()
}

/// The arrays of the bias forces, of one world or of several.
pub(crate) struct Bias<'a, C> {
    pub(crate) qvel: &'a [C],
    pub(crate) cinert: &'a [[C; 10]],
    pub(crate) cdof: &'a [[C; 6]],
    pub(crate) cvel: &'a [[C; 6]],
    pub(crate) cdof_dot: &'a [[C; 6]],
    /// Buffers: accelerations of bodies, and forces on them.
    pub(crate) acc: &'a mut [[C; 6]],
    pub(crate) force: &'a mut [[C; 6]],
    pub(crate) qfrc_bias: &'a mut [C],
}

/// Computes `qfrc_bias` by recursive Newton-Euler at zero acceleration: MuJoCo's `mj_rne`.
#[inline(always)]
pub fn rne(m: &Model, d: &mut Data) {
    let bias = Bias {
        qvel: &d.qvel,
        cinert: &d.cinert,
        cdof: &d.cdof,
        cvel: &d.cvel,
        cdof_dot: &d.cdof_dot,
        acc: &mut d.work.acc,
        force: &mut d.work.body_force,
        qfrc_bias: &mut d.qfrc_bias,
    };
    rne_of::<f64>(m, (), bias);
}

/// [`rne`] for one world or several.
#[inline(always)]
pub(crate) fn rne_of<N: Number>(m: &Model, at: N::At, bias: Bias<'_, N::Cell>) {
    // slices of equal length let the compiler check an index once for all of them
    let (n, nv) = (m.nbody(), m.nv());
    let (acc, force) = (&mut bias.acc[..n], &mut bias.force[..n]);
    let bodies = &m.plan().bodies[..n];
    let (cinert, cvel) = (&bias.cinert[..n], &bias.cvel[..n]);
    let (cdof_dot, qvel) = (&bias.cdof_dot[..nv], &bias.qvel[..nv]);
    let [x, y, z] = m.plan().gravity;
    let falling = number::of::<N, 6>(at, [0.0, 0.0, 0.0, -x, -y, -z]);
    put(at, falling, &mut acc[0]);
    put(at, number::of::<N, 6>(at, [0.0; 6]), &mut force[0]);
    for b in 1..n {
        let own = bodies[b].dofs.clone();
        let mut a = get::<N, 6>(at, &acc[bodies[b].parent]);
        if own.len() == 1 {
            let dot = get(at, &cdof_dot[own.start]);
            add_to(&mut a, &dot, N::get(at, &qvel[own.start]));
        } else {
            add_to(&mut a, &along::<N>(at, cdof_dot, qvel, own), 1.0);
        }
        put(at, a, &mut acc[b]);
        let (inertia, vel) = (get::<N, 10>(at, &cinert[b]), get::<N, 6>(at, &cvel[b]));
        let mut f = mul_inertia(&inertia, &a);
        let momentum = mul_inertia(&inertia, &vel);
        add_to(&mut f, &cross_force(&vel, &momentum), 1.0);
        put(at, f, &mut force[b]);
    }
    for b in (1..n).rev() {
        let mut sum = get::<N, 6>(at, &force[bodies[b].parent]);
        add_to(&mut sum, &get::<N, 6>(at, &force[b]), 1.0);
        put(at, sum, &mut force[bodies[b].parent]);
    }
    let qfrc_bias = bias.qfrc_bias;
    let axes = qfrc_bias.iter_mut().zip(bias.cdof);
    for ((out, axis), &b) in axes.zip(&m.dof_bodyid) {
        dot6(&get::<N, 6>(at, axis), &get(at, &force[b])).put(at, out);
    }
}
