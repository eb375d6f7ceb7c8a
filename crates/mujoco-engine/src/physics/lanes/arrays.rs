//! The arrays that the stages of all worlds read and write.

use super::actuators;
use super::row::{Row, WORLDS};
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
            pub(super) fn new(m: &Model) -> Self {
                $(let $name: fn(&Model) -> usize = $length;)+
                Self { $($name: vec![$zero; $name(m)],)+ }
            }
        }
    };
}

arrays! {
    qpos: Row = (Row::ZERO, |m| m.nq()),
    qvel: Row = (Row::ZERO, |m| m.nv()),
    mocap_pos: [Row; 3] = ([Row::ZERO; 3], |m| m.nmocap()),
    mocap_quat: [Row; 4] = ([ONE, Row::ZERO, Row::ZERO, Row::ZERO], |m| m.nmocap()),
    warm: Row = (Row::ZERO, |m| m.nv()),
    // the state at the start of the last step
    qpos_before: Row = (Row::ZERO, |m| m.nq()),
    qvel_before: Row = (Row::ZERO, |m| m.nv()),
    warm_before: Row = (Row::ZERO, |m| m.nv()),
    xpos: [Row; 3] = ([Row::ZERO; 3], |m| m.nbody()),
    xquat: [Row; 4] = ([ONE, Row::ZERO, Row::ZERO, Row::ZERO], |m| m.nbody()),
    xmat: [Row; 9] = (IDENTITY, |m| m.nbody()),
    xipos: [Row; 3] = ([Row::ZERO; 3], |m| m.nbody()),
    ximat: [Row; 9] = (IDENTITY, |m| m.nbody()),
    xanchor: [Row; 3] = ([Row::ZERO; 3], |m| m.njnt()),
    xaxis: [Row; 3] = ([Row::ZERO; 3], |m| m.njnt()),
    geom_xpos: [Row; 3] = ([Row::ZERO; 3], |m| m.ngeom()),
    geom_xmat: [Row; 9] = (IDENTITY, |m| m.ngeom()),
    site_xpos: [Row; 3] = ([Row::ZERO; 3], |m| m.nsite()),
    site_xmat: [Row; 9] = (IDENTITY, |m| m.nsite()),
    subtree_com: [Row; 3] = ([Row::ZERO; 3], |m| m.nbody()),
    cinert: [Row; 10] = ([Row::ZERO; 10], |m| m.nbody()),
    crb: [Row; 10] = ([Row::ZERO; 10], |m| m.nbody()),
    cdof: [Row; 6] = ([Row::ZERO; 6], |m| m.nv()),
    cdof_dot: [Row; 6] = ([Row::ZERO; 6], |m| m.nv()),
    cvel: [Row; 6] = ([Row::ZERO; 6], |m| m.nbody()),
    acc: [Row; 6] = ([Row::ZERO; 6], |m| m.nbody()),
    force: [Row; 6] = ([Row::ZERO; 6], |m| m.nbody()),
    qm: Row = (Row::ZERO, |m| m.plan().m_colind.len()),
    qld: Row = (Row::ZERO, |m| m.plan().m_colind.len()),
    qld_diag_inv: Row = (Row::ZERO, |m| m.nv()),
    qh: Row = (Row::ZERO, |m| m.plan().m_colind.len()),
    qh_diag_inv: Row = (Row::ZERO, |m| m.nv()),
    qfrc_bias: Row = (Row::ZERO, |m| m.nv()),
    qfrc_passive: Row = (Row::ZERO, |m| m.nv()),
    qfrc_actuator: Row = (Row::ZERO, |m| m.nv()),
    qfrc_smooth: Row = (Row::ZERO, |m| m.nv()),
    qfrc_constraint: Row = (Row::ZERO, |m| m.nv()),
    qacc_smooth: Row = (Row::ZERO, |m| m.nv()),
    qacc: Row = (Row::ZERO, |m| m.nv()),
    cfrc_ext: [Row; 6] = ([Row::ZERO; 6], |m| m.nbody()),
    fluid: Row = (Row::ZERO, |m| m.nv()),
    ten_length: Row = (Row::ZERO, |m| if actuators::can_measure_tendons(m) { m.ntendon() } else { 0 }),
    ten_velocity: Row = (Row::ZERO, |m| if actuators::can_measure_tendons(m) { m.ntendon() } else { 0 }),
    sensordata: Row = (Row::ZERO, |m| m.nsensordata()),
    // controls of actuators whose forces also follow from positions
    input: Row = (Row::ZERO, |m| actuators::inputs(m)),
    // buffers of the integrators
    acc_sum: Row = (Row::ZERO, |m| m.nv()),
    vel_sum: Row = (Row::ZERO, |m| m.nv()),
    rates: Row = (Row::ZERO, |m| m.nv()),
}

const ONE: Row = Row([1.0; WORLDS]);
const IDENTITY: [Row; 9] = [
    ONE,
    Row::ZERO,
    Row::ZERO,
    Row::ZERO,
    ONE,
    Row::ZERO,
    Row::ZERO,
    Row::ZERO,
    ONE,
];
