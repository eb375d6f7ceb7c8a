//! Compares games with ale-py 0.12.1 by checksums.
//!
//! `examples/recorded.py` plays the same frames with ale-py and writes `recorded.txt`; `cargo xtask
//! atari check` compares.

use crc32fast::Hasher;

use crate::action::Action;
use crate::ale::{Ale, Settings};
use crate::rom::Rom;

/// One line per game: its name and its three checksums.
const RECORDED: &str = include_str!("recorded.txt");
/// The frames of each long run.
const FRAMES: u32 = 1000;
/// The frames of each episode in a mode.
const MODE_FRAMES: u32 = 60;

/// Checksums of RAM, picture, reward, lives, end and frame numbers after every frame and reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sums {
    /// The checksum of 1,000 frames with the minimal actions.
    pub minimal: u32,
    /// The checksum of 1,000 frames with all actions and a sticky probability of 1/4.
    pub sticky: u32,
    /// The checksum of two episodes of 60 frames in each mode with each difficulty.
    pub modes: u32,
}

impl Sums {
    /// Returns the checksums of ale-py 0.12.1; `None` for a game that was not recorded.
    pub fn recorded(game: &str) -> Option<Self> {
        Self::read(RECORDED, game)
    }

    /// Returns the checksums of `game` in `text`, which has one line per game: its name and three
    /// hexadecimal checksums. `None` if there is no such line.
    pub fn read(text: &str, game: &str) -> Option<Self> {
        let line = text
            .lines()
            .find(|line| line.split(' ').next() == Some(game))?;
        let mut sums = line
            .split(' ')
            .skip(1)
            .map(|sum| u32::from_str_radix(sum, 16).ok());
        let mut next = || sums.next().flatten();
        Some(Self {
            minimal: next()?,
            sticky: next()?,
            modes: next()?,
        })
    }

    /// Returns the names of the runs whose checksums differ from `others`.
    pub fn differences(&self, others: &Self) -> Vec<&'static str> {
        let runs = [
            ("the minimal actions", self.minimal == others.minimal),
            (
                "all actions, sticky ones among them",
                self.sticky == others.sticky,
            ),
            ("the modes", self.modes == others.modes),
        ];
        runs.into_iter()
            .filter(|(_, equal)| !equal)
            .map(|(run, _)| run)
            .collect()
    }

    /// Returns the checksums of this crate.
    pub fn of(rom: &Rom) -> Self {
        let game = rom.game();
        let run = |seed, actions: &[Action], repeat_action_probability| {
            let settings = Settings {
                repeat_action_probability,
                ..Settings::default()
            };
            let mut run = Run::new(rom, seed, settings);
            run.play(FRAMES, actions);
            run.sum.finalize()
        };
        let mut modes = Hasher::new();
        for &(mode, _) in game.modes {
            for &difficulty in game.difficulties {
                let settings = Settings {
                    mode: Some(mode),
                    difficulty: Some(difficulty),
                    ..Settings::default()
                };
                let mut run = Run::new(rom, 3, settings);
                run.play(MODE_FRAMES, game.minimal);
                run.reset();
                run.play(MODE_FRAMES, game.minimal);
                modes.update(&run.sum.finalize().to_le_bytes());
            }
        }
        Self {
            minimal: run(1, game.minimal, 0.0),
            sticky: run(2, game.legal, 0.25),
            modes: modes.finalize(),
        }
    }
}

/// A game that is played at random, and the checksum of its results.
struct Run {
    ale: Ale,
    sum: Hasher,
    random: u32,
}

impl Run {
    fn new(rom: &Rom, seed: u32, settings: Settings) -> Self {
        let mut run = Self {
            ale: Ale::new(rom.game(), rom.bytes(), seed),
            sum: Hasher::new(),
            random: seed,
        };
        run.ale.configure(settings);
        // restart with these settings
        run.ale.reload(seed);
        run.add(0);
        run
    }

    /// Returns a number below `n`, from the upper half of a linear congruential generator's state.
    fn below(&mut self, n: u32) -> u32 {
        self.random = self
            .random
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        (self.random >> 16) % n
    }

    fn reset(&mut self) {
        self.ale.reset();
        self.add(0);
    }

    /// Plays frames, holding each action for at most 16 of them. Starts a new game one frame after
    /// the end of a game.
    fn play(&mut self, frames: u32, actions: &[Action]) {
        let (mut action, mut held) = (Action::Noop, 0);
        for _ in 0..frames {
            if held == 0 {
                action = actions[self.below(actions.len() as u32) as usize];
                held = 1 + self.below(16);
            }
            held -= 1;
            let was_over = self.ale.game_over();
            let reward = self.ale.act(action);
            self.add(reward);
            if was_over {
                self.reset();
            }
        }
    }

    fn add(&mut self, reward: i32) {
        let Self { ale, sum, .. } = self;
        sum.update(ale.ram().0);
        sum.update(ale.picture().as_flattened());
        sum.update(&reward.to_le_bytes());
        sum.update(&ale.lives().to_le_bytes());
        sum.update(&[ale.game_over().into()]);
        sum.update(&ale.episode_frame_number().to_le_bytes());
        sum.update(&ale.frame_number().to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::games;

    /// A test program that counts frames, and frames in which the button is pressed.
    const PROGRAM: &[u8] = &[
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00, 0xe6,
        0x90, 0xa5, 0x0c, 0x30, 0x02, 0xe6, 0x91, 0xa2, 0xe0, 0x86, 0x09, 0x85, 0x02, 0xca, 0xd0,
        0xf9, 0x4c, 0x00, 0xf0,
    ];

    #[test]
    fn a_sum_that_was_changed_is_found() {
        let mut bytes = vec![0xea; 4096];
        bytes[..PROGRAM.len()].copy_from_slice(PROGRAM);
        bytes[4092..].copy_from_slice(&[0x00, 0xf0, 0x00, 0xf0]);
        let rom = Rom::homebrew(games::by_name("seaquest").unwrap(), &bytes);
        let sums = Sums::of(&rom);
        let line = |Sums {
                        minimal,
                        sticky,
                        modes,
                    }: Sums| {
            format!("others 0 0 0\nseaquest {minimal:08x} {sticky:08x} {modes:08x}\n")
        };
        let found = |changed: Sums| {
            Sums::read(&line(changed), "seaquest")
                .unwrap()
                .differences(&sums)
        };
        assert!(found(sums).is_empty());
        assert_eq!(
            found(Sums {
                minimal: sums.minimal ^ 1,
                ..sums
            }),
            ["the minimal actions"]
        );
        assert_eq!(
            found(Sums {
                sticky: sums.sticky ^ 0x100,
                ..sums
            }),
            ["all actions, sticky ones among them"]
        );
        assert_eq!(
            found(Sums {
                modes: sums.modes ^ 0x8000_0000,
                ..sums
            }),
            ["the modes"]
        );
        assert_eq!(Sums::read(&line(sums), "pong"), None);
        // another program has other checksums
        bytes[1] = 0x03;
        bytes[0x0f] = 0x92;
        let other = Sums::of(&Rom::homebrew(rom.game(), &bytes));
        assert_eq!(sums.differences(&other).len(), 3);
    }

    #[test]
    fn every_game_was_recorded() {
        let missing: Vec<_> = games::GAMES
            .iter()
            .filter(|game| Sums::recorded(game.name).is_none())
            .collect();
        assert!(missing.is_empty(), "{missing:?}");
    }
}
