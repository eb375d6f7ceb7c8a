//! Randomness, bit for bit numpy's:
//! `np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed)))`.
//!
//! [`Generator`] has the methods of numpy's generator that Gymnasium's environments, spaces and
//! wrappers call. Each method uses the same words in the same order as numpy 2 (read at v2.4.6), so
//! the same seed gives the same episode in both languages.
//!
//! No method panics. Where numpy raises, as for an empty range or a probability above one, a method
//! returns a documented value instead: check users' arguments first.

mod integers;
mod legacy;
mod seed;
mod state;
mod stream;
mod ziggurat;
mod ziggurat_tables;

use std::convert::Infallible;

use rand::rand_core::utils::fill_bytes_via_next_word;
use rand::{Rng, TryRng};
use rand_pcg::Pcg64;

pub use legacy::RandomState;
pub use seed::{Seed, SeedError};
pub use stream::{Stream, WordStream};

/// numpy's `Generator` over `PCG64`: the same seed gives the same numbers, bit for bit.
///
/// ```
/// use gym_numerics::Generator;
/// let mut rng = Generator::from(42); // np.random.default_rng(42)
/// assert_eq!(rng.random(), 0.7739560485559633);
/// assert_eq!(rng.uniform(-0.05, 0.05), -0.006112156024794771);
/// assert_eq!(rng.integers(0, 10), 4);
/// ```
///
/// It implements [`rand::Rng`], so rand's distributions work with it. Call rand's `random` as
/// `rand::RngExt::random`, because this type has its own `random`. The stored form includes the
/// position in the stream: a restored generator continues where the stored one was.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(into = "[u64; 5]", try_from = "[u64; 5]")]
pub struct Generator {
    pcg: Pcg64,
    /// The unused high half of the last word that was drawn for 32 bits: numpy's `has_uint32` and
    /// `uinteger`. Drawing whole words does not use it.
    half: Option<u32>,
}

impl Generator {
    /// `np.random.default_rng(seed)`.
    pub fn new(seed: &Seed) -> Self {
        let [state_high, state_low, stream_high, stream_low] = seed::generate_state(seed);
        let join = |high, low| u128::from(high) << 64 | u128::from(low);
        Self {
            pcg: Pcg64::new(join(state_high, state_low), join(stream_high, stream_low)),
            half: None,
        }
    }

    /// Makes a generator seeded by the operating system. To know the seed, use [`Seed::from_os`].
    ///
    /// # Errors
    /// The errors of [`Seed::from_os`].
    pub fn from_os() -> Result<Self, SeedError> {
        Ok(Self::new(&Seed::from_os()?))
    }

    /// Draws uniformly from `[0, 1)` with 53 bits.
    #[inline]
    pub fn random(&mut self) -> f64 {
        const UNIT: f64 = 1.0 / (1u64 << 53) as f64;
        (self.next_u64() >> 11) as f64 * UNIT
    }

    /// Draws uniformly from `[0, 1)` with 24 bits: numpy's `random(dtype=np.float32)`.
    #[inline]
    pub fn random_f32(&mut self) -> f32 {
        const UNIT: f32 = 1.0 / (1u32 << 24) as f32;
        (self.next_u32() >> 8) as f32 * UNIT
    }

    /// Returns `low + (high - low) * random()`, for any two numbers.
    #[inline]
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random()
    }
}

impl From<u64> for Generator {
    fn from(seed: u64) -> Self {
        Self::new(&Seed::from(seed))
    }
}

/// Returns numpy's words: 64 bits are a word of PCG64; 32 bits are its low half and, at the next
/// call, its high half; bytes are those of numpy's `Generator.bytes`.
impl TryRng for Generator {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        if let Some(high) = self.half.take() {
            return Ok(high);
        }
        let word = self.next_u64();
        self.half = Some((word >> 32) as u32);
        Ok(word as u32)
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.pcg.try_next_u64()
    }

    fn try_fill_bytes(&mut self, dst: &mut [u8]) -> Result<(), Infallible> {
        fill_bytes_via_next_word(dst, || self.try_next_u32())
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand::seq::IndexedRandom;

    use super::*;

    #[test]
    fn uniform_numbers_are_numpys() {
        for (seed, word, random, uniform) in [
            (
                0,
                0xa30f_ebcf_d9c2_825f,
                [0.6369616873214543, 0.2697867137638703],
                [0.013696168732145436, -0.02302132862361297],
            ),
            (
                42,
                0xc621_fbcd_16d9_2688,
                [0.7739560485559633, 0.4388784397520523],
                [0.027395604855596334, -0.006112156024794771],
            ),
            (
                123,
                0xaeae_9c99_03f3_e9cd,
                [0.6823518632481435, 0.053821018802222675],
                [0.018235186324814343, -0.04461789811977773],
            ),
        ] {
            let start = Generator::from(seed);
            assert_eq!(start.clone().next_u64(), word);
            let mut rng = start.clone();
            assert_eq!(random.map(|_| rng.random()), random);
            let mut rng = start;
            assert_eq!(uniform.map(|_| rng.uniform(-0.05, 0.05)), uniform);
        }
    }

    #[test]
    fn halves_and_bytes_are_numpys() {
        let mut rng = Generator::from(42);
        assert_eq!(
            [(); 4].map(|()| rng.random_f32()),
            [0.08925092, 0.773956, 0.6545715, 0.43887842]
        );
        let mut rng = Generator::from(42);
        assert_eq!(
            [(); 4].map(|()| rng.next_u32()),
            [383329928, 3324115917, 2811363265, 1884968545]
        );
        let (mut rng, mut bytes) = (Generator::from(42), [0; 11]);
        rng.fill_bytes(&mut bytes);
        assert_eq!(bytes, [136, 38, 217, 22, 205, 251, 33, 198, 193, 255, 145]);
        assert!(rng.half.is_some());
    }

    #[test]
    fn rands_distributions_work() {
        let mut rng = Generator::from(1);
        let rolls: Vec<u8> = (0..600).map(|_| rng.random_range(1..=6)).collect();
        for face in 1..=6 {
            let count = rolls.iter().filter(|roll| **roll == face).count();
            assert!(
                (60..140).contains(&count),
                "{count} of 600 rolls show {face}"
            );
        }
        assert!([1, 2, 3].contains([1, 2, 3].choose(&mut rng).unwrap()));
        let word = rng.clone().next_u32();
        assert_eq!(RngExt::random::<u32>(&mut rng), word);
    }

    #[test]
    fn uniform_numbers_fill_their_range() {
        const N: usize = 100_000;
        let mut rng = Generator::from_os().unwrap();
        let values: Vec<f64> = (0..N).map(|_| rng.uniform(-2.0, 4.0)).collect();
        assert!(values.iter().all(|x| (-2.0..4.0).contains(x)));
        let mean = values.iter().sum::<f64>() / N as f64;
        // seven standard errors of 6 / sqrt(12 N)
        assert!((mean - 1.0).abs() < 0.039, "mean {mean}");
    }
}
