//! Comparison of games with ale-py 0.12.1, by checksums.
//!
//! `examples/recorded.py` plays the same with ale-py and writes `recorded.txt`.

use crc32fast::Hasher;

use crate::action::Action;
use crate::ale::{Ale, Settings};
use crate::rom::Rom;

/// A line for each game: its name and its three checksums.
const RECORDED: &str = include_str!("recorded.txt");
/// The frames of each of the two long runs.
const FRAMES: u32 = 1000;
/// The frames of each of the two episodes in a mode.
const MODE_FRAMES: u32 = 60;

/// Checksums of RAM, picture, reward, lives, end and frame numbers after every frame and reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sums {
    /// Of 1,000 frames of the minimal actions.
    pub minimal: u32,
    /// Of 1,000 frames of all actions, of which a quarter repeat the one before.
    pub sticky: u32,
    /// Of two episodes of 60 frames in each mode with each difficulty.
    pub modes: u32,
}

impl Sums {
    /// The checksum of ale-py 0.12.1; `None` for a game that was not recorded.
    pub fn recorded(game: &str) -> Option<Self> {
        let line = RECORDED.lines().find(|line| line.split(' ').next() == Some(game))?;
        let mut sums = line.split(' ').skip(1).map(|sum| u32::from_str_radix(sum, 16).ok());
        let mut next = || sums.next().flatten();
        Some(Self { minimal: next()?, sticky: next()?, modes: next()? })
    }

    /// What this crate gives.
    pub fn of(rom: &Rom) -> Self {
        let game = rom.game();
        let run = |seed, actions: &[Action], stickiness| {
            let mut run = Run::new(rom, seed, Settings::default());
            run.play(FRAMES, actions, stickiness);
            run.sum.finalize()
        };
        let mut modes = Hasher::new();
        for &(mode, _) in game.modes {
            for &difficulty in game.difficulties {
                let settings =
                    Settings { mode: Some(mode), difficulty: Some(difficulty), ..Settings::default() };
                let mut run = Run::new(rom, 3, settings);
                run.play(MODE_FRAMES, game.minimal, 0.0);
                run.reset();
                run.play(MODE_FRAMES, game.minimal, 0.0);
                modes.update(&run.sum.finalize().to_le_bytes());
            }
        }
        Self { minimal: run(1, game.minimal, 0.0), sticky: run(2, game.legal, 0.25), modes: modes.finalize() }
    }
}

/// A game that is played at random, and the sum of what came of it.
struct Run {
    ale: Ale,
    sum: Hasher,
    random: u32,
}

impl Run {
    fn new(rom: &Rom, seed: u32, settings: Settings) -> Self {
        let mut run = Self { ale: Ale::new(rom.game(), rom.bytes(), seed), sum: Hasher::new(), random: seed };
        run.ale.configure(settings);
        run.reset();
        run
    }

    /// A number below `n`, from the upper half of a linear congruential generator's state.
    fn below(&mut self, n: u32) -> u32 {
        self.random = self.random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.random >> 16) % n
    }

    fn reset(&mut self) {
        self.ale.reset();
        self.add(0);
    }

    /// Plays frames, holding each action for up to 16; a game that is over gets one more and starts again.
    fn play(&mut self, frames: u32, actions: &[Action], stickiness: f64) {
        let (mut action, mut held) = (Action::Noop, 0);
        for _ in 0..frames {
            if held == 0 {
                action = actions[self.below(actions.len() as u32) as usize];
                held = 1 + self.below(16);
            }
            held -= 1;
            let was_over = self.ale.game_over();
            let reward = self.ale.act(action, stickiness);
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
