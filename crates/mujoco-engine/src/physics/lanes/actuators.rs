//! Actuator forces and tendon springs that depend on positions: position servos, and springs of
//! fixed tendons.

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use super::rows::Moved;
use super::{Arrays, At, PerWorld, load, same, store};
use crate::Model;
use crate::math::number;
use crate::math::spatial::{add, cross, dot, rotation, sub, translation, unit};
use crate::model::{TransmissionType, WrapType};

/// Iterates over the joints of a fixed tendon: the index of the joint in `qpos`, the index in
/// `qvel`, and the coefficient.
fn parts(m: &Model, tendon: usize) -> impl Iterator<Item = (usize, usize, f64)> {
    let first = m.tendon_adr[tendon];
    (first..first + m.tendon_num[tendon]).map(|w| {
        let joint = m.wrap_objid[w] as usize;
        (m.jnt_qposadr[joint], m.jnt_dofadr[joint], m.wrap_prm[w])
    })
}

/// Returns the moment arm of a fixed tendon for a degree of freedom.
fn moment(m: &Model, tendon: usize, column: usize) -> f64 {
    let own = parts(m, tendon).filter(|&(_, dof, _)| dof == column);
    own.fold(0.0, |sum, (.., coefficient)| sum + coefficient)
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

/// Whether a tendon passes sites only.
pub(super) fn is_plain(m: &Model, tendon: usize) -> bool {
    let first = m.tendon_adr[tendon];
    let parts = &m.wrap_type[first..first + m.tendon_num[tendon]];
    parts.iter().all(|part| *part == WrapType::Site)
}

impl Arrays {
    /// Returns the length of a tendon, which is fixed or passes sites only.
    #[inline(always)]
    pub(super) fn tendon_length<S: Simd>(&self, m: &Model, at: At<S>, tendon: usize) -> Lanes<S> {
        let mut length = same(at, 0.0);
        if !m.plan().paths.fixed[tendon] {
            let first = m.tendon_adr[tendon];
            let sites = &m.wrap_objid[first..first + m.tendon_num[tendon]];
            for ends in sites.windows(2) {
                let [begin, end] = [ends[0], ends[1]].map(
                    #[inline(always)]
                    |site| number::get::<Lanes<S>, 3>(at, &self.site_xpos[site as usize]),
                );
                let apart = sub(begin, end);
                length = length + dot(apart, apart).sqrt();
            }
            return length;
        }
        for (q, _, coefficient) in parts(m, tendon) {
            length = length + load::<S>(at, &self.qpos[q]) * coefficient;
        }
        length
    }

    /// Appends the degrees of freedom that move a tendon, which is fixed or passes sites only, each
    /// with its moment arm.
    #[inline(always)]
    pub(super) fn tendon_arms<S: Simd>(
        &self,
        m: &Model,
        at: At<S>,
        tendon: usize,
        arms: &mut Moved,
    ) {
        let (paths, plan) = (&m.plan().paths, m.plan());
        let first = m.tendon_adr[tendon];
        let sites = &m.wrap_objid[first..first + m.tendon_num[tendon]];
        for &column in &paths.columns[paths.rows[tendon].clone()] {
            let mut arm: Lanes<S> = same(at, 0.0);
            if paths.fixed[tendon] {
                arm = same(at, moment(m, tendon, column));
            }
            let segments = if paths.fixed[tendon] {
                0
            } else {
                sites.len() - 1
            };
            for ends in sites.windows(2).take(segments) {
                let ends = [ends[0] as usize, ends[1] as usize];
                let bodies = ends.map(|site| m.site_bodyid[site]);
                let moves = bodies.map(|body| plan.chain(body).contains(&column));
                if bodies[0] == bodies[1] || moves == [false; 2] {
                    continue;
                }
                let points = ends.map(
                    #[inline(always)]
                    |site| number::get::<Lanes<S>, 3>(at, &self.site_xpos[site]),
                );
                let axis = number::get::<Lanes<S>, 6>(at, &self.cdof[column]);
                let (moved,) = (
                    #[inline(always)]
                    |k: usize| {
                        if !moves[k] {
                            return number::of(at, [0.0; 3]);
                        }
                        let com = &self.subtree_com[m.body_rootid[bodies[k]]];
                        let offset = sub(points[k], number::get(at, com));
                        add(translation(&axis), cross(rotation(&axis), offset))
                    },
                );
                let (direction, _) = unit(at, sub(points[1], points[0]));
                arm = arm + dot(sub(moved(1), moved(0)), direction);
            }
            let mut cells = [PerWorld::ZERO; 4];
            store(at, &mut cells[0], arm);
            arms.push((column, cells));
        }
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
                let moved = load::<S>(at, &self.qvel[column]) * moment(m, t, column);
                velocity = velocity + moved;
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
