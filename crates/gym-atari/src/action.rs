//! The actions of a player in a frame.

use serde::{Deserialize, Serialize};

/// ale-py's 18 actions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Action {
    /// Nothing.
    Noop,
    /// The button.
    Fire,
    /// The stick up.
    Up,
    /// To the right.
    Right,
    /// To the left.
    Left,
    /// Down.
    Down,
    /// Up and to the right.
    UpRight,
    /// Up and to the left.
    UpLeft,
    /// Down and to the right.
    DownRight,
    /// Down and to the left.
    DownLeft,
    /// Up, and the button.
    UpFire,
    /// To the right, and the button.
    RightFire,
    /// To the left, and the button.
    LeftFire,
    /// Down, and the button.
    DownFire,
    /// Up and to the right, and the button.
    UpRightFire,
    /// Up and to the left, and the button.
    UpLeftFire,
    /// Down and to the right, and the button.
    DownRightFire,
    /// Down and to the left, and the button.
    DownLeftFire,
}

/// The input of a frame: an action, and the speed at which a paddle turns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// The action.
    pub action: Action,
    /// The fraction of a paddle's full speed, ale-py's `paddle_strength`. Joysticks ignore it.
    pub paddle_strength: f32,
}

impl From<Action> for Command {
    /// Makes a command of `action`, at full paddle speed.
    fn from(action: Action) -> Self {
        Self {
            action,
            paddle_strength: 1.0,
        }
    }
}

impl Action {
    /// Every action, in the order of its number.
    pub const ALL: [Self; 18] = [
        Self::Noop,
        Self::Fire,
        Self::Up,
        Self::Right,
        Self::Left,
        Self::Down,
        Self::UpRight,
        Self::UpLeft,
        Self::DownRight,
        Self::DownLeft,
        Self::UpFire,
        Self::RightFire,
        Self::LeftFire,
        Self::DownFire,
        Self::UpRightFire,
        Self::UpLeftFire,
        Self::DownRightFire,
        Self::DownLeftFire,
    ];

    /// Returns ale-py's name of the action, such as `RIGHTFIRE`.
    pub fn name(self) -> String {
        format!("{self:?}").to_uppercase()
    }

    /// Returns the action without the button.
    fn direction(self) -> Self {
        match self as usize {
            1 => Self::Noop,
            with_fire @ 10.. => Self::ALL[with_fire - 8],
            _ => self,
        }
    }

    /// Whether the button is pressed.
    pub fn fire(self) -> bool {
        self == Self::Fire || self as usize >= 10
    }

    /// Returns 1 if the stick points right, -1 if it points left, otherwise 0.
    pub fn horizontal(self) -> i32 {
        match self.direction() {
            Self::Right | Self::UpRight | Self::DownRight => 1,
            Self::Left | Self::UpLeft | Self::DownLeft => -1,
            _ => 0,
        }
    }

    /// Returns 1 if the stick points up, -1 if it points down, otherwise 0.
    pub fn vertical(self) -> i32 {
        match self.direction() {
            Self::Up | Self::UpRight | Self::UpLeft => 1,
            Self::Down | Self::DownRight | Self::DownLeft => -1,
            _ => 0,
        }
    }

    /// Returns `SWCHA` with the left stick's direction: its four bits are active low, the other
    /// bits are set.
    pub(crate) fn port_a(self) -> u8 {
        let mut port = 0xff;
        match self.vertical() {
            1 => port &= 0xef,
            -1 => port &= 0xdf,
            _ => {}
        }
        match self.horizontal() {
            1 => port &= 0x7f,
            -1 => port &= 0xbf,
            _ => {}
        }
        port
    }
}
