//! The chip in the cartridge of Pitfall II: eight data fetchers, a random number generator, and
//! music.
//!
//! Sources: David Crane, US patent 4,644,495 (1987). The result of each address was measured, see
//! `NOTICE.md`.

use serde::{Deserialize, Serialize};

/// The size of the fetchers' data in bytes.
pub(crate) const DATA: usize = 2048;
/// Cartridge addresses below this belong to the chip: the lower half reads, the upper half writes.
pub(crate) const REGISTERS: u16 = 0x80;

/// The chip.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Dpc {
    fetchers: [Fetcher; 8],
    random: u8,
}

/// A data fetcher: returns one byte of the data after another, and tells whether its counter is
/// between `top` and `bottom`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Fetcher {
    top: u8,
    bottom: u8,
    /// An 11-bit counter that counts down.
    counter: u16,
    within: bool,
    /// Whether a clock advances the counter, and not reads. The emulator has no sound, so the clock
    /// does not run.
    music: bool,
}

/// The total amplitude for each combination of the three voices.
const AMPLITUDES: [u8; 8] = [0x0, 0x4, 0x5, 0x9, 0x6, 0xa, 0xb, 0xf];

impl Dpc {
    pub(crate) fn new() -> Self {
        Self {
            fetchers: Default::default(),
            random: 0x7a,
        }
    }

    /// Whether a deserialized chip is consistent.
    pub(crate) fn is_valid(&self) -> bool {
        self.fetchers
            .iter()
            .all(|fetcher| usize::from(fetcher.counter) < DATA)
    }

    /// Reads a register of the lower half.
    pub(crate) fn read(&mut self, register: u16, data: &[u8]) -> u8 {
        self.next_random();
        let (i, function) = (usize::from(register & 0x07), register >> 3 & 0x07);
        let amplitude = [5, 6, 7].map(|voice| usize::from(self.fetchers[voice].within));
        let fetcher = &mut self.fetchers[i];
        let low = fetcher.counter as u8;
        if low == fetcher.top {
            fetcher.within = true;
        } else if low == fetcher.bottom {
            fetcher.within = false;
        }
        let mask = if fetcher.within { 0xff } else { 0x00 };
        let byte = data
            .get(DATA - 1 - usize::from(fetcher.counter))
            .copied()
            .unwrap_or(0);
        if !fetcher.music {
            fetcher.counter = fetcher.counter.wrapping_sub(1) & 0x07ff;
        }
        match function {
            0 if i < 4 => self.random,
            0 => AMPLITUDES[amplitude[0] | amplitude[1] << 1 | amplitude[2] << 2],
            1 => byte,
            2 => byte & mask,
            7 => mask,
            _ => 0,
        }
    }

    /// Writes a register of the upper half.
    pub(crate) fn write(&mut self, register: u16, value: u8) {
        self.next_random();
        let (i, function) = (usize::from(register & 0x07), register >> 3 & 0x07);
        let fetcher = &mut self.fetchers[i];
        match function {
            0 => {
                fetcher.top = value;
                fetcher.within = false;
            }
            1 => fetcher.bottom = value,
            2 => {
                let low = if fetcher.music { fetcher.top } else { value };
                fetcher.counter = fetcher.counter & 0x0700 | u16::from(low);
            }
            3 => {
                fetcher.counter = u16::from(value & 0x07) << 8 | fetcher.counter & 0x00ff;
                fetcher.music = i > 4 && value & 0x10 != 0;
                if fetcher.music {
                    fetcher.counter = fetcher.counter & 0x0700 | u16::from(fetcher.top);
                }
            }
            6 => self.random = 1,
            _ => {}
        }
    }

    /// Steps the shift register that generates random numbers. Each access to the chip does this.
    fn next_random(&mut self) {
        let taps = self.random & 0b1011_1000;
        self.random = self.random << 1 | u8::from(taps.count_ones().is_multiple_of(2));
    }
}
