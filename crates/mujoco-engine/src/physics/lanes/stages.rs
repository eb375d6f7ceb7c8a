//! The smooth stages, for the worlds in a register.

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use super::{Arrays, At, PerWorld, copy, load, same, store, tree};
use crate::Model;
use crate::model::JointType;
use crate::physics::com::{Inertias, com_pos_of};
use crate::physics::inertia::{Composite, crb_of};
use crate::physics::integrate::rate_of_turn;
use crate::physics::kinematics::{Frames, kinematics_of};
use crate::physics::passive::{Medium, box_in_medium, damper_force, spring_force};
use crate::physics::velocity::{Bias, Motion, com_vel_of, rne_of};

impl Arrays {
    /// Computes frames and inertias; `whole` as in [`frames`](Self::frames).
    #[inline(always)]
    pub(super) fn positions<S: Simd>(&mut self, m: &Model, at: At<S>, whole: bool) {
        self.frames(m, at, whole);
        self.inertias(m, at);
    }

    /// Computes frames. If `whole` is false, computes only the frames that later stages read.
    #[inline(always)]
    pub(super) fn frames<S: Simd>(&mut self, m: &Model, at: At<S>, whole: bool) {
        let frames = Frames {
            qpos: &self.qpos,
            mocap_pos: &self.mocap_pos,
            mocap_quat: &self.mocap_quat,
            xpos: &mut self.xpos,
            xquat: &mut self.xquat,
            xmat: &mut self.xmat,
            xipos: &mut self.xipos,
            ximat: &mut self.ximat,
            xanchor: &mut self.xanchor,
            xaxis: &mut self.xaxis,
            geom_xpos: &mut self.geom_xpos,
            geom_xmat: &mut self.geom_xmat,
            site_xpos: &mut self.site_xpos,
            site_xmat: &mut self.site_xmat,
        };
        kinematics_of::<Lanes<S>>(m, at, frames, whole);
    }

    /// Computes inertias about the trees' centres of mass.
    #[inline(always)]
    pub(super) fn inertias<S: Simd>(&mut self, m: &Model, at: At<S>) {
        let inertias = Inertias {
            xmat: &self.xmat,
            xipos: &self.xipos,
            ximat: &self.ximat,
            xanchor: &self.xanchor,
            xaxis: &self.xaxis,
            subtree_com: &mut self.subtree_com,
            cinert: &mut self.cinert,
            cdof: &mut self.cdof,
        };
        com_pos_of::<Lanes<S>>(m, at, inertias, |_| false);
    }

    /// Computes the inertia matrix and its factors.
    #[inline(always)]
    pub(super) fn matrix<S: Simd>(&mut self, m: &Model, at: At<S>) {
        let composite = Composite {
            cinert: &self.cinert,
            cdof: &self.cdof,
            crb: &mut self.crb,
            qm: &mut self.qm,
        };
        crb_of::<Lanes<S>>(
            m,
            at,
            composite,
            #[inline(always)]
            |_, _, _| false,
        );
        copy(at, &self.qm, &mut self.qld);
        let own = (&mut self.qld[..], &mut self.qld_diag_inv[..]);
        if !m.plan().implicit {
            tree::factor(m, at, [own]);
            return;
        }
        copy(at, &self.qm, &mut self.qh);
        for i in 0..m.nv() {
            let diagonal = &mut self.qh[m.plan().m_diagonal(i)];
            let damped = load::<S>(at, diagonal) + m.opt.timestep * m.dof_damping[i];
            store(at, diagonal, damped);
        }
        let damped = (&mut self.qh[..], &mut self.qh_diag_inv[..]);
        tree::factor(m, at, [own, damped]);
    }

    /// Computes velocities, the forces that depend on them, and the accelerations without
    /// constraints.
    #[inline(always)]
    pub(super) fn velocities<S: Simd>(&mut self, m: &Model, at: At<S>) {
        self.motions(m, at);
        let bias = Bias {
            qvel: &self.qvel,
            cinert: &self.cinert,
            cdof: &self.cdof,
            cvel: &self.cvel,
            cdof_dot: &self.cdof_dot,
            acc: &mut self.acc,
            force: &mut self.force,
            qfrc_bias: &mut self.qfrc_bias,
        };
        rne_of::<Lanes<S>>(m, at, bias);
        self.tendons(m, at);
        self.passive(m, at);
        if !m.plan().steady {
            self.actuate(m, at);
        }
        for i in 0..m.nv() {
            let passive = load::<S>(at, &self.qfrc_passive[i]);
            let free = passive - load(at, &self.qfrc_bias[i]) + load(at, &self.qfrc_actuator[i]);
            store(at, &mut self.qfrc_smooth[i], free);
            store(at, &mut self.qacc_smooth[i], free);
        }
        let (factors, inverses) = (&self.qld, &self.qld_diag_inv);
        tree::solve(m, at, factors, inverses, &mut self.qacc_smooth);
    }

    /// Computes the velocities of bodies.
    #[inline(always)]
    pub(super) fn motions<S: Simd>(&mut self, m: &Model, at: At<S>) {
        let motion = Motion {
            qvel: &self.qvel,
            cdof: &self.cdof,
            cvel: &mut self.cvel,
            cdof_dot: &mut self.cdof_dot,
        };
        com_vel_of::<Lanes<S>>(m, at, motion);
    }

    /// Computes the forces of springs and dampers.
    #[inline(always)]
    fn passive<S: Simd>(&mut self, m: &Model, at: At<S>) {
        let plan = m.plan();
        for force in &mut self.qfrc_passive {
            store(at, force, same::<S>(at, 0.0));
        }
        if !plan.passive {
            return;
        }
        for (&j, stiffness) in plan.springs.iter().zip(&self.stiffness) {
            let (p, i) = (m.jnt_qposadr[j], m.jnt_dofadr[j]);
            let (q, rest) = (load::<S>(at, &self.qpos[p]), m.qpos_spring[p]);
            let force = spring_force(q, rest, load::<S>(at, stiffness));
            store(at, &mut self.qfrc_passive[i], force);
        }
        self.add_tendon_springs(m, at);
        for (i, force) in self.qfrc_passive.iter_mut().enumerate() {
            let damper = damper_force(at, load::<S>(at, &self.qvel[i]), plan.damping[i]);
            store(at, force, load::<S>(at, force) + damper);
        }
        if plan.boxes.is_empty() {
            return;
        }
        for force in &mut self.fluid {
            store(at, force, same::<S>(at, 0.0));
        }
        for &(b, edges) in &plan.boxes {
            let medium = Medium {
                xipos: &self.xipos,
                ximat: &self.ximat,
                subtree_com: &self.subtree_com,
                cvel: &self.cvel,
                cdof: &self.cdof,
                fluid: &mut self.fluid,
            };
            box_in_medium::<Lanes<S>>(m, at, (b, edges.unwrap_or_default()), medium);
        }
        for (force, fluid) in self.qfrc_passive.iter_mut().zip(&self.fluid) {
            store(at, force, load::<S>(at, force) + load::<S>(at, fluid));
        }
    }

    /// Computes the rates of change of the positions from the velocities of a Runge-Kutta stage,
    /// which is `way` seconds after the start of the timestep.
    #[inline(always)]
    pub(super) fn stage_rates<S: Simd>(&mut self, m: &Model, at: At<S>, way: f64) {
        let turns = m.revision.turns_by_stages() && way != 0.0;
        for (i, &j) in m.dof_jntid.iter().enumerate() {
            let place = i - m.jnt_dofadr[j];
            if !turns || m.jnt_type[j] != JointType::Free || place < 3 {
                let velocity = load::<S>(at, &self.qvel[i]);
                store(at, &mut self.rates[i], velocity);
                continue;
            }
            if place > 3 {
                continue;
            }
            // the new rates of turning depend on those of the stage before
            for world in at.1..at.1 + <Lanes<S> as Real>::LANES {
                let three = |rows: &[PerWorld]| [0, 1, 2].map(|k| rows[i + k].0[world]);
                let turn = three(&self.rates).map(|rate| rate * way);
                let turned = rate_of_turn(turn, three(&self.qvel));
                for (rate, turned) in self.rates[i..i + 3].iter_mut().zip(turned) {
                    rate.0[world] = turned;
                }
            }
        }
    }
}
