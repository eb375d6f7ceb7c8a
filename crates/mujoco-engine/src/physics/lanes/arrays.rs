//! The arrays that the stages of all worlds read and write.

use super::actuators;
use super::per_world::{PerWorld, WORLDS};
use crate::Model;

/// The arrays of the stages, as in [`Data`](crate::Data).
macro_rules! arrays {
    ($($name:ident: $type:ty = ($zero:expr, $length:expr),)+) => {
        /// The arrays of all worlds, named as in [`Data`](crate::Data).
        #[derive(Clone, Debug, Default)]
        pub(crate) struct Arrays {
            $(pub(crate) $name: Vec<$type>,)+
        }

        impl Arrays {
            fn zeros(m: &Model) -> Self {
                $(let $name: fn(&Model) -> usize = $length;)+
                Self { $($name: vec![$zero; $name(m)],)+ }
            }

            /// Fills with NaN what a step has written. (A few elements are the same in every state,
            /// and never written.)
            #[cfg(test)]
            pub(super) fn poison(&mut self, m: &Model) {
                use crate::physics::work::Poison;
                let fresh = Self::new(m);
                $(for (now, unwritten) in self.$name.iter_mut().zip(&fresh.$name) {
                    if format!("{now:?}") != format!("{unwritten:?}") {
                        now.poison();
                    }
                })+
            }
        }
    };
}

arrays! {
    qpos: PerWorld = (PerWorld::ZERO, |m| m.nq()),
    qvel: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    // of the joints that have springs: worlds may differ in it
    stiffness: PerWorld = (PerWorld::ZERO, |m| m.plan().springs.len()),
    mocap_pos: [PerWorld; 3] = ([PerWorld::ZERO; 3], |m| m.nmocap()),
    mocap_quat: [PerWorld; 4] = ([ONE, PerWorld::ZERO, PerWorld::ZERO, PerWorld::ZERO], |m| m.nmocap()),
    warm: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    // the state at the start of the last step
    qpos_before: PerWorld = (PerWorld::ZERO, |m| m.nq()),
    qvel_before: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    warm_before: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    xpos: [PerWorld; 3] = ([PerWorld::ZERO; 3], |m| m.nbody()),
    xquat: [PerWorld; 4] = ([ONE, PerWorld::ZERO, PerWorld::ZERO, PerWorld::ZERO], |m| m.nbody()),
    xmat: [PerWorld; 9] = (IDENTITY, |m| m.nbody()),
    xipos: [PerWorld; 3] = ([PerWorld::ZERO; 3], |m| m.nbody()),
    ximat: [PerWorld; 9] = (IDENTITY, |m| m.nbody()),
    xanchor: [PerWorld; 3] = ([PerWorld::ZERO; 3], |m| m.njnt()),
    xaxis: [PerWorld; 3] = ([PerWorld::ZERO; 3], |m| m.njnt()),
    geom_xpos: [PerWorld; 3] = ([PerWorld::ZERO; 3], |m| m.ngeom()),
    geom_xmat: [PerWorld; 9] = (IDENTITY, |m| m.ngeom()),
    site_xpos: [PerWorld; 3] = ([PerWorld::ZERO; 3], |m| m.nsite()),
    site_xmat: [PerWorld; 9] = (IDENTITY, |m| m.nsite()),
    subtree_com: [PerWorld; 3] = ([PerWorld::ZERO; 3], |m| m.nbody()),
    cinert: [PerWorld; 10] = ([PerWorld::ZERO; 10], |m| m.nbody()),
    crb: [PerWorld; 10] = ([PerWorld::ZERO; 10], |m| m.nbody()),
    cdof: [PerWorld; 6] = ([PerWorld::ZERO; 6], |m| m.nv()),
    cdof_dot: [PerWorld; 6] = ([PerWorld::ZERO; 6], |m| m.nv()),
    cvel: [PerWorld; 6] = ([PerWorld::ZERO; 6], |m| m.nbody()),
    acc: [PerWorld; 6] = ([PerWorld::ZERO; 6], |m| m.nbody()),
    force: [PerWorld; 6] = ([PerWorld::ZERO; 6], |m| m.nbody()),
    qm: PerWorld = (PerWorld::ZERO, |m| m.plan().m_colind.len()),
    qld: PerWorld = (PerWorld::ZERO, |m| m.plan().m_colind.len()),
    qld_diag_inv: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    qh: PerWorld = (PerWorld::ZERO, |m| m.plan().m_colind.len()),
    qh_diag_inv: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    qfrc_bias: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    qfrc_passive: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    qfrc_actuator: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    qfrc_smooth: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    qfrc_constraint: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    qacc_smooth: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    qacc: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    cfrc_ext: [PerWorld; 6] = ([PerWorld::ZERO; 6], |m| m.nbody()),
    fluid: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    ten_length: PerWorld = (PerWorld::ZERO, |m| if actuators::can_measure_tendons(m) { m.ntendon() } else { 0 }),
    ten_velocity: PerWorld = (PerWorld::ZERO, |m| if actuators::can_measure_tendons(m) { m.ntendon() } else { 0 }),
    sensordata: PerWorld = (PerWorld::ZERO, |m| m.nsensordata()),
    // controls of actuators whose forces also follow from positions
    input: PerWorld = (PerWorld::ZERO, |m| actuators::inputs(m)),
    // buffers of the integrators
    acc_sum: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    vel_sum: PerWorld = (PerWorld::ZERO, |m| m.nv()),
    rates: PerWorld = (PerWorld::ZERO, |m| m.nv()),
}

impl Arrays {
    /// The arrays of worlds whose joints are as stiff as the model's.
    pub(super) fn new(m: &Model) -> Self {
        let mut arrays = Self::zeros(m);
        for (row, &j) in arrays.stiffness.iter_mut().zip(&m.plan().springs) {
            *row = PerWorld([m.jnt_stiffness[j]; WORLDS]);
        }
        arrays
    }
}

const ONE: PerWorld = PerWorld([1.0; WORLDS]);
const IDENTITY: [PerWorld; 9] = [
    ONE,
    PerWorld::ZERO,
    PerWorld::ZERO,
    PerWorld::ZERO,
    ONE,
    PerWorld::ZERO,
    PerWorld::ZERO,
    PerWorld::ZERO,
    ONE,
];
