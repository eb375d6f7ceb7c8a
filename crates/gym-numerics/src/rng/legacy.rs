//! numpy's legacy generator, `RandomState`, which never changes.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::Seed;
use crate::math;

const N: usize = 624;
const M: usize = 397;

/// numpy's `RandomState`: the same seed gives the same numbers, bit for bit. Without the methods it
/// is MT19937, as C++'s `std::mt19937`.
///
/// ```
/// use gym_numerics::RandomState;
/// let mut rng = RandomState::new(42); // np.random.RandomState(42)
/// assert_eq!(rng.random(), 0.3745401188473625);
/// assert_eq!(rng.uniform(-0.1, 0.1), 0.09014286128198324);
/// assert_eq!(rng.randint(10), 7);
/// ```
///
/// Source: Matsumoto and Nishimura, "Mersenne Twister", ACM TOMACS 8 (1998); numpy 2.4,
/// `random/mtrand.pyx` and `random/src/legacy`.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
#[serde(into = "Stored", try_from = "Stored")]
pub struct RandomState {
    words: [u32; N],
    /// The index of the next word; `N` if the words must be renewed first.
    next: usize,
    /// The second number of the last pair of normal numbers.
    gauss: Option<f64>,
}

/// The stored form, with the words as hexadecimal digits.
#[derive(Serialize, Deserialize)]
struct Stored {
    words: String,
    next: usize,
    gauss: Option<f64>,
}

impl From<RandomState> for Stored {
    fn from(state: RandomState) -> Self {
        let RandomState { words, next, gauss } = state;
        Self {
            words: words.iter().map(|word| format!("{word:08x}")).collect(),
            next,
            gauss,
        }
    }
}

impl TryFrom<Stored> for RandomState {
    type Error = String;

    fn try_from(Stored { words, next, gauss }: Stored) -> Result<Self, String> {
        let is_hexadecimal = words.bytes().all(|byte| byte.is_ascii_hexdigit());
        if !is_hexadecimal || words.len() != 8 * N {
            return Err(format!("the words are not {} hexadecimal digits", 8 * N));
        }
        let word = |i: usize| u32::from_str_radix(&words[8 * i..8 * i + 8], 16);
        let words = std::array::from_fn(|i| word(i).unwrap_or_default());
        if next > N {
            return Err(format!("the next word is {next}, and there are {N}"));
        }
        if gauss.is_some_and(|gauss| !gauss.is_finite()) {
            return Err("the next normal number is not finite".to_owned());
        }
        Ok(Self { words, next, gauss })
    }
}

impl RandomState {
    /// `RandomState(seed)`.
    #[must_use]
    pub fn new(seed: u32) -> Self {
        let mut words = [seed; N];
        for i in 1..N {
            let before = words[i - 1];
            words[i] = 1_812_433_253_u32
                .wrapping_mul(before ^ before >> 30)
                .wrapping_add(i as u32);
        }
        Self {
            words,
            next: N,
            gauss: None,
        }
    }

    /// `RandomState(seed)`; a seed of more than 32 bits, which numpy refuses, counts as the list of
    /// its digits in base 2^32, the lowest first.
    #[must_use]
    pub fn from_seed(seed: &Seed) -> Self {
        match seed.digits() {
            [] => Self::new(0),
            [digit] => Self::new(*digit),
            digits => Self::from_list(digits),
        }
    }

    /// `RandomState(list)`, for a list that is not empty.
    fn from_list(list: &[u32]) -> Self {
        let mut state = Self::new(19_650_218);
        let words = &mut state.words;
        let (mut i, mut j) = (1, 0);
        let mixed = |words: &[u32; N], i: usize, factor: u32| {
            let before = words[i - 1];
            words[i] ^ (before ^ before >> 30).wrapping_mul(factor)
        };
        for _ in 0..N.max(list.len()) {
            words[i] = mixed(words, i, 1_664_525)
                .wrapping_add(list[j])
                .wrapping_add(j as u32);
            (i, j) = (i + 1, (j + 1) % list.len());
            if i == N {
                words[0] = words[N - 1];
                i = 1;
            }
        }
        for _ in 1..N {
            words[i] = mixed(words, i, 1_566_083_941).wrapping_sub(i as u32);
            i += 1;
            if i == N {
                words[0] = words[N - 1];
                i = 1;
            }
        }
        words[0] = 0x8000_0000;
        state
    }

    fn renew(&mut self) {
        let words = &mut self.words;
        for i in 0..N {
            let joined = words[i] & 0x8000_0000 | words[(i + 1) % N] & 0x7fff_ffff;
            let twisted = joined >> 1 ^ if joined & 1 == 1 { 0x9908_b0df } else { 0 };
            words[i] = words[(i + M) % N] ^ twisted;
        }
        self.next = 0;
    }

    /// Draws a word of 32 bits.
    pub fn word(&mut self) -> u32 {
        if self.next >= N {
            self.renew();
        }
        let mut word = self.words[self.next];
        self.next += 1;
        word ^= word >> 11;
        word ^= word << 7 & 0x9d2c_5680;
        word ^= word << 15 & 0xefc6_0000;
        word ^ word >> 18
    }

    /// Draws uniformly from `[0, 1)` with 53 bits: `rand()` and `random_sample()`.
    pub fn random(&mut self) -> f64 {
        let (a, b) = (self.word() >> 5, self.word() >> 6);
        (f64::from(a) * 67_108_864.0 + f64::from(b)) / 9_007_199_254_740_992.0
    }

    /// `uniform(low, high)`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random()
    }

    /// `standard_normal()` and `randn()`: Marsaglia's polar method, which makes pairs.
    pub fn standard_normal(&mut self) -> f64 {
        if let Some(second) = self.gauss.take() {
            return second;
        }
        let (x1, x2, r2) = loop {
            let x1 = 2.0 * self.random() - 1.0;
            let x2 = 2.0 * self.random() - 1.0;
            let r2 = x1 * x1 + x2 * x2;
            if r2 < 1.0 && r2 != 0.0 {
                break (x1, x2, r2);
            }
        };
        let f = (-2.0 * math::ln(r2) / r2).sqrt();
        self.gauss = Some(f * x1);
        f * x2
    }

    /// `randint(n)`: one of `0..n`; 0 for `n` of 0, which numpy refuses.
    pub fn randint(&mut self, n: u32) -> u32 {
        let last = n.saturating_sub(1);
        let mask = last
            .checked_ilog2()
            .map_or(0, |bits| u32::MAX >> (31 - bits));
        if mask == 0 {
            return 0;
        }
        loop {
            let value = self.word() & mask;
            if value <= last {
                return value;
            }
        }
    }

    /// `choice(len(p), p=p)`: an index with these probabilities, which add up to 1.
    pub fn choice(&mut self, p: &[f64]) -> usize {
        let total: f64 = p.iter().sum();
        let drawn = self.random();
        let mut sum = 0.0;
        let beyond = p.iter().position(|p| {
            sum += p;
            drawn < sum / total
        });
        beyond.unwrap_or(p.len().saturating_sub(1))
    }

    /// `permutation(n)`: the numbers below `n` in random order.
    pub fn permutation(&mut self, n: u32) -> Vec<u32> {
        let mut numbers: Vec<u32> = (0..n).collect();
        for i in (1..n).rev() {
            numbers.swap(i as usize, self.randint(i + 1) as usize);
        }
        numbers
    }
}

impl fmt::Debug for RandomState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RandomState")
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
        let mut rng = RandomState::new(5489);
        let last = (0..10_000).map(|_| rng.word()).last();
        assert_eq!(last, Some(4_123_659_995));
    }

    /// From numpy 2.4.6.
    #[test]
    fn draws_are_numpys() {
        let mut rng = RandomState::new(7);
        let normal = [1.690525703800356, -0.4659373705408328, 0.0328201636785844];
        assert_eq!(normal.map(|_| rng.standard_normal()), normal);
        let below = [1, 2, 3, 7, 1000, 1 << 31];
        assert_eq!(
            below.map(|n| rng.randint(n)),
            [0, 0, 1, 6, 554, 1_152_936_666]
        );
        let chosen = [(); 6].map(|()| rng.choice(&[0.1, 0.1, 0.8]));
        assert_eq!(chosen, [0, 2, 2, 2, 2, 2]);
        assert_eq!(rng.permutation(6), [2, 5, 1, 0, 4, 3]);
        assert_eq!(rng.random(), 0.9312060196890217);
        assert_eq!(rng.uniform(-3.0, 5.0), -2.800806179597216);
    }

    #[test]
    fn long_seeds_are_lists() {
        let mut rng = RandomState::from_seed(&Seed::from(5 + (6 << 32)));
        let words = [2_987_887_136, 1_279_590_532, 2_783_427_419];
        assert_eq!(words.map(|_| rng.word()), words);
        let seed = (1..=4).fold(0, |seed, i| seed | (i as u128) << (32 * (i - 1)));
        let mut rng = RandomState::from_seed(&Seed::from_u128(seed));
        assert_eq!(
            [rng.random(), rng.random()],
            [0.6788657548888402, 0.07791415735404539]
        );
        assert_eq!(RandomState::from_seed(&Seed::from(0)), RandomState::new(0));
        assert_eq!(RandomState::from_seed(&Seed::from(9)), RandomState::new(9));
    }

    #[test]
    fn a_restored_generator_continues() {
        let mut rng = RandomState::new(3);
        rng.standard_normal();
        let stored = serde_json::to_value(&rng).unwrap();
        let mut restored: RandomState = serde_json::from_value(stored.clone()).unwrap();
        assert_eq!(restored, rng);
        for _ in 0..700 {
            assert_eq!(restored.standard_normal(), rng.standard_normal());
        }
        for (name, value) in [("words", "00ff".into()), ("next", serde_json::json!(625))] {
            let mut damaged = stored.clone();
            damaged[name] = value;
            assert!(
                serde_json::from_value::<RandomState>(damaged).is_err(),
                "{name}"
            );
        }
    }
}
