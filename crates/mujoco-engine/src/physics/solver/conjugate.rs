//! Conjugate gradients, preconditioned by the inertia matrix: MuJoCo's `mj_solPrimal` for the
//! solver CG.

use super::buffers::Buffers;
use super::newton::{Problem, dot, norm, search, update};
use crate::math::dense::{Lanes, add_scaled, times};
use crate::math::spatial::MINVAL;

/// Takes steps along conjugate directions. Returns the number of steps.
#[inline(never)]
pub(super) fn iterate(problem: &Problem<'_>, b: &mut Buffers, scale: f64, tolerance: f64) -> usize {
    let n = problem.n;
    update(problem, b);
    precondition(problem, b);
    if f64::max(0.0, 0.5 * scale * dot(&b.grad, &b.mgrad, n)) < tolerance {
        return 0;
    }
    for (search, mgrad) in b.search.iter_mut().zip(&b.mgrad) {
        *search = times(*mgrad, -1.0);
    }
    let mut iteration = 0;
    while iteration < problem.m.opt.iterations {
        let (alpha, gain) = search(problem, b, scale);
        if alpha == 0.0 {
            break;
        }
        add_scaled(&mut b.acc, &b.search, alpha);
        add_scaled(&mut b.ma, &b.mv, alpha);
        for (jar, jv) in b.jar.iter_mut().zip(&b.jv) {
            *jar += jv * alpha;
        }
        b.grad_before.copy_from_slice(&b.grad);
        b.mgrad_before.copy_from_slice(&b.mgrad);
        update(problem, b);
        precondition(problem, b);
        iteration += 1;
        let improvement = scale * gain;
        let level = scale * norm(&b.grad, n) < tolerance;
        if (improvement > 0.0 && improvement < tolerance) || level {
            break;
        }
        let beta = conjugate(b, n);
        for (search, mgrad) in b.search.iter_mut().zip(&b.mgrad) {
            *search = std::array::from_fn(|k| -mgrad[k] + beta * search[k]);
        }
    }
    iteration
}

/// Computes `mgrad`, the gradient times the inverse of the inertia matrix.
fn precondition(problem: &Problem<'_>, b: &mut Buffers) {
    b.mgrad.copy_from_slice(&b.grad);
    for (dofs, place) in problem.places() {
        let x = &mut b.mgrad.as_flattened_mut()[place];
        problem.solve_tree(&dofs, &mut b.way, x);
    }
}

/// Returns the factor by which the next search direction contains the last search direction: the
/// rule of Hager and Zhang.
fn conjugate(b: &mut Buffers, n: usize) -> f64 {
    const ETA: f64 = 0.01;
    let subtract = |from: &mut [Lanes], now: &[Lanes]| {
        for (before, now) in from.iter_mut().zip(now) {
            *before = std::array::from_fn(|k| now[k] - before[k]);
        }
    };
    subtract(&mut b.grad_before, &b.grad);
    subtract(&mut b.mgrad_before, &b.mgrad);
    let (change, solved) = (&b.grad_before, &b.mgrad_before);
    let along = dot(&b.search, change, n);
    if along < MINVAL {
        return 0.0;
    }
    let square = dot(change, solved, n);
    let across = dot(change, &b.mgrad, n);
    let slope = dot(&b.search, &b.grad, n);
    let beta = (across - 2.0 * (square / along) * slope) / along;
    let least = norm(&b.search, n) * f64::min(ETA, norm(&b.grad, n));
    f64::max(-1.0 / f64::max(MINVAL, least), beta)
}
