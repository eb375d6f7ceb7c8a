//! Tests whether a model and a CPU can step several worlds together.

use fearless_simd::Level;

use super::{Stride, actuators, sensors};
use crate::Model;
use crate::model::{Integrator, JointType, Solver};

/// Returns the number of worlds per vector register. Returns `None` if the CPU has no fused
/// multiply-add or fewer than four numbers per register, or without the feature `lanes`.
pub(crate) fn width(level: Level) -> Option<usize> {
    #[cfg(all(feature = "lanes", any(target_arch = "x86", target_arch = "x86_64")))]
    {
        if level.as_avx512().is_some() {
            return Some(8);
        }
        if level.as_avx2().is_some() {
            return Some(4);
        }
    }
    let _ = level;
    None
}

/// Whether worlds of this model can step together. The stages of this module support one tree of
/// slides and hinges, optionally on a free joint, motors and servos on joints and fixed tendons,
/// limits, and contacts with pyramidal cones.
pub(crate) fn fits(m: &Model, stride: &Stride) -> bool {
    let plan = m.plan();
    let joints = (0..m.njnt()).all(|j| match m.jnt_type[j] {
        JointType::Slide | JointType::Hinge => true,
        JointType::Free => m.jnt_stiffness[j] == 0.0,
        JointType::Ball => false,
    });
    let bounds = plan.bounds();
    joints
        && !plan.sparse
        && m.ntree() == 1
        && m.na() == 0
        && matches!(m.opt.solver, Solver::Newton | Solver::PGS)
        && matches!(m.opt.integrator, Integrator::Euler | Integrator::RK4)
        && m.opt.impratio == 1.0
        && m.opt.noslip_iterations == 0
        && plan.inequalities_only
        && (plan.steady || plan.servos)
        && (stride.settles || !plan.measures)
        && sensors::fit(m, stride.sensors())
        && !plan.gravcomp
        && !plan.tendon_armature
        && !plan.surfaces
        && actuators::fit(m)
        && plan.constraints.tendon_limits.is_empty()
        && plan.boxes.iter().all(|(_, edges)| edges.is_some())
        && plan
            .pairs
            .iter()
            .all(|pair| pair.dim <= 3 && pair.friction[0] == pair.friction[1])
        && (!bounds.exceeded || m.opt.solver == Solver::PGS)
}
