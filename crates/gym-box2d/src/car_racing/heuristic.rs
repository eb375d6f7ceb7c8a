//! A hand-written controller.

use std::f64::consts::PI;

use gym_core::math::atan2;
use gym_core::policy::Controller;
use gym_core::{BoxEnv, Element, Env, EnvExt, Space};

use super::CarRacing;

/// Steers towards the sixth track point ahead, at a moderate speed. The controller reads the track,
/// not the image, and does not support the five discrete actions.
pub(super) fn follow_the_track(env: &BoxEnv) -> Option<Controller> {
    if let Space::Discrete(_) = env.action_space() {
        return None;
    }
    let mut passed = 0;
    Some(Box::new(move |env, _| {
        let env = env.layer::<CarRacing>()?;
        let track = env.track()?;
        let [x, y, angle, vx, vy, _] = env.state()?.hull;
        let ahead = |n: usize| &track[(passed + n) % track.len()];
        let away = |n: &usize| distance(ahead(*n).x - x, ahead(*n).y - y);
        passed += (0..40).min_by(|a, b| away(a).total_cmp(&away(b)))?;
        let target = &track[(passed + 6) % track.len()];
        let turn = (atan2(x - target.x, target.y - y) - angle + PI).rem_euclid(2.0 * PI) - PI;
        let speed = distance(vx, vy);
        let pedals = [
            (-1.5 * turn).clamp(-1.0, 1.0),
            if speed < 40.0 { 0.4 } else { 0.0 },
            if speed > 60.0 { 0.3 } else { 0.0 },
        ];
        Some(pedals.map(|pedal| pedal as f32).to_value())
    }))
}

fn distance(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}
