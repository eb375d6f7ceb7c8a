//! The arguments of the environments, as in ale-py's `AtariEnv`.

use std::path::PathBuf;

use gym_core::{ArgumentType, Error, Result};
use serde::{Deserialize, Serialize};

use crate::games::{self, Game};

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The game, under ale-py's name: `space_invaders`.
        pub game: String = "pong".to_owned(),
        /// The game's mode; `None` for its default.
        pub mode: Option<u16>,
        /// The difficulty; `None` for the game's default.
        pub difficulty: Option<u8>,
        /// The observation: `rgb`, `grayscale` or `ram`.
        pub obs_type: ObsType = ObsType::Rgb,
        /// The number of frames for each action: a number, or a range `[low, high)` from which each
        /// step draws one.
        pub frameskip: Frameskip = Frameskip::Fixed(4),
        /// The probability with which a frame repeats the action of the frame before.
        pub repeat_action_probability: f64 = 0.25,
        /// All 18 actions, instead of those with an effect in the game.
        pub full_action_space: bool,
        /// Actions are a stick's radius and angle and a button's pressure.
        pub continuous: bool,
        /// The radius and the pressure above which a continuous action counts.
        pub continuous_action_threshold: f64 = 0.5,
        /// The number of frames after which an episode is truncated; `None` for never.
        #[unit = "frames"]
        pub max_num_frames_per_episode: Option<u32>,
        /// Observing sound is not supported.
        pub sound_obs: bool,
        /// A folder with ROMs; `None` for `ALE_ROMS_DIR` or an installed ale-py.
        pub rom_dir: Option<PathBuf>,
    }
}

impl ArgumentType for ObsType {
    fn kind() -> String {
        String::kind()
    }
}

impl ArgumentType for Frameskip {
    fn kind() -> String {
        "integer or list of 2 integers".to_owned()
    }
}

/// The kind of observation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ObsType {
    /// The picture in red, green and blue.
    Rgb,
    /// The picture in shades of gray.
    Grayscale,
    /// The RAM.
    Ram,
}

/// The number of frames for each action.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a whole number, or a list of two, [low, high]"
)]
pub enum Frameskip {
    /// A fixed number.
    Fixed(i64),
    /// At least the first number, and less than the second.
    Range([i64; 2]),
}

/// The largest number of frames in a step, so that no step takes forever.
const MOST_FRAMES: i64 = 10_000;

impl Config {
    /// Checks the arguments, and returns the game.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument that is invalid for the game.
    pub(super) fn check(&self) -> Result<&'static Game> {
        let invalid =
            |reason: String| Err(Error::argument(format!("Atari ({})", self.game), reason));
        let Some(game) = games::by_name(&self.game) else {
            let first = self.game.chars().next().map(|c| c.to_ascii_lowercase());
            let names = games::GAMES.iter().map(|game| game.name);
            let alike: Vec<_> = names.filter(|name| name.chars().next() == first).collect();
            return invalid(if alike.is_empty() {
                "unknown game: games have the names of their ROMs, such as breakout".into()
            } else {
                format!(
                    "unknown game: those that begin alike are {}",
                    alike.join(", ")
                )
            });
        };
        match self.frameskip {
            Frameskip::Range([low, _]) if low <= 0 => {
                return invalid(
                    "Invalid stochastic frameskip, lower bound must be positive.".into(),
                );
            }
            Frameskip::Range([low, high]) if low >= high => {
                return invalid(
                    "Invalid stochastic frameskip, lower bound must be strictly less than upper bound."
                        .into(),
                );
            }
            Frameskip::Fixed(skip) if skip <= 0 => {
                return invalid(format!(
                    "Invalid frameskip of {skip}, frameskip must be positive."
                ));
            }
            Frameskip::Fixed(skip) | Frameskip::Range([_, skip]) if skip > MOST_FRAMES => {
                return invalid(format!(
                    "frameskip is {skip}: it must be at most {MOST_FRAMES}"
                ));
            }
            _ => {}
        }
        let modes: Vec<_> = game.modes.iter().map(|(number, _)| *number).collect();
        if let Some(mode) = self.mode.filter(|mode| !modes.contains(mode)) {
            return invalid(format!(
                "Invalid game mode requested: mode is {mode}, and the modes are {modes:?}"
            ));
        }
        if let Some(difficulty) = self
            .difficulty
            .filter(|difficulty| !game.difficulties.contains(difficulty))
        {
            return invalid(format!(
                "Invalid difficulty requested: difficulty is {difficulty}, and the difficulties are {:?}",
                game.difficulties
            ));
        }
        if !self.repeat_action_probability.is_finite() || self.repeat_action_probability < 0.0 {
            return invalid(format!(
                "repeat_action_probability is {}: it is a probability, 0 to 1",
                self.repeat_action_probability
            ));
        }
        if !self.continuous_action_threshold.is_finite() {
            return invalid(format!(
                "continuous_action_threshold is {}: it must be a finite number",
                self.continuous_action_threshold
            ));
        }
        if self.sound_obs {
            return invalid(
                "sound_obs is true: sound is not emulated, so it cannot be observed".into(),
            );
        }
        Ok(game)
    }
}
