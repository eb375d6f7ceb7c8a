//! Hand-written rules that play each task well.

use gym_core::math::atan2;

/// Pushes to the side given by the sign of a weighted sum of the state: a linear controller.
pub(crate) fn cartpole([x, x_dot, theta, theta_dot]: &[f32; 4]) -> i64 {
    i64::from(x + 1.6 * x_dot + 18.0 * theta + 3.0 * theta_dot > 0.0)
}

/// Drives right while the velocity is between two curves over the position, otherwise left (Zhiqing
/// Xiao, *Reinforcement Learning: Theory and Python Implementation*, 2024).
pub(crate) fn mountain_car([position, velocity]: &[f32; 2]) -> i64 {
    let x = *position;
    let low = (-0.09 * (x + 0.25).powi(2) + 0.03).min(0.3 * (x + 0.9).powi(4) - 0.008);
    let high = -0.07 * (x + 0.38).powi(2) + 0.07;
    if low < *velocity && *velocity < high {
        2
    } else {
        0
    }
}

/// Drives in the direction of the velocity, which adds energy, and gently, because force costs
/// reward.
pub(crate) fn mountain_car_continuous([_, velocity]: &[f32; 2]) -> [f32; 1] {
    [if *velocity < 0.0 { -0.4 } else { 0.4 }]
}

/// Adds energy until the pole is near the top, then balances the pole.
pub(crate) fn pendulum([cos, sin, theta_dot]: &[f32; 3]) -> [f32; 1] {
    let theta = atan2(f64::from(*sin), f64::from(*cos)) as f32;
    // per moment of inertia; the energy at the top is 15
    let energy = 0.5 * theta_dot * theta_dot + 15.0 * cos;
    let torque = if theta.abs() < 0.5 {
        -10.0 * theta - 2.0 * theta_dot
    } else {
        (15.0 - energy) * theta_dot
    };
    [torque.clamp(-2.0, 2.0)]
}

/// Pushes the lower link in the direction of its motion, which adds energy.
pub(crate) fn acrobot(seen: &[f32; 6]) -> i64 {
    let [_, _, _, _, _, dtheta2] = *seen;
    if dtheta2 < 0.0 { 0 } else { 2 }
}
