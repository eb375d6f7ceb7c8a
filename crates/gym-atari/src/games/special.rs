//! Games whose numbers are no plain sum of digits.

use super::Ram;

impl Ram<'_> {
    /// Boxing: a knockout, 100 points, shows as `C0`.
    pub(super) fn boxing(&self, index: usize) -> i32 {
        if self.at(index) == 0xc0 { 100 } else { self.bcd(index) }
    }

    /// Demon Attack: until the first game the bytes of the score hold the title.
    pub(super) fn demon_attack(&self) -> i32 {
        let title = [0x01, 0x03, 0x05].map(|index| self.at(index)) == [0xab, 0xcd, 0xea];
        if title { 0 } else { self.decimal(&[0x01, 0x03, 0x05]) }
    }

    /// Double Dunk: the game is over when the program waits for another, after a team has 24 points.
    pub(super) fn double_dunk_is_over(&self) -> bool {
        self.bcd(0x76).max(self.bcd(0x77)) >= 24 && self.at(0x7e) == 0xe7
    }

    /// Enduro counts the cars that are left to pass, 200 on the first day and 300 on each one after it.
    pub(super) fn enduro(&self) -> i32 {
        let (day, left) = (self.at(0x2d), 100 * self.bcd(0x2c) + self.bcd(0x2b));
        match day {
            0 => 0,
            1 => 200 - left,
            _ => 200 + 300 * (day - 1) - left,
        }
    }
}
