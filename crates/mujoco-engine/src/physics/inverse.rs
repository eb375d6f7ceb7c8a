//! Inverse dynamics: computes forces from accelerations.

use super::inertia::{mul_m, solve_m};
use super::passive::polynomials;
use super::{actuation, implicit, solver};
use crate::model::{Disable, Integrator};
use crate::{Data, Model};

/// Replaces `qacc`, the change of the velocity by a timestep of the model's integrator, by the
/// acceleration at its start: MuJoCo's `mj_discreteAcc`.
#[cold]
pub(super) fn make_continuous(m: &Model, d: &mut Data) {
    let acceleration = std::mem::take(&mut d.qacc);
    let forces = match m.opt.integrator {
        Integrator::Euler if is_damped(m) => {
            let mut forces = vec![0.0; m.nv()];
            mul_m(m, d, &acceleration, &mut forces);
            for (i, force) in forces.iter_mut().enumerate() {
                let slope = polynomials::slope(m.dof_damping[i], m.dof_dampingpoly[i], d.qvel[i]);
                *force += m.opt.timestep * slope * acceleration[i];
            }
            Some(forces)
        }
        Integrator::Implicit | Integrator::ImplicitFast => {
            actuation::clamp_controls(m, d);
            Some(implicit::multiply(m, d, &acceleration))
        }
        Integrator::Euler | Integrator::RK4 => None,
    };
    d.qacc = acceleration;
    if let Some(mut forces) = forces {
        solve_m(m, d, &mut forces);
        d.qacc = forces;
    }
}

/// Whether Euler's method is implicit in the damping of joints.
fn is_damped(m: &Model) -> bool {
    let linear = m.dof_damping.iter().any(|&damping| damping > 0.0);
    let damped = linear || m.dof_dampingpoly.iter().any(|poly| *poly != [0.0; 2]);
    let left_out = m.revision.leaves_out_disabled_dampers() && m.opt.disables(Disable::Damper);
    damped && !left_out && !m.opt.disables(Disable::EulerDamp)
}

/// Computes the constraint forces at `qacc`, then `qfrc_inverse`.
pub(super) fn forces(m: &Model, d: &mut Data) {
    solver::forces_at(m, d);
    solver::add_forces(m, d);
    let mut sum = std::mem::take(&mut d.qfrc_inverse);
    mul_m(m, d, &d.qacc, &mut sum);
    for (i, sum) in sum.iter_mut().enumerate() {
        *sum = d.qfrc_bias[i] + (*sum - d.qfrc_passive[i] - d.qfrc_constraint[i]);
    }
    d.qfrc_inverse = sum;
}
