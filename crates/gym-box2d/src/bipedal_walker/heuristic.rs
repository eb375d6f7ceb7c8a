//! A hand-written controller.

/// Gymnasium's hand-written gait. It does not balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heuristic {
    state: Gait,
    moving_leg: usize,
    supporting_knee_angle: f32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Gait {
    StayOnOneLeg,
    PutOtherDown,
    PushOff,
}

const SPEED: f64 = 0.29; // the walker falls forward at higher speeds
const SUPPORT_KNEE_ANGLE: f32 = 0.1;

impl Default for Heuristic {
    fn default() -> Self {
        Self {
            state: Gait::StayOnOneLeg,
            moving_leg: 0,
            supporting_knee_angle: SUPPORT_KNEE_ANGLE,
        }
    }
}

impl Heuristic {
    /// Returns the action for the observation `s`.
    pub fn act(&mut self, s: &[f32; 24]) -> [f32; 4] {
        let (moving, supporting) = (self.moving_leg, 1 - self.moving_leg);
        let leg = |leg: usize| &s[4 + 5 * leg..];
        // 0 means no target
        let (mut hip_targ, mut knee_targ) = ([0.0; 2], [0.0; 2]);

        if self.state == Gait::StayOnOneLeg {
            hip_targ[moving] = 1.1;
            knee_targ[moving] = -0.6;
            self.supporting_knee_angle += 0.03;
            if s[2] > SPEED as f32 {
                self.supporting_knee_angle += 0.03;
            }
            self.supporting_knee_angle = self.supporting_knee_angle.min(SUPPORT_KNEE_ANGLE);
            knee_targ[supporting] = self.supporting_knee_angle;
            if leg(supporting)[0] < 0.10 {
                self.state = Gait::PutOtherDown; // the supporting leg is behind
            }
        }
        if self.state == Gait::PutOtherDown {
            hip_targ[moving] = 0.1;
            knee_targ[moving] = SUPPORT_KNEE_ANGLE;
            knee_targ[supporting] = self.supporting_knee_angle;
            if leg(moving)[4] != 0.0 {
                self.state = Gait::PushOff;
                self.supporting_knee_angle = leg(moving)[2].min(SUPPORT_KNEE_ANGLE);
            }
        }
        if self.state == Gait::PushOff {
            knee_targ[moving] = self.supporting_knee_angle;
            knee_targ[supporting] = 1.0;
            if leg(supporting)[2] > 0.88 || s[2] > (1.2 * SPEED) as f32 {
                self.state = Gait::StayOnOneLeg;
                self.moving_leg = 1 - self.moving_leg;
            }
        }

        let mut action = [0.0; 4];
        for i in 0..2 {
            let l = leg(i);
            let (mut hip_todo, mut knee_todo) = (0.0, 0.0);
            if hip_targ[i] != 0.0 {
                hip_todo = 0.9 * (hip_targ[i] - l[0]) - 0.25 * l[1];
            }
            if knee_targ[i] != 0.0 {
                knee_todo = 4.0 * (knee_targ[i] - l[2]) - 0.25 * l[3];
            }
            hip_todo -= 0.9 * (0.0 - s[0]) - 1.5 * s[1]; // keeps the head straight
            knee_todo -= 15.0 * s[3]; // damps oscillations
            action[2 * i] = (0.5f32 * hip_todo).clamp(-1.0, 1.0);
            action[2 * i + 1] = (0.5f32 * knee_todo).clamp(-1.0, 1.0);
        }
        action
    }
}
