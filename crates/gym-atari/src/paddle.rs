//! A paddle: a resistor that charges a capacitor, which the program times.
//!
//! The law is that of a resistor and a capacitor; its numbers were fitted to recordings of Breakout and Pong, which come
//! out exactly.

use serde::{Deserialize, Serialize};

/// How far a paddle is turned, as its resistance in ohms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Paddle(u32);

/// The resistance at either end.
const LEAST: u32 = 27_450;
const MOST: u32 = 790_196;
/// What an action changes in a frame.
const STEP: u32 = 23_000;
/// The processor's cycles in a second.
const CYCLES_PER_SECOND: f64 = 1.19e6;
/// The capacitor, in farads.
const CAPACITY: f64 = 0.01e-6;

impl Default for Paddle {
    /// In the middle.
    fn default() -> Self {
        Self((LEAST + MOST) / 2)
    }
}

impl Paddle {
    /// Turns it for a frame: `1` to the right, `-1` to the left.
    pub(crate) fn turn(&mut self, direction: i32) {
        self.0 = match direction {
            1 => self.0.saturating_sub(STEP).max(LEAST),
            -1 => self.0.saturating_add(STEP).min(MOST),
            _ => self.0,
        };
    }

    /// The colour clocks until the capacitor is charged.
    pub(crate) fn charge(self) -> u32 {
        let cycles = 1.6 * f64::from(self.0) * CAPACITY * CYCLES_PER_SECOND;
        3 * (cycles as u32 + 1)
    }
}
