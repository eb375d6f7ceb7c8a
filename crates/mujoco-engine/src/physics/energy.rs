//! Potential and kinetic energy.

use super::inertia::multiply;
use super::passive::{polynomials, stretch};
use super::sleep;
use crate::math::dense::dot_slices;
use crate::math::spatial::{InTurn, Order, Pairwise, Vec3, dot, norm, sub};
use crate::model::{Disable, JointType, Options};
use crate::{Data, Model};

/// The potential energy of gravity and springs: MuJoCo's `mj_energyPos`.
pub(super) fn potential(m: &Model, d: &Data) -> f64 {
    let mut energy = 0.0;
    if !m.opt.disables(Disable::Gravity) {
        for b in 1..m.nbody() {
            energy -= m.body_mass[b] * dot(m.opt.gravity, d.xipos[b]);
        }
    }
    let sleeps = m.plan().sleeps && !m.revision.counts_resting_springs();
    for &j in &m.plan().springs {
        if sleeps && !d.work.tree_awake[m.dof_treeid[m.jnt_dofadr[j]]] {
            continue;
        }
        let (p, higher) = (m.jnt_qposadr[j], m.jnt_stiffnesspoly[j]);
        let spring = |x: f64| polynomials::energy(m.jnt_stiffness[j], higher, x);
        match m.jnt_type[j] {
            JointType::Free => {
                let three = |q: &[f64]| -> Vec3 { [q[p], q[p + 1], q[p + 2]] };
                let moved = sub(three(&d.qpos), three(&m.qpos_spring));
                energy += spring(norm(moved));
                energy += spring(turn(m, d, p + 3));
            }
            JointType::Ball => energy += spring(turn(m, d, p)),
            _ => energy += spring(d.qpos[p] - m.qpos_spring[p]),
        }
    }
    if !m.opt.disables(Disable::Spring) {
        for t in 0..m.ntendon() {
            if sleeps && sleep::tendon_rests(m, &d.work.tree_awake, t) {
                continue;
            }
            let x = stretch(d.ten_length[t], m.tendon_lengthspring[t]);
            energy += polynomials::energy(m.tendon_stiffness[t], m.tendon_stiffnesspoly[t], x);
        }
    }
    energy
}

/// The angle between the orientation at position index `p` and the spring's reference.
fn turn(m: &Model, d: &Data, p: usize) -> f64 {
    fn angle<O: Order>(now: [f64; 4], rest: [f64; 4]) -> f64 {
        norm(O::sub_quat(now, rest))
    }
    let quat = |q: &[f64]| [q[p], q[p + 1], q[p + 2], q[p + 3]];
    let (now, rest) = (quat(&d.qpos), quat(&m.qpos_spring));
    if m.revision.adds_in_pairs() {
        angle::<Pairwise>(now, rest)
    } else {
        angle::<InTurn>(now, rest)
    }
}

/// The kinetic energy, `v' M v / 2`: MuJoCo's `mj_energyVel`.
pub(super) fn kinetic(m: &Model, d: &mut Data) -> f64 {
    let work = &mut d.work;
    let momentum = &mut work.damper;
    multiply(m, &d.qm, &mut work.way, &d.qvel, momentum);
    0.5 * dot_slices(momentum, &d.qvel)
}

/// Computes potential and kinetic energy, and stores them in `energy`: MuJoCo's `mj_energyPos` and
/// `mj_energyVel`.
pub fn energy(m: &Model, d: &mut Data) -> [f64; 2] {
    d.energy = [potential(m, d), kinetic(m, d)];
    d.knows_energy = true;
    d.energy
}

/// Whether the model asks for its energy.
pub(super) fn computed(m: &Model) -> bool {
    m.opt.enables(Options::ENERGY)
}

/// Computes `energy`, if the model asks for it.
pub(super) fn update(m: &Model, d: &mut Data) {
    if computed(m) {
        energy(m, d);
    }
}
