//! The facts about each game: its ROM, its start, and the RAM addresses of score and lives.
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
    /// The resistance of a paddle that is turned to the left as far as it goes, in ohms.
    pub paddle_end: u32,
    /// The actions after RESET, a frame each.
    pub start: &'static [Action],
    /// The minimal action set.
    pub minimal: &'static [Action],
    /// The full action set, without the button in games that do not use it.
    pub legal: &'static [Action],
    /// The frames of nothing behind the first RESET; ale-py counts them as frames of the episode.
    pub idle: u8,
    /// The number of frames for which RESET is pressed first.
    pub first_reset: u8,
    /// The modes, by ale-py's numbers, and the RAM that marks each; the first is the default.
    pub modes: &'static [(u16, u8)],
    /// The byte of RAM that shows the mode, by index: SELECT is pressed until it does. `None` where
    /// SELECT is never pressed.
    pub mode_at: Option<usize>,
    /// A further condition on RAM, for a mode.
    pub mode_also: fn(&Ram<'_>, u16) -> bool,
    /// Bits that RAM may have in addition.
    pub mode_bits: u8,
    /// Whether SELECT is pressed at least once.
    pub press_first: bool,
    /// The menu on the screen in which modes are chosen, if not by SELECT.
    pub menu: Option<Menu>,
    /// The number of frames for which SELECT is held each time.
    pub select_frames: u8,
    /// Whether each press lasts for up to 255 more frames, drawn at random, and a frame of play
    /// follows.
    pub select_random: bool,
    /// The difficulties that there are.
    pub difficulties: &'static [u8],
    /// The points, from RAM.
    pub score: fn(&Ram<'_>) -> i32,
    /// The rule by which points become rewards.
    pub rewards: Rewards,
    /// Whether RAM shows a frame's own reward; otherwise the reward of the frame before is
    /// repeated.
    pub rewards_count: fn(&Ram<'_>) -> bool,
    /// The lives, from RAM.
    pub lives: fn(&Ram<'_>) -> i32,
    /// The lives where the game is over.
    pub lives_at_end: i32,
    /// Whether the lives in RAM count at the moment; where not, the number before stays.
    pub lives_count: fn(&Ram<'_>) -> bool,
    /// Whether the game is over, from RAM.
    pub over: fn(&Ram<'_>) -> bool,
    /// The number of frames in a row for which RAM must say so.
    pub over_frames: u8,
}

/// The settings of most games.
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

/// A menu of options, each a bit of the mode: SELECT shows it, and the stick goes through it.
#[derive(Clone, Copy, Debug)]
pub struct Menu {
    /// The byte of RAM that shows the line, by index.
    pub line: usize,
    /// The byte that shows the options that are set.
    pub set: usize,
    /// For each bit of the mode, from the lowest on: the line of its option, and the bit that shows
    /// it.
    pub options: &'static [(u8, u8)],
}

/// The rule by which a game's points become rewards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rewards {
    /// The points that a frame brought.
    Difference,
    /// The counter starts again at 0 after this many points.
    Wrap(i32),
    /// A counter that falls gives 0.
    NeverNegative,
    /// The score is [`GAME_WON`] for each game that is won, and points within the game. A frame
    /// that ends a game gives the change in games, any other the change in points.
    Games,
    /// The score is a number below [`GAME_WON`], to which a won game adds that. A frame that
    /// changes the number costs a point, and one in which the game is won brings 100.
    Changes,
}

impl Rewards {
    /// The reward of a frame.
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

/// The points of a won game in the score of [`Rewards::Games`]: more than twice the points of any.
pub const GAME_WON: i32 = 1024;

/// The player's controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Controller {
    /// A joystick in the left port.
    Joystick,
    /// A joystick in the right port.
    RightJoystick,
    /// Paddles in both ports; the agent turns this one, of the left port.
    Paddle(usize),
    /// Paddles in the left port alone; the agent turns this one.
    LeftPaddle(usize),
}

/// The console's 128 bytes of RAM, `$80` to `$FF`, and how games write numbers into them.
#[derive(Clone, Copy, Debug)]
pub struct Ram<'a>(pub &'a [u8; 128]);

impl Ram<'_> {
    /// A byte.
    pub fn at(&self, index: usize) -> i32 {
        i32::from(self.0[index & 0x7f])
    }

    /// The lower four bits.
    pub fn low(&self, index: usize) -> i32 {
        self.at(index) & 0x0f
    }

    /// The upper four bits.
    pub fn high(&self, index: usize) -> i32 {
        self.at(index) >> 4
    }

    /// Two decimal digits.
    pub fn bcd(&self, index: usize) -> i32 {
        10 * self.high(index) + self.low(index)
    }

    /// Two decimal digits in each byte, the most significant byte first.
    pub fn decimal(&self, indices: &[usize]) -> i32 {
        indices
            .iter()
            .fold(0, |number, &index| 100 * number + self.bcd(index))
    }

    /// One decimal digit in the lower four bits of each byte, the most significant byte first;
    /// above 9 is a blank.
    pub fn low_digits(&self, indices: &[usize]) -> i32 {
        indices
            .iter()
            .fold(0, |number, &index| 10 * number + digit(self.low(index)))
    }

    /// One decimal digit in the lower four bits of each byte, the most significant byte first; 10
    /// is a blank.
    pub fn ten_digits(&self, indices: &[usize]) -> i32 {
        indices
            .iter()
            .fold(0, |number, &index| 10 * number + ten(self.low(index)))
    }

    /// One decimal digit in the upper four bits of a byte; 10 is a blank.
    pub fn ten_high(&self, index: usize) -> i32 {
        ten(self.high(index))
    }

    /// Two decimal digits in each byte, of which those above 9 are blank.
    pub fn blank_decimal(&self, indices: &[usize]) -> i32 {
        indices.iter().fold(0, |number, &index| {
            100 * number + 10 * digit(self.high(index)) + digit(self.low(index))
        })
    }

    /// A byte that counts below zero.
    pub fn signed(&self, index: usize) -> i32 {
        i32::from(self.0[index & 0x7f] as i8)
    }

    /// The number of bytes in a range that have a value.
    pub fn count(&self, range: std::ops::Range<usize>, value: u8) -> i32 {
        self.0[range].iter().filter(|&&byte| byte == value).count() as i32
    }

    /// One decimal digit in each byte, as the place of its picture, 8 bytes a digit; `blank` is a
    /// picture of nothing.
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

/// A digit; 10 shows as a blank.
fn ten(value: i32) -> i32 {
    if value == 10 { 0 } else { value }
}

/// A digit; values above 9 are shown as blanks.
fn digit(value: i32) -> i32 {
    if value > 9 { 0 } else { value }
}

/// The game of a name.
pub fn by_name(name: &str) -> Option<&'static Game> {
    GAMES.iter().find(|game| game.name == name)
}

/// The game of a ROM.
pub fn by_md5(md5: &str) -> Option<&'static Game> {
    GAMES.iter().find(|game| game.md5 == md5)
}
