//! Actuator forces and tendon springs that depend on positions: position servos, and springs of
//! fixed tendons.

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use super::{Arrays, At, load, same, store};
use crate::Model;
use crate::model::TransmissionType;

/// Iterates over the joints of a fixed tendon: the index of the joint in `qpos`, the index in
/// `qvel`, and the coefficient.
fn parts(m: &Model, tendon: usize) -> impl Iterator<Item = (usize, usize, f64)> {
    let first = m.tendon_adr[tendon];
    (first..first + m.tendon_num[tendon]).map(|w| {
        let joint = m.wrap_objid[w] as usize;
        (m.jnt_qposadr[joint], m.jnt_dofadr[joint], m.wrap_prm[w])
    })
}

/// Whether worlds that step together can compute the tendon springs of the model.
pub(super) fn fit(m: &Model) -> bool {
    let paths = &m.plan().paths;
    let still = |dof: usize| m.jnt_stiffness[m.dof_jntid[dof]] == 0.0;
    paths.elastic.iter().all(|&(tendon, _, damping)| {
        let row = paths.rows[tendon].clone();
        damping == 0.0
            && paths.fixed[tendon]
            && row.len() == m.tendon_num[tendon]
            && paths.columns[row].iter().all(|&dof| still(dof))
    })
}

/// Whether worlds that step together compute tendon lengths and velocities: all tendons are fixed,
/// with at most three joints each.
pub(super) fn can_measure_tendons(m: &Model) -> bool {
    let paths = &m.plan().paths;
    paths.fixed.iter().all(|&fixed| fixed) && paths.rows.iter().all(|row| row.len() < 4)
}

/// Returns the number of controls that a world stores: 0 if every actuator force depends on the
/// control only, because the record then has the forces.
pub(super) fn inputs(m: &Model) -> usize {
    if m.plan().steady { 0 } else { m.nu() }
}

impl Arrays {
    #[inline(always)]
    fn tendon_length<S: Simd>(&self, m: &Model, at: At<S>, tendon: usize) -> Lanes<S> {
        let mut length = same(at, 0.0);
        for (q, _, coefficient) in parts(m, tendon) {
            length = length + load::<S>(at, &self.qpos[q]) * coefficient;
        }
        length
    }

    /// Computes the lengths and velocities of the tendons.
    #[inline(always)]
    pub(super) fn tendons<S: Simd>(&mut self, m: &Model, at: At<S>) {
        let paths = &m.plan().paths;
        for t in 0..self.ten_length.len() {
            let length = self.tendon_length(m, at, t);
            store(at, &mut self.ten_length[t], length);
            let mut velocity = same(at, 0.0);
            for &column in &paths.columns[paths.rows[t].clone()] {
                let own = parts(m, t).filter(|&(_, dof, _)| dof == column);
                let moment: f64 = own.fold(0.0, |sum, (.., coefficient)| sum + coefficient);
                velocity = velocity + load::<S>(at, &self.qvel[column]) * moment;
            }
            store(at, &mut self.ten_velocity[t], velocity);
        }
    }

    /// Computes the actuator forces from controls and positions. Adding a force of zero changes no
    /// bit, because a sum that starts at zero is never -0.
    #[inline(always)]
    pub(super) fn actuate<S: Simd>(&mut self, m: &Model, at: At<S>) {
        for force in &mut self.qfrc_actuator {
            store(at, force, same::<S>(at, 0.0));
        }
        for i in 0..m.nu() {
            let (id, gear) = (m.actuator_trnid[i][0] as usize, m.actuator_gear[i][0]);
            let tendon = m.actuator_trntype[i] == TransmissionType::Tendon;
            let length = if tendon {
                self.tendon_length(m, at, id)
            } else {
                load::<S>(at, &self.qpos[m.jnt_qposadr[id]])
            };
            let bias = length * gear * m.actuator_biasprm[i].0[1] + 0.0;
            let force = load::<S>(at, &self.input[i]) + bias;
            let (push,) = (
                #[inline(always)]
                |row: &mut super::PerWorld, moment: f64| {
                    let sum = load::<S>(at, row) + force * moment;
                    store(at, row, sum);
                },
            );
            if tendon {
                for (_, dof, coefficient) in parts(m, id) {
                    push(&mut self.qfrc_actuator[dof], coefficient * gear);
                }
            } else {
                push(&mut self.qfrc_actuator[m.jnt_dofadr[id]], gear);
            }
        }
    }

    /// Adds the spring forces of tendons to `qfrc_passive`.
    #[inline(always)]
    pub(super) fn add_tendon_springs<S: Simd>(&mut self, m: &Model, at: At<S>) {
        for &(tendon, stiffness, _) in &m.plan().paths.elastic {
            let length = self.tendon_length(m, at, tendon);
            let [lower, upper] = m.tendon_lengthspring[tendon];
            let zero = same(at, 0.0);
            let below = Lanes::select(length.lt(same(at, lower)), length - lower, zero);
            let beyond = Lanes::select(length.gt(same(at, upper)), length - upper, below);
            let spring = -beyond * stiffness;
            for (_, dof, coefficient) in parts(m, tendon) {
                let row = &mut self.qfrc_passive[dof];
                let sum = load::<S>(at, row) + spring * coefficient;
                store(at, row, sum);
            }
        }
    }
}
