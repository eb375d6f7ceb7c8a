//! The actions of an agent: an index into the game's actions, or a continuous stick and button.

use std::f32::consts::PI;

use gym_core::{Continuous, Element, Value, math};

use crate::action::Action;

/// An action of the environments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AtariAction {
    /// An index into the environment's actions: the game's minimal set, or all 18.
    Index(usize),
    /// With [`Config::continuous`](super::Config::continuous): radius and angle of the stick, and
    /// pressure of the button.
    Stick([f32; 3]),
}

impl From<usize> for AtariAction {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

impl From<[f32; 3]> for AtariAction {
    fn from(stick: [f32; 3]) -> Self {
        Self::Stick(stick)
    }
}

impl Element for AtariAction {
    fn empty() -> Self {
        Self::Index(0)
    }

    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Int(_) => usize::from_value(value).map(Self::Index),
            _ => Continuous::<3>::from_value(value)
                .map(|stick| Self::Stick(stick.numbers.map(|x| x as f32))),
        }
    }

    fn write(&self, out: &mut Value) {
        match self {
            Self::Index(index) => index.write(out),
            Self::Stick(stick) => stick.write(out),
        }
    }
}

/// Returns the game's action for a stick and a button. A direction counts if its coordinate exceeds
/// `threshold`; the button counts if `pressure` exceeds `threshold`. ale-py computes the
/// coordinates with numpy's `float32` functions.
pub(super) fn from_stick([radius, angle, pressure]: [f32; 3], threshold: f32) -> Action {
    let (sin, cos) = math::numpy_sin_cos_f32(angle);
    let (x, y) = (radius * cos, radius * sin);
    let (horizontal, vertical) = (direction(x, threshold), direction(y, threshold));
    let fire = pressure > threshold;
    let plain = match (horizontal, vertical) {
        (0, 0) => return if fire { Action::Fire } else { Action::Noop },
        (0, 1) => 2,
        (1, 0) => 3,
        (-1, 0) => 4,
        (0, -1) => 5,
        (1, 1) => 6,
        (-1, 1) => 7,
        (1, -1) => 8,
        _ => 9,
    };
    Action::ALL[if fire { plain + 8 } else { plain }]
}

fn direction(coordinate: f32, threshold: f32) -> i32 {
    i32::from(coordinate > threshold) - i32::from(coordinate < -threshold)
}

/// The largest angle of a stick.
pub(super) const MOST_ANGLE: f32 = PI;

#[cfg(test)]
mod tests {
    use super::*;

    /// The expected actions are recorded from ale-py 0.12.1. With glibc's `cosf`, each case would
    /// select another action.
    #[test]
    fn sticks_at_the_threshold_are_decided_by_numpys_cosine() {
        for (radius, angle, expected) in [
            (0x3f45_3a67, 0x3f5d_521b, Action::Noop),
            (0x3f27_888e, 0x3f33_8618, Action::Noop),
            (0x3f23_0948, 0x3f2a_fde0, Action::Noop),
            (0x3f26_e297, 0x3f32_57c9, Action::Right),
        ] {
            let (radius, angle) = (f32::from_bits(radius), f32::from_bits(angle));
            // the sine may exceed the threshold too, so only the horizontal direction is compared
            let action = from_stick([radius, angle, 0.0], 0.5);
            let is_right = matches!(action, Action::Right | Action::UpRight);
            assert_eq!(
                is_right,
                expected == Action::Right,
                "{radius} {angle}: {action:?}"
            );
        }
    }
}
