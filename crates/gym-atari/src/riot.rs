//! The 6532 RIOT: 128 bytes of RAM, two ports, and the interval timer.
//!
//! Addresses and registers are those of the Stella Programmer's Guide (1979), section "The PIA".
//! The timer's values after the end of its interval were measured: see `NOTICE.md`.

use serde::{Deserialize, Serialize};

/// RAM, ports and timer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Riot {
    /// The machine's RAM, `$80` to `$FF` of the processor.
    #[serde(with = "crate::bytes")]
    pub ram: [u8; 128],
    /// Port A's bits from the controllers, read at `SWCHA`.
    pub port_a: u8,
    /// Port B's bits from the console's switches, read at `SWCHB`.
    pub port_b: u8,
    swcha: u8,
    swacnt: u8,
    swchb: u8,
    swbcnt: u8,
    timer: Timer,
}

impl Riot {
    /// Makes a RIOT at power-on: the timer runs as if `timer` had been written to `TIM64T`.
    pub fn new(ram: [u8; 128], timer: u8) -> Self {
        Self {
            ram,
            port_a: 0xff,
            port_b: 0xff,
            swcha: 0,
            swacnt: 0,
            swchb: 0,
            swbcnt: 0,
            timer: Timer {
                value: timer,
                shift: 6,
                written: 0,
                read_after_end: None,
            },
        }
    }

    /// Whether a deserialized RIOT is consistent at `cycle`.
    pub(crate) fn is_valid(&self, cycle: u64) -> bool {
        let Timer {
            value: _,
            shift,
            written,
            read_after_end,
        } = self.timer;
        written <= cycle
            && shift <= 10
            && read_after_end.is_none_or(|below| below.unsigned_abs() < 1 << 61)
    }

    /// Reads a register at `cycle`.
    pub fn read(&mut self, address: u16, cycle: u64) -> u8 {
        match address & 0x07 {
            0 => self.port_a & (self.swcha | !self.swacnt), // SWCHA
            1 => self.swacnt,                               // SWACNT
            2 => self.port_b & (self.swchb | !self.swbcnt), // SWCHB
            3 => self.swbcnt,                               // SWBCNT
            4 | 6 => self.timer.intim(cycle),               // INTIM
            _ => self.timer.instat(cycle),                  // INSTAT
        }
    }

    /// Returns the value of `INTIM` at `cycle`, and the cycle up to which the value stays the same
    /// without other accesses; `None` for other registers.
    pub(crate) fn steady(&self, address: u16, cycle: u64) -> Option<(u8, u64)> {
        match address & 0x07 {
            4 | 6 => self.timer.steady(cycle), // INTIM
            _ => None,
        }
    }

    /// Returns the first cycle at which `INTIM` reads as 0, if `address` is `INTIM` and the timer
    /// has not yet counted down.
    pub(crate) fn zero_from(&self, address: u16) -> Option<u64> {
        let Timer {
            value,
            shift,
            written,
            ..
        } = self.timer;
        let is_intim = address & 0x1280 == 0x0280 && matches!(address & 0x07, 4 | 6);
        (is_intim && value > 0).then(|| written + 1 + (u64::from(value - 1) << shift))
    }

    /// Returns the value of `INTIM` at a cycle before the end of the interval.
    pub(crate) fn count(&self, cycle: u64) -> u8 {
        self.timer.count(cycle).1 as u8
    }

    /// Writes a register at `cycle`.
    #[inline(never)]
    pub fn write(&mut self, address: u16, value: u8, cycle: u64) {
        match (address & 0x14, address & 0x03) {
            // TIM1T, TIM8T, TIM64T, T1024T
            (0x14, interval) => {
                let shift = [0, 3, 6, 10][usize::from(interval)];
                self.timer = Timer {
                    value,
                    shift,
                    written: cycle,
                    read_after_end: None,
                };
            }
            (0x04, _) => {} // PA7 edge detection: not connected
            (_, 0) => self.swcha = value,
            (_, 1) => self.swacnt = value,
            (_, 2) => self.swchb = value,
            (_, _) => self.swbcnt = value,
        }
    }
}

/// The interval timer: counts down once per interval, and once per cycle after 0.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Timer {
    value: u8,
    /// The interval is `1 << shift` cycles.
    shift: u8,
    written: u64,
    /// The value of the first read after the end of the interval. This read switches the timer back
    /// to counting intervals.
    #[serde(deserialize_with = "Option::deserialize")]
    read_after_end: Option<i64>,
}

impl Timer {
    /// Returns the cycles since the write, and the count, which is negative after the end.
    fn count(&self, cycle: u64) -> (i64, i64) {
        let elapsed = cycle as i64 - self.written as i64 - 1;
        (elapsed, i64::from(self.value) - (elapsed >> self.shift) - 1)
    }

    fn intim(&mut self, cycle: u64) -> u8 {
        let (elapsed, count) = self.count(cycle);
        if count >= 0 {
            return count as u8;
        }
        let below = (i64::from(self.value) << self.shift) - elapsed - 1;
        if self.read_after_end.is_none() && below < -1 {
            self.read_after_end = Some(below);
        }
        match self.read_after_end {
            Some(first) => (first + i64::from(self.value) - (elapsed >> self.shift)) as u8,
            None => below as u8,
        }
    }

    /// Returns the value of `INTIM` at `cycle`, and the cycle up to which the value stays the same;
    /// `None` after the end of the interval, when a read changes the timer.
    fn steady(&self, cycle: u64) -> Option<(u8, u64)> {
        let (elapsed, count) = self.count(cycle);
        if count < 0 || elapsed < 0 {
            return None;
        }
        let passed = elapsed & ((1 << self.shift) - 1);
        Some((count as u8, cycle + ((1 << self.shift) - 1 - passed) as u64))
    }

    fn instat(&self, cycle: u64) -> u8 {
        let ended = self.count(cycle).1 < 0 && self.read_after_end.is_none();
        if ended { 0x80 } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_power_on_both_ports_are_inputs_and_nothing_is_pressed() {
        let mut riot = Riot::new([0; 128], 0);
        let ports = [0, 1, 2, 3].map(|register| riot.read(register, 0));
        assert_eq!(ports, [0xff, 0, 0xff, 0]);
    }
}
