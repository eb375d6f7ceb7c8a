//! Inverse dynamics: computes forces from accelerations.

use super::inertia::mul_m;
use super::solver;
use crate::{Data, Model};

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
