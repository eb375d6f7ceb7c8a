//! Recordings of a game in ale-py, frame by frame, to compare with this crate. They contain neither
//! ROM nor pictures.

use gym_core::{Error, Result};
use serde::{Deserialize, Serialize};

use crate::action::Action;
use crate::ale::{Ale, Settings};
use crate::rom::Rom;

/// A recorded game. Each list has one entry per operation.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Recording {
    /// Always `raw`.
    pub kind: String,
    /// The game, under ale-py's name.
    pub rom: String,
    /// The MD5 of its ROM.
    pub md5: String,
    /// The mode; `None` for the default.
    pub mode: Option<u16>,
    /// The difficulty; `None` for the default.
    pub difficulty: Option<u8>,
    /// The state at the start.
    pub start: Start,
    /// The operations: 0 to 17 plays a frame with an action, -1 starts an episode.
    pub ops: Vec<i8>,
    /// The RAM bytes that changed: two hexadecimal digits of index and two of value each.
    pub ram: Vec<String>,
    /// Checksums of the picture's colour indices.
    pub screen: Vec<String>,
    /// Checksums of the gray picture, if recorded.
    pub gray: Vec<String>,
    /// Checksums of the colour picture, if recorded.
    pub rgb: Vec<String>,
    /// The rewards.
    pub reward: Vec<i32>,
    /// The lives.
    pub lives: Vec<i32>,
    /// Whether the game is over: 0 or 1.
    pub over: Vec<u8>,
    /// The number of the frame in its episode.
    pub frame: Vec<u32>,
}

/// The state before the first operation.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Start {
    /// The RAM.
    pub ram: String,
    /// A checksum of the picture.
    pub screen: String,
    /// The lives.
    pub lives: i32,
}

impl Recording {
    /// Plays the same operations and returns their recording.
    ///
    /// # Errors
    /// [`Error::Custom`] if the ROM is of another game, or an operation is invalid.
    pub fn replay(&self, rom: &Rom) -> Result<Self> {
        if rom.game().md5 != self.md5 {
            return Err(Error::custom(format!(
                "this is a recording of {}, not of {}",
                self.rom,
                rom.game().name
            )));
        }
        let mut ale = Ale::new(rom.game(), rom.bytes(), 0);
        ale.configure(Settings {
            mode: self.mode,
            difficulty: self.difficulty,
            ..Settings::default()
        });
        ale.reset();
        let mut answers = Self {
            start: Start {
                ram: crate::bytes::encode(ale.ram().0),
                screen: screen(&ale),
                lives: ale.lives(),
            },
            ram: Vec::new(),
            screen: Vec::new(),
            gray: Vec::new(),
            rgb: Vec::new(),
            reward: Vec::new(),
            lives: Vec::new(),
            over: Vec::new(),
            frame: Vec::new(),
            ..self.clone()
        };
        let mut before = *ale.ram().0;
        for (i, &op) in self.ops.iter().enumerate() {
            let action = usize::try_from(op)
                .ok()
                .and_then(|index| Action::ALL.get(index));
            let reward = match (op, action) {
                (-1, _) => {
                    ale.reset();
                    0
                }
                (_, Some(&action)) => ale.act(action),
                _ => {
                    return Err(Error::custom(format!(
                        "operation {i} is {op}: it must be -1 to 17"
                    )));
                }
            };
            let now = *ale.ram().0;
            let changes = (0..now.len()).filter(|&index| now[index] != before[index]);
            let changes: Vec<_> = changes
                .map(|index| format!("{index:02x}{:02x}", now[index]))
                .collect();
            before = now;
            let wanted =
                |recorded: &[String]| recorded.get(i).is_some_and(|checksum| !checksum.is_empty());
            answers.ram.push(changes.join(" "));
            answers.screen.push(screen(&ale));
            answers.gray.push(if wanted(&self.gray) {
                gray(&ale)
            } else {
                String::new()
            });
            answers.rgb.push(if wanted(&self.rgb) {
                rgb(&ale)
            } else {
                String::new()
            });
            answers.reward.push(reward);
            answers.lives.push(ale.lives());
            answers.over.push(ale.game_over().into());
            answers.frame.push(ale.episode_frame_number());
        }
        Ok(answers)
    }

    /// Compares with another recording of the same operations; returns the first operation and list
    /// that differ.
    pub fn first_difference(&self, other: &Self) -> Option<String> {
        if self.start != other.start {
            return Some("the start".to_owned());
        }
        let lists = [
            self.ram.len(),
            self.screen.len(),
            self.gray.len(),
            self.rgb.len(),
            self.reward.len(),
            self.lives.len(),
            self.over.len(),
            self.frame.len(),
        ];
        // up to the end of the longest list: a list may have more results than there are operations
        let longest = lists.into_iter().fold(self.ops.len(), usize::max);
        (0..longest).find_map(|i| {
            let parts = [
                ("RAM", self.ram.get(i) == other.ram.get(i)),
                ("picture", self.screen.get(i) == other.screen.get(i)),
                ("gray", self.gray.get(i) == other.gray.get(i)),
                ("colours", self.rgb.get(i) == other.rgb.get(i)),
                ("reward", self.reward.get(i) == other.reward.get(i)),
                ("lives", self.lives.get(i) == other.lives.get(i)),
                ("end", self.over.get(i) == other.over.get(i)),
                ("frame number", self.frame.get(i) == other.frame.get(i)),
            ];
            parts
                .iter()
                .find(|(_, equal)| !equal)
                .map(|(part, _)| format!("operation {i}: {part}"))
        })
    }
}

fn checksum(bytes: &[u8]) -> String {
    format!("{:08x}", crc32fast::hash(bytes))
}

fn screen(ale: &Ale) -> String {
    checksum(ale.picture().as_flattened())
}

fn gray(ale: &Ale) -> String {
    let pixels = ale.picture().as_flattened().iter();
    checksum(
        &pixels
            .map(|&index| ale.game().display.gray()[usize::from(index)])
            .collect::<Vec<_>>(),
    )
}

fn rgb(ale: &Ale) -> String {
    let pixels = ale.picture().as_flattened().iter();
    checksum(
        &pixels
            .flat_map(|&index| ale.game().display.rgb()[usize::from(index)])
            .collect::<Vec<_>>(),
    )
}
