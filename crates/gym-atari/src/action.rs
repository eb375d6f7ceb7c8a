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

/// The input of a frame: an action, and the speed of a paddle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// The action.
    pub action: Action,
    /// The share of a paddle's full speed, ale-py's `paddle_strength`; joysticks ignore it.
    pub paddle_strength: f32,
}

impl From<Action> for Command {
    /// The action, with a paddle turned at full speed.
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

    /// ale-py's name, `RIGHTFIRE` for instance.
    pub fn name(self) -> String {
        format!("{self:?}").to_uppercase()
    }

    /// The same action without the button.
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

    /// Whether the stick points right, `1`, or left, `-1`.
    pub fn horizontal(self) -> i32 {
        match self.direction() {
            Self::Right | Self::UpRight | Self::DownRight => 1,
            Self::Left | Self::UpLeft | Self::DownLeft => -1,
            _ => 0,
        }
    }

    /// Whether the stick points up, `1`, or down, `-1`.
    pub fn vertical(self) -> i32 {
        match self.direction() {
            Self::Up | Self::UpRight | Self::UpLeft => 1,
            Self::Down | Self::DownRight | Self::DownLeft => -1,
            _ => 0,
        }
    }

    /// The left stick's four bits of `SWCHA`, the others set.
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
