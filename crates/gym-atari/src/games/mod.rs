//! What is known of each game: its ROM, how it starts, and where its RAM holds score and lives.
//!
//! Everything here was measured from outside; `NOTICE.md` says how.

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
    /// The MD5 of the ROM.
    pub md5: &'static str,
    /// How the cartridge switches banks.
    pub scheme: Scheme,
    /// Where the picture starts, and whether it shows the comb of `HMOVE`.
    pub display: Display,
    /// How it is played.
    pub controller: Controller,
    /// For how many frames RESET is pressed at the start.
    pub reset_frames: u8,
    /// The actions after RESET, a frame each.
    pub start: &'static [Action],
    /// The minimal action set.
    pub minimal: &'static [Action],
    /// The modes that there are; the first is the default.
    pub modes: &'static [Mode],
    /// The difficulties that there are.
    pub difficulties: &'static [u8],
    /// The points, from RAM.
    pub score: fn(&Ram) -> i32,
    /// The lives, from RAM.
    pub lives: fn(&Ram) -> i32,
    /// Whether the game is over, from RAM.
    pub over: fn(&Ram) -> bool,
}

/// A mode of a game, and how the RAM shows it.
#[derive(Clone, Copy, Debug)]
pub struct Mode {
    /// ale-py's number of it.
    pub number: u16,
}

/// What the player holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Controller {
    /// A joystick in the left port.
    Joystick,
    /// Paddles in the left port; the agent turns this one.
    Paddle(usize),
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
        indices.iter().fold(0, |number, &index| 100 * number + self.bcd(index))
    }

    /// One decimal digit in each byte, as the place of its picture, 8 bytes a digit; `blank` is a picture of nothing.
    pub fn pictures(&self, indices: &[usize], blank: u8) -> i32 {
        indices.iter().fold(0, |number, &index| {
            let digit = if self.0[index] == blank { 0 } else { self.at(index) / 8 };
            10 * number + digit
        })
    }
}

/// The game of a name.
pub fn by_name(name: &str) -> Option<&'static Game> {
    GAMES.iter().find(|game| game.name == name)
}

/// The game of a ROM.
pub fn by_md5(md5: &str) -> Option<&'static Game> {
    GAMES.iter().find(|game| game.md5 == md5)
}
