//! Facts about each game: its ROM, how it starts, and the RAM addresses of score and lives.
//!
//! Everything here was measured from outside; see `NOTICE.md`.

mod special;
mod table;

use crate::action::Action;
use crate::cartridge::Scheme;
use crate::tia::Display;

pub use table::GAMES;

/// A game of the 2600.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Game {
    /// ale-py's name: `space_invaders`. The ROM's file is `space_invaders.bin`.
    pub name: &'static str,
    /// The name in ids: `SpaceInvaders`.
    pub title: &'static str,
    /// The MD5 of the ROM.
    pub md5: &'static str,
    /// The bank switching of the cartridge.
    pub scheme: Scheme,
    /// The first line and the height of the picture, and whether it shows the comb of `HMOVE`.
    pub display: Display,
    /// The player's controller.
    pub controller: Controller,
    /// The largest resistance of the game's paddle, at its left end, in ohms.
    pub paddle_end: u32,
    /// The actions after RESET, one frame each.
    pub start: &'static [Action],
    /// The minimal action set.
    pub minimal: &'static [Action],
    /// The full action set; without the button in games that do not use it.
    pub legal: &'static [Action],
    /// The idle frames after the first RESET; ale-py counts them as frames of the episode.
    pub idle: u8,
    /// The number of frames for which RESET is pressed first.
    pub first_reset: u8,
    /// The modes by ale-py's numbers, each with the RAM byte that shows it. The first is the
    /// default.
    pub modes: &'static [(u16, u8)],
    /// The index of the RAM byte that shows the mode: SELECT is pressed until it does. `None` if
    /// SELECT is never pressed.
    pub mode_at: Option<usize>,
    /// A further condition on RAM that shows a mode.
    pub mode_also: fn(&Ram<'_>, u16) -> bool,
    /// Bits of the mode's RAM byte that may also be set.
    pub mode_bits: u8,
    /// Whether SELECT is pressed at least once.
    pub press_first: bool,
    /// The on-screen menu that selects modes, if SELECT does not.
    pub menu: Option<Menu>,
    /// The number of frames for which SELECT is held.
    pub select_frames: u8,
    /// Whether each press of SELECT is prolonged by up to 255 random frames and followed by a frame
    /// of play.
    pub select_random: bool,
    /// The difficulties of the game.
    pub difficulties: &'static [u8],
    /// Reads the points from RAM.
    pub score: fn(&Ram<'_>) -> i32,
    /// How points become rewards.
    pub rewards: Rewards,
    /// Whether RAM determines this frame's reward. If not, the previous frame's reward is repeated.
    pub rewards_count: fn(&Ram<'_>) -> bool,
    /// Reads the lives from RAM.
    pub lives: fn(&Ram<'_>) -> i32,
    /// The lives once the game is over.
    pub lives_at_end: i32,
    /// Whether RAM shows the lives in this frame. If not, the previous number remains.
    pub lives_count: fn(&Ram<'_>) -> bool,
    /// Whether RAM shows that the game is over.
    pub over: fn(&Ram<'_>) -> bool,
    /// For how many consecutive frames RAM must show that.
    pub over_frames: u8,
}

/// The values of most games.
const DEFAULT: Game = Game {
    name: "",
    title: "",
    md5: "",
    scheme: Scheme::Rom4K,
    display: Display::NTSC,
    controller: Controller::Joystick,
    paddle_end: 790_196,
    start: &[],
    minimal: &Action::ALL,
    legal: &Action::ALL,
    idle: 0,
    first_reset: 4,
    modes: &[(0, 0)],
    mode_at: None,
    mode_also: |_, _| true,
    mode_bits: 0,
    press_first: false,
    menu: None,
    select_frames: 2,
    select_random: false,
    difficulties: &[0],
    score: |_| 0,
    rewards: Rewards::Difference,
    rewards_count: |_| true,
    lives: |_| 0,
    lives_at_end: 0,
    lives_count: |_| true,
    over: |_| false,
    over_frames: 1,
};

/// A menu of options, each a bit of the mode. SELECT opens it, and the stick moves through it.
#[derive(Clone, Copy, Debug)]
pub struct Menu {
    /// The index of the RAM byte that shows the current line.
    pub line: usize,
    /// The index of the RAM byte that shows the options that are on.
    pub set: usize,
    /// For each bit of the mode, from the lowest on: the line of its option, and the option's bit
    /// in `set`.
    pub options: &'static [(u8, u8)],
}

/// How a game's points become rewards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rewards {
    /// The increase of the points.
    Difference,
    /// The increase of the points; the counter wraps to 0 after this number of points.
    Wrap(i32),
    /// The increase of the points; a decrease counts as 0.
    NeverNegative,
    /// The score is [`GAME_WON`] per game won, plus the points within the game. The reward of a
    /// frame that ends a game is the change in games, of any other frame the change in points.
    Games,
    /// The score is a number below [`GAME_WON`], plus [`GAME_WON`] for a won game. The reward is -1
    /// for a frame that changes the number, and 100 for a frame in which the game is won.
    Changes,
}

impl Rewards {
    /// Returns the reward of a frame, from the score before and after it.
    pub(crate) fn of(self, before: i32, after: i32) -> i32 {
        match (self, after - before) {
            (Self::Wrap(limit), fall @ ..0) => fall + limit,
            (Self::NeverNegative, ..0) => 0,
            (Self::Games, _) => {
                let games = |score: i32| (score + GAME_WON / 2).div_euclid(GAME_WON);
                let points = |score: i32| score - GAME_WON * games(score);
                match games(after) - games(before) {
                    0 => points(after) - points(before),
                    games => games,
                }
            }
            (Self::Changes, _) => {
                100 * (after / GAME_WON) - i32::from(before % GAME_WON != after % GAME_WON)
            }
            (_, difference) => difference,
        }
    }
}

/// What a won game adds to the score in [`Rewards::Games`]: more than twice the points of any game.
pub const GAME_WON: i32 = 1024;

/// The player's controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Controller {
    /// A joystick in the left port.
    Joystick,
    /// A joystick in the right port.
    RightJoystick,
    /// Paddles in both ports; the agent turns the paddle with this number in the left port.
    Paddle(usize),
    /// Paddles in the left port only; the agent turns the paddle with this number.
    LeftPaddle(usize),
}

/// The console's 128 bytes of RAM, `$80` to `$FF`, and the number formats that games use.
#[derive(Clone, Copy, Debug)]
pub struct Ram<'a>(pub &'a [u8; 128]);

impl Ram<'_> {
    /// Returns a byte.
    pub fn at(&self, index: usize) -> i32 {
        i32::from(self.0[index & 0x7f])
    }

    /// Returns the lower four bits of a byte.
    pub fn low(&self, index: usize) -> i32 {
        self.at(index) & 0x0f
    }

    /// Returns the upper four bits of a byte.
    pub fn high(&self, index: usize) -> i32 {
        self.at(index) >> 4
    }

    /// Returns two BCD digits.
    pub fn bcd(&self, index: usize) -> i32 {
        10 * self.high(index) + self.low(index)
    }

    /// Returns two BCD digits per byte, most significant byte first.
    pub fn decimal(&self, indices: &[usize]) -> i32 {
        indices
            .iter()
            .fold(0, |number, &index| 100 * number + self.bcd(index))
    }

    /// Returns one digit per byte, from its lower four bits, most significant byte first. A digit
    /// above 9 is a blank.
    pub fn low_digits(&self, indices: &[usize]) -> i32 {
        indices
            .iter()
            .fold(0, |number, &index| 10 * number + digit(self.low(index)))
    }

    /// Returns one digit per byte, from its lower four bits, most significant byte first. The digit
    /// 10 is a blank.
    pub fn ten_digits(&self, indices: &[usize]) -> i32 {
        indices
            .iter()
            .fold(0, |number, &index| 10 * number + ten(self.low(index)))
    }

    /// Returns one digit, from the upper four bits of a byte; 10 is a blank.
    pub fn ten_high(&self, index: usize) -> i32 {
        ten(self.high(index))
    }

    /// Returns two BCD digits per byte; a digit above 9 is a blank.
    pub fn blank_decimal(&self, indices: &[usize]) -> i32 {
        indices.iter().fold(0, |number, &index| {
            100 * number + 10 * digit(self.high(index)) + digit(self.low(index))
        })
    }

    /// Returns a signed byte.
    pub fn signed(&self, index: usize) -> i32 {
        i32::from(self.0[index & 0x7f] as i8)
    }

    /// Returns how many bytes in `range` equal `value`.
    pub fn count(&self, range: std::ops::Range<usize>, value: u8) -> i32 {
        self.0[range].iter().filter(|&&byte| byte == value).count() as i32
    }

    /// Returns one digit per byte. A byte is the offset of the digit's image, of 8 bytes; `blank`
    /// is the offset of an empty image.
    pub fn pictures(&self, indices: &[usize], blank: u8) -> i32 {
        indices.iter().fold(0, |number, &index| {
            let digit = if self.0[index] == blank {
                0
            } else {
                self.at(index) / 8
            };
            10 * number + digit
        })
    }
}

/// Returns a digit; 10 is a blank.
fn ten(value: i32) -> i32 {
    if value == 10 { 0 } else { value }
}

/// Returns a digit; a value above 9 is a blank.
fn digit(value: i32) -> i32 {
    if value > 9 { 0 } else { value }
}

/// Returns the game with this name.
pub fn by_name(name: &str) -> Option<&'static Game> {
    GAMES.iter().find(|game| game.name == name)
}

/// Returns the game of a ROM.
pub fn by_md5(md5: &str) -> Option<&'static Game> {
    GAMES.iter().find(|game| game.md5 == md5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_become_rewards_as_the_game_counts_them() {
        use Rewards::{Changes, Difference, Games, NeverNegative, Wrap};
        for (rewards, before, after, reward) in [
            (Difference, 5, 12, 7),
            (Difference, 12, 5, -7),
            (Wrap(100), 5, 12, 7),
            (Wrap(100), 98, 3, 5),
            (Wrap(100), 7, 7, 0),
            (NeverNegative, 5, 12, 7),
            (NeverNegative, 12, 11, 0),
            (NeverNegative, 12, 12, 0),
            (Games, 3, 5, 2),
            (Games, 5, 3, -2),
            (Games, 40, GAME_WON, 1),
            (Games, -40, -GAME_WON, -1),
            (Games, 2 * GAME_WON - 7, 2 * GAME_WON + 9, 16),
            (Changes, 4, 4, 0),
            (Changes, 4, 5, -1),
            (Changes, 5, 4, -1),
            (Changes, 4, 4 + GAME_WON, 100),
            (Changes, 4, 5 + GAME_WON, 99),
        ] {
            let found = rewards.of(before, after);
            assert_eq!(found, reward, "{rewards:?}: {before}, {after}");
        }
    }
}
