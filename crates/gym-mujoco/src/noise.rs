//! Random draws that starts of tasks share.

use gym_sim::Rng;

/// Sets each of `numbers` to `initial + uniform(-scale, scale)`.
pub(crate) fn uniform_noise(numbers: &mut [f64], initial: &[f64], scale: f64, rng: &mut Rng) {
    for (x, x0) in numbers.iter_mut().zip(initial) {
        *x = x0 + rng.uniform(-scale, scale);
    }
}

/// Sets each of `numbers` to `0.0 + scale * standard_normal()`. The sum turns the `-0.0` of a zero
/// `scale` into `0.0`.
pub(crate) fn normal_noise(numbers: &mut [f64], scale: f64, rng: &mut Rng) {
    for x in numbers {
        *x = 0.0 + scale * rng.standard_normal();
    }
}

/// Sets each of `numbers` to `uniform(-scale, scale)`.
pub(crate) fn uniform_velocities(numbers: &mut [f64], scale: f64, rng: &mut Rng) {
    for x in numbers {
        *x = rng.uniform(-scale, scale);
    }
}
