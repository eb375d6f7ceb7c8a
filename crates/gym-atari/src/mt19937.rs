//! The generator of sticky actions: MT19937, like C++'s `std::mt19937` and numpy's legacy
//! `RandomState`.
//!
//! Source: Matsumoto and Nishimura, "Mersenne Twister", ACM TOMACS 8 (1998).

use std::fmt;

use serde::{Deserialize, Serialize};

const N: usize = 624;
const M: usize = 397;

/// The generator's state.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Mt19937 {
    #[serde(with = "crate::words")]
    state: [u32; N],
    /// The index of the next word; `N` if the state must be updated first.
    next: usize,
}

impl Mt19937 {
    pub(crate) fn new(seed: u32) -> Self {
        let mut state = [seed; N];
        for i in 1..N {
            let before = state[i - 1];
            state[i] = 1_812_433_253u32
                .wrapping_mul(before ^ before >> 30)
                .wrapping_add(i as u32);
        }
        Self { state, next: N }
    }

    fn renew(&mut self) {
        for i in 0..N {
            let joined = self.state[i] & 0x8000_0000 | self.state[(i + 1) % N] & 0x7fff_ffff;
            let twisted = joined >> 1 ^ if joined & 1 == 1 { 0x9908_b0df } else { 0 };
            self.state[i] = self.state[(i + M) % N] ^ twisted;
        }
        self.next = 0;
    }

    fn next_u32(&mut self) -> u32 {
        if self.next >= N {
            self.renew();
        }
        let mut word = self.state[self.next];
        self.next += 1;
        word ^= word >> 11;
        word ^= word << 7 & 0x9d2c_5680;
        word ^= word << 15 & 0xefc6_0000;
        word ^ word >> 18
    }

    /// Returns the lowest byte of the next word.
    pub(crate) fn byte(&mut self) -> u8 {
        self.next_u32() as u8
    }

    /// Returns a number in `[0, 1)` with 53 bits.
    pub(crate) fn random(&mut self) -> f64 {
        let (a, b) = (self.next_u32() >> 5, self.next_u32() >> 6);
        (f64::from(a) * 67_108_864.0 + f64::from(b)) / 9_007_199_254_740_992.0
    }
}

impl fmt::Debug for Mt19937 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Mt19937")
            .field("next", &self.next)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The 10,000th word of `std::mt19937` with the default seed, from the C++ standard.
    #[test]
    fn gives_the_words_of_the_standard() {
        let mut generator = Mt19937::new(5489);
        let last = (0..10_000).map(|_| generator.next_u32()).last();
        assert_eq!(last, Some(4_123_659_995));
    }
}
