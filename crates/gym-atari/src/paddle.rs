//! A paddle: a variable resistor that charges a capacitor. Programs measure the time.
//!
//! The time follows the formula of a resistor and a capacitor. The constants were fitted to
//! recordings of Breakout and Pong, which the emulator reproduces exactly. The left ends of other
//! games were measured by turning a paddle through its whole range in small steps.

use serde::{Deserialize, Serialize};

/// The position of a paddle, as its resistance in ohms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Paddle(u32);

/// The resistance at the right end, in ohms. The resistance at the left end depends on the game.
const LEAST: u32 = 27_450;
/// The change of resistance per frame of an action, in ohms.
const STEP: f64 = 23_000.0;
/// The processor's cycles per second.
const CYCLES_PER_SECOND: f64 = 1.19e6;
/// The capacitor, in farads.
const CAPACITY: f64 = 0.01e-6;

impl Paddle {
    /// Returns the position halfway between the right end and the left end `end`.
    pub(crate) fn middle(end: u32) -> Self {
        Self((LEAST + end) / 2)
    }

    /// Turns the paddle for a frame at the fraction `strength` of its full speed: `direction` 1 is
    /// right, -1 is left.
    pub(crate) fn turn(&mut self, direction: i32, strength: f32, end: u32) {
        let change = i64::from(direction) * i64::from((STEP * f64::from(strength)) as i32);
        self.0 = (i64::from(self.0) - change).clamp(LEAST.into(), end.into()) as u32;
    }

    /// Returns the colour clocks until the capacitor is charged.
    pub(crate) fn charge(self) -> u32 {
        let cycles = 1.6 * f64::from(self.0) * CAPACITY * CYCLES_PER_SECOND;
        3 * (cycles as u32 + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strength_is_a_share_of_the_speed_and_the_ends_hold() {
        const MOST: u32 = 790_196;
        let middle = Paddle::middle(MOST);
        for (direction, strength, change) in [
            (1, 1.0, -23_000),
            (-1, 1.0, 23_000),
            (1, 0.5, -11_500),
            (-1, 0.333, 7_659),
            (1, 0.0, 0),
            (0, 1.0, 0),
        ] {
            let mut paddle = middle;
            paddle.turn(direction, strength, MOST);
            assert_eq!(
                i64::from(paddle.0) - i64::from(middle.0),
                change,
                "{direction} {strength}"
            );
        }
        // the left end depends on the game
        for most in [MOST, 795_000] {
            for (direction, end) in [(1, LEAST), (-1, most)] {
                for strength in [1e9, f32::INFINITY] {
                    let mut paddle = middle;
                    paddle.turn(direction, strength, most);
                    assert_eq!(paddle, Paddle(end));
                }
            }
        }
    }
}
