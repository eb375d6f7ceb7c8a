//! Random draws that starts of tasks share.

use gym_sim::Rng;

/// Adds `uniform(-scale, scale)` to each of `numbers`.
pub(crate) fn uniform_noise(numbers: &mut [f64], scale: f64, rng: &mut Rng) {
    for x in numbers {
        *x += rng.uniform(-scale, scale);
    }
}

/// Adds `scale * standard_normal()` to each of `numbers`.
pub(crate) fn normal_noise(numbers: &mut [f64], scale: f64, rng: &mut Rng) {
    for x in numbers {
        *x += scale * rng.standard_normal();
    }
}
