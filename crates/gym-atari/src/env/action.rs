//! What an agent does: one of a game's actions, or a stick and a button by degrees.

use std::f32::consts::PI;

use gym_core::{Continuous, Element, Value};

use crate::action::Action;

/// An action of the environments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AtariAction {
    /// An index into the actions of the environment: the game's minimal set, or all 18.
    Index(usize),
    /// With [`Config::continuous`](super::Config::continuous): radius and angle of the stick, and how hard the button is
    /// pressed.
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
            _ => Continuous::<3>::from_value(value).map(|stick| Self::Stick(stick.numbers.map(|x| x as f32))),
        }
    }

    fn write(&self, out: &mut Value) {
        match self {
            Self::Index(index) => index.write(out),
            Self::Stick(stick) => stick.write(out),
        }
    }
}

/// The action that a stick and a button amount to: one of eight directions beyond a radius of `threshold`, and fire
/// beyond a pressure of it.
pub(super) fn from_stick([radius, angle, pressure]: [f32; 3], threshold: f32) -> Action {
    let (x, y) = (radius * angle.cos(), radius * angle.sin());
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
