//! Gymnasium's hand-written pilot.

use super::{Action, Engine};

/// Gymnasium's hand-written pilot: returns its action for the observation `s`, continuous or
/// discrete.
pub fn heuristic(s: &[f32; 8], continuous: bool) -> Action {
    // tilt towards the centre, by at most 0.4 rad
    let angle_targ = (s[0] * 0.5 + s[2] * 1.0).clamp(-0.4, 0.4);
    let hover_targ = 0.55 * s[0].abs(); // the target height grows with the distance
    let mut angle_todo = (angle_targ - s[4]) * 0.5 - s[5] * 1.0;
    let mut hover_todo = (hover_targ - s[1]) * 0.5 - s[3] * 0.5;
    if s[6] != 0.0 || s[7] != 0.0 {
        // on the ground, only damp the fall
        angle_todo = 0.0;
        hover_todo = -s[3] * 0.5;
    }
    if continuous {
        return [hover_todo * 20.0 - 1.0, -angle_todo * 20.0]
            .map(|x| x.clamp(-1.0, 1.0))
            .into();
    }
    Action::Fire(if hover_todo > angle_todo.abs() && hover_todo > 0.05 {
        Engine::Main
    } else if angle_todo < -0.05 {
        Engine::Right
    } else if angle_todo > 0.05 {
        Engine::Left
    } else {
        Engine::Off
    })
}
