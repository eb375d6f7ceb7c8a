//! Tests whether a model and a CPU can step several worlds together.

use fearless_simd::Level;

use super::{Derived, Stride, actuators, sensors};
use crate::model::{Cone, Equality, EqualityType, Integrator, JointType, Solver};
use crate::{CompiledModel, Model};

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

/// Whether worlds of this model can step together. The stages of this module support slides, hinges
/// and free joints, and motors and servos on joints and fixed tendons. Models whose
/// [rows](makes_rows) have stages solve together too; worlds of others solve one by one.
pub(crate) fn fits(m: &Model, stride: &Stride) -> bool {
    let plan = m.plan();
    let joints = (0..m.njnt()).all(|j| match m.jnt_type[j] {
        JointType::Slide | JointType::Hinge => true,
        JointType::Free => m.jnt_stiffness[j] == 0.0,
        JointType::Ball => false,
    });
    let of_bodies =
        |equality: &Equality| matches!(equality.kind, EqualityType::Connect | EqualityType::Weld);
    let between_sites = |tendon: usize| plan.paths.fixed[tendon] || actuators::is_plain(m, tendon);
    let pulls = plan.constraints.pulls_tendons();
    joints
        && !plan.sparse
        && m.ntree() > 0
        && m.na() == 0
        && matches!(m.opt.integrator, Integrator::Euler | Integrator::RK4)
        && !plan.constraints.equalities.iter().any(of_bodies)
        && (!pulls || (0..m.ntendon()).all(between_sites))
        // such tendons push bodies
        && !(plan.paths.fixed.contains(&false) && stride.reads.contains(&Derived::CfrcExt))
        && (plan.steady || plan.servos)
        && (stride.settles || !plan.measures)
        && sensors::fit(m, stride.sensors())
        && !plan.gravcomp
        && !plan.tendon_armature
        && !plan.polynomials
        && !plan.sleeps
        && !plan.adhesive
        && !plan.surfaces
        && actuators::fit(m)
        && plan.boxes.iter().all(|(_, edges)| edges.is_some())
}

/// Whether two models differ in the stiffness of joints, and in nothing else: worlds of one step together
/// with worlds of the other. Joints without springs in one have none in the other.
#[must_use]
pub fn differ_in_stiffness(a: &CompiledModel, b: &CompiledModel) -> bool {
    let mut both = a.jnt_stiffness.iter().zip(&b.jnt_stiffness);
    let same_springs = both.all(|(a, b)| (*a == 0.0) == (*b == 0.0));
    let alike = || {
        let mut twin = a.clone();
        twin.jnt_stiffness.clone_from(&b.jnt_stiffness);
        twin == *b
    };
    a.jnt_stiffness != b.jnt_stiffness && same_springs && alike()
}

/// Whether the constraint rows of several worlds are made together: limits of joints and tendons, and
/// contacts with pyramidal cones.
pub(super) fn makes_rows(m: &Model) -> bool {
    let plan = m.plan();
    let trees = match m.opt.solver {
        Solver::Newton => 64,
        Solver::PGS => 1,
        Solver::CG => 0,
    };
    (1..=trees).contains(&m.ntree())
        && m.opt.impratio == 1.0
        && m.opt.noslip_iterations == 0
        && plan.inequalities_only
        && plan
            .pairs
            .iter()
            .all(|pair| pair.dim <= 3 && pair.friction[0] == pair.friction[1])
}

/// Whether worlds make their rows one by one, and solve together. The rows of one kind must follow one
/// another, those of elliptic cones last: so all of a model's pairs have the same dimension.
pub(super) fn gathers(m: &Model) -> bool {
    let mut dims = m.plan().pairs.iter().map(|pair| pair.dim);
    let first = dims.next();
    !makes_rows(m)
        && m.opt.solver == Solver::Newton
        && m.ntree() <= 64
        && m.opt.noslip_iterations == 0
        && (m.opt.cone == Cone::Pyramidal || dims.all(|dim| Some(dim) == first))
}
