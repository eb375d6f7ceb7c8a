//! Games whose score is not the number that its digits form.

use super::Ram;

impl Ram<'_> {
    /// Blackjack: the digits are blank if no points are left.
    pub(super) fn blackjack(&self) -> i32 {
        if self.blackjack_is_blank() {
            0
        } else {
            self.decimal(&[0x06, 0x09])
        }
    }

    /// Blackjack: the game ends with 1,000 points, or without points.
    pub(super) fn blackjack_is_over(&self) -> bool {
        self.blackjack() >= 1000 || self.blackjack_is_blank()
    }

    fn blackjack_is_blank(&self) -> bool {
        self.at(0x06) == 0x0b && self.at(0x09) == 0xbb
    }

    /// Boxing: a knockout, 100 points, shows as `C0`.
    pub(super) fn boxing(&self, index: usize) -> i32 {
        if self.at(index) == 0xc0 {
            100
        } else {
            self.bcd(index)
        }
    }

    /// Casino: whether the game is over. In mode 3, the game is over once there are points and the
    /// program does not wait; in other modes, if no points are left.
    pub(super) fn casino_is_over(&self) -> bool {
        let (points, waits) = (
            self.at(0x0c) | self.at(0x15) != 0,
            self.at(0x53) & 0x80 != 0,
        );
        match self.at(0x54) {
            3 => points && !waits,
            _ => !points || (waits && self.at(0x1e) != 0),
        }
    }

    /// Demon Attack: until the first game, the score's bytes hold the title.
    pub(super) fn demon_attack(&self) -> i32 {
        let title = [0x01, 0x03, 0x05].map(|index| self.at(index)) == [0xab, 0xcd, 0xea];
        if title {
            0
        } else {
            self.decimal(&[0x01, 0x03, 0x05])
        }
    }

    /// Double Dunk: the game is over when a team has 24 points and the program waits for the next
    /// game.
    pub(super) fn double_dunk_is_over(&self) -> bool {
        self.bcd(0x76).max(self.bcd(0x77)) >= 24 && self.at(0x7e) == 0xe7
    }

    /// Enduro: counts down the cars to pass, from 200 on the first day and from 300 on later days.
    pub(super) fn enduro(&self) -> i32 {
        let (day, left) = (self.at(0x2d), 100 * self.bcd(0x2c) + self.bcd(0x2b));
        match day {
            0 => 0,
            1 => 200 - left,
            _ => 200 + 300 * (day - 1) - left,
        }
    }

    /// Superman: the score at the end is the remaining time of 99:59.
    pub(super) fn superman(&self) -> i32 {
        if self.superman_is_over() {
            5999 - 60 * self.bcd(0x63) - self.bcd(0x62)
        } else {
            0
        }
    }

    /// Superman: whether the player is at the place where the game ends, as these bytes show.
    pub(super) fn superman_is_over(&self) -> bool {
        self.at(0x00) == 0xac && self.at(0x01) == 0xf2 && self.at(0x1f) & 0x40 != 0
    }

    /// Tic-Tac-Toe 3D: 1 for a won game, -1 for any other finished game.
    pub(super) fn tic_tac_toe_3d(&self) -> i32 {
        match (self.tic_tac_toe_3d_is_over(), self.at(0x61)) {
            (false, _) => 0,
            (true, 0x08) => 1,
            (true, _) => -1,
        }
    }

    /// Tic-Tac-Toe 3D: the return addresses on the stack show that the game is over.
    pub(super) fn tic_tac_toe_3d_is_over(&self) -> bool {
        self.at(0x7e) == 0x10 && self.at(0x7f) == 0xf3
    }

    /// Video Chess: one byte shows that the game is over, another byte shows the winner.
    pub(super) fn video_chess_is_over(&self) -> bool {
        self.at(0x61) == 0x82 && self.at(0x6e) <= 1
    }
}
