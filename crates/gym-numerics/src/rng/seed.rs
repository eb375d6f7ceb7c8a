//! Seeds, and numpy's `SeedSequence`, which computes the state of a generator from a seed.

use std::fmt;
use std::str::FromStr;

use serde::de::{Deserializer, Unexpected, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use thiserror::Error;

/// A seed: a whole number, zero or greater, of at most 4300 decimal digits (the limit of Python's
/// `int`).
///
/// ```
/// use gym_numerics::Seed;
/// assert_eq!("42".parse::<Seed>()?, Seed::from(42));
/// assert!("-1".parse::<Seed>().is_err());
/// # Ok::<(), gym_numerics::SeedError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Seed {
    /// The digits in base 2^32, lowest first; the highest digit is not 0.
    words: Vec<u32>,
}

/// The largest number of decimal digits. The limit exists because the time to parse digits is
/// quadratic.
const MAX_DIGITS: usize = 4300;

/// An error of making a seed.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SeedError {
    /// The text is not a whole number of zero or more.
    #[error("invalid seed `{0}`: a seed is a whole number, zero or greater")]
    Invalid(String),

    /// The text has more digits than a seed can have.
    #[error("a seed of {0} digits is too long: {MAX_DIGITS} are allowed")]
    TooLong(usize),

    /// The operating system returned no random bits; with its reason.
    #[error("the operating system gives no random seed: {0}")]
    NoRandomness(String),
}

/// Fills `bytes` with random bits from the operating system.
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
fn fill(bytes: &mut [u8]) -> Result<(), SeedError> {
    use rand::{TryRng, rngs::SysRng};

    SysRng
        .try_fill_bytes(bytes)
        .map_err(|error| SeedError::NoRandomness(error.to_string()))
}

/// WebAssembly in a browser has no operating system.
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
fn fill(_: &mut [u8]) -> Result<(), SeedError> {
    Err(SeedError::NoRandomness(
        "this platform has none: give each reset a seed".into(),
    ))
}

impl Seed {
    /// Makes a seed of 128 random bits from the operating system, as numpy does without a seed.
    ///
    /// # Errors
    /// [`SeedError::NoRandomness`] if the operating system returns no random bits.
    pub fn from_os() -> Result<Self, SeedError> {
        let mut bytes = [0; 16];
        fill(&mut bytes)?;
        Ok(Self::from_u128(u128::from_le_bytes(bytes)))
    }

    /// Makes a seed of up to 128 bits. (`From` exists only for `u64`, so that a literal needs no
    /// suffix.)
    pub fn from_u128(seed: u128) -> Self {
        let mut words: Vec<u32> = (0..4).map(|i| (seed >> (32 * i)) as u32).collect();
        while words.last() == Some(&0) {
            words.pop();
        }
        Self { words }
    }

    /// The digits in base 2^32, lowest first.
    pub(super) fn digits(&self) -> &[u32] {
        &self.words
    }

    /// Returns two words computed from the seed: numpy's `SeedSequence(seed).generate_state(2)`.
    pub fn words(&self) -> [u32; 2] {
        let [first, ..] = generate_state(self);
        [first as u32, (first >> 32) as u32]
    }

    /// Returns the seed plus `n`.
    #[must_use]
    pub fn plus(&self, n: u64) -> Self {
        let mut sum = self.clone();
        sum.multiply_add(1, n);
        sum
    }

    /// Multiplies by `factor` and adds `summand`.
    fn multiply_add(&mut self, factor: u32, summand: u64) {
        let mut carry = u128::from(summand);
        for word in &mut self.words {
            carry += u128::from(*word) * u128::from(factor);
            *word = carry as u32;
            carry >>= 32;
        }
        while carry > 0 {
            self.words.push(carry as u32);
            carry >>= 32;
        }
    }

    /// Divides by `divisor` and returns the remainder.
    fn divide(&mut self, divisor: u32) -> u32 {
        let mut rest = 0;
        for word in self.words.iter_mut().rev() {
            let dividend = rest << 32 | u64::from(*word);
            *word = (dividend / u64::from(divisor)) as u32;
            rest = dividend % u64::from(divisor);
        }
        if self.words.last() == Some(&0) {
            self.words.pop();
        }
        rest as u32
    }

    /// Returns the seed as `u64`, if it fits.
    fn to_u64(&self) -> Option<u64> {
        match self.words[..] {
            [] => Some(0),
            [low] => Some(low.into()),
            [low, high] => Some(u64::from(low) | u64::from(high) << 32),
            _ => None,
        }
    }
}

impl From<u64> for Seed {
    fn from(seed: u64) -> Self {
        Self::from_u128(seed.into())
    }
}

impl FromStr for Seed {
    type Err = SeedError;

    /// Parses decimal digits, without sign, space or separator.
    fn from_str(text: &str) -> Result<Self, SeedError> {
        if text.is_empty() || !text.bytes().all(|byte| byte.is_ascii_digit()) {
            return Err(SeedError::Invalid(text.to_owned()));
        }
        if text.len() > MAX_DIGITS {
            return Err(SeedError::TooLong(text.len()));
        }
        let mut seed = Self::from(0);
        for digit in text.bytes() {
            seed.multiply_add(10, (digit - b'0').into());
        }
        Ok(seed)
    }
}

impl fmt::Display for Seed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rest = self.clone();
        let mut digits = Vec::new();
        while digits.is_empty() || !rest.words.is_empty() {
            digits.push(char::from(b'0' + rest.divide(10) as u8));
        }
        f.pad_integral(true, "", &digits.iter().rev().collect::<String>())
    }
}

/// Writes a number if the seed fits `u64`, otherwise a string of decimal digits.
impl Serialize for Seed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.to_u64() {
            Some(small) => serializer.serialize_u64(small),
            None => serializer.collect_str(self),
        }
    }
}

/// Reads a number or a list of numbers.
impl<'de> Deserialize<'de> for Seed {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct SeedVisitor;

        impl Visitor<'_> for SeedVisitor {
            type Value = Seed;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a seed: a whole number, zero or greater (from 2^64 on, a string of its digits)")
            }

            fn visit_u64<E: serde::de::Error>(self, seed: u64) -> Result<Seed, E> {
                Ok(Seed::from(seed))
            }

            fn visit_i64<E: serde::de::Error>(self, seed: i64) -> Result<Seed, E> {
                u64::try_from(seed)
                    .map(Seed::from)
                    .map_err(|_| E::invalid_value(Unexpected::Signed(seed), &self))
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Seed, E> {
                text.parse().map_err(|error| match error {
                    SeedError::TooLong(_) => E::custom(error),
                    _ => E::invalid_value(Unexpected::Str(text), &self),
                })
            }
        }

        deserializer.deserialize_any(SeedVisitor)
    }
}

/// numpy's `SeedSequence(seed).generate_state(4, np.uint64)`.
///
/// M. E. O'Neill's `seed_seq` with fixed entropy; the constants are those of
/// `numpy/random/bit_generator.pyx`.
pub(super) fn generate_state(seed: &Seed) -> [u64; 4] {
    let pool = mix_entropy(&seed.words);
    let mut hash = Hash {
        constant: 0x8b51_f9dd,
        multiplier: 0x58f3_8ded,
    };
    let mut words = pool.iter().cycle().map(|&word| hash.apply(word));
    let mut next = || u64::from(words.next().unwrap_or_default());
    std::array::from_fn(|_| next() | next() << 32)
}

/// Mixes the seed's words, lowest first, into a pool in which each word depends on all of them.
fn mix_entropy(entropy: &[u32]) -> [u32; 4] {
    let mut hash = Hash {
        constant: 0x43b0_d7e5,
        multiplier: 0x931e_8875,
    };
    let mut pool: [u32; 4] =
        std::array::from_fn(|i| hash.apply(entropy.get(i).copied().unwrap_or(0)));
    for source in 0..4 {
        for target in 0..4 {
            if source != target {
                pool[target] = mix(pool[target], hash.apply(pool[source]));
            }
        }
    }
    for &word in entropy.iter().skip(4) {
        for target in &mut pool {
            *target = mix(*target, hash.apply(word));
        }
    }
    pool
}

/// A hash function whose constant changes with each use.
struct Hash {
    constant: u32,
    multiplier: u32,
}

impl Hash {
    fn apply(&mut self, word: u32) -> u32 {
        let word = word ^ self.constant;
        self.constant = self.constant.wrapping_mul(self.multiplier);
        let word = word.wrapping_mul(self.constant);
        word ^ word >> 16
    }
}

fn mix(x: u32, y: u32) -> u32 {
    let word = x
        .wrapping_mul(0xca01_f9dd)
        .wrapping_sub(y.wrapping_mul(0x4973_f715));
    word ^ word >> 16
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// `np.random.SeedSequence(seed).generate_state(4, np.uint64)` for seeds of one to seven words.
    #[test]
    fn seeds_of_any_size_spread_as_numpys() {
        for (seed, state) in [
            (
                "0",
                [
                    0xdb2cd7e7b0f478be,
                    0xabf4641a2c71ba49,
                    0x20c6ed6d9d7b8d41,
                    0x2c4099de223c39d4,
                ],
            ),
            (
                "42",
                [
                    0x9f1e2e6dcd540ab7,
                    0xd57873dc79fb94b6,
                    0x7d282a1b64d420b7,
                    0x336579714692d5ff,
                ],
            ),
            // 2^32
            (
                "4294967296",
                [
                    0x50ff846cec53f444,
                    0x7a4918dbe8278562,
                    0x3bff9f6c362e2b19,
                    0xbdb177539a0654e3,
                ],
            ),
            // 2^40 + 7
            (
                "1099511627783",
                [
                    0x0d8672e10e3d1a15,
                    0x9aef4ada4ecfa161,
                    0x999c1c3b83dba903,
                    0x408927dc0dc8a316,
                ],
            ),
            // 2^128 - 1 and 2^128
            (
                "340282366920938463463374607431768211455",
                [
                    0x8395167830e01209,
                    0x84c0e37dcc99cac3,
                    0xd33f1bd2f788e841,
                    0xa9c6207b04082ba2,
                ],
            ),
            (
                "340282366920938463463374607431768211456",
                [
                    0x43bfff7a2820a7af,
                    0xc28cba32643645e9,
                    0xfbc1be8429bf6610,
                    0x0cc5330b50571ea8,
                ],
            ),
            // 2^150 + 3
            (
                "1427247692705959881058285969449495136382746627",
                [
                    0x1b5310f00088170d,
                    0xc3cc3f875b8f7f85,
                    0x6d391f3a5458a91d,
                    0x99c620ed0005d6ff,
                ],
            ),
            // 10^60
            (
                "1000000000000000000000000000000000000000000000000000000000000",
                [
                    0x06808faff1247840,
                    0x15b9f7f43013ad54,
                    0x19548bdbade6c172,
                    0x148ab267f5e412e3,
                ],
            ),
        ] {
            assert_eq!(generate_state(&seed.parse().unwrap()), state, "seed {seed}");
        }
    }

    #[test]
    fn text_is_digits_alone() {
        for digits in ["0", "18446744073709551615", "18446744073709551616"] {
            assert_eq!(digits.parse::<Seed>().unwrap().to_string(), digits);
        }
        let longest = "9".repeat(MAX_DIGITS);
        assert_eq!(longest.parse::<Seed>().unwrap().to_string(), longest);
        assert_eq!(
            "0".repeat(MAX_DIGITS + 1).parse::<Seed>(),
            Err(SeedError::TooLong(MAX_DIGITS + 1))
        );
        assert_eq!("007".parse::<Seed>().unwrap(), Seed::from(7));
        for text in ["", "-1", "+1", "1.0", "1_000", " 1", "0x1", "one"] {
            let error = text.parse::<Seed>().unwrap_err();
            assert!(
                matches!(&error, SeedError::Invalid(shown) if shown == text),
                "{error}"
            );
        }
    }

    #[test]
    fn sums_carry() {
        for (seed, n, sum) in [
            ("0", 0, "0"),
            ("4294967295", 1, "4294967296"),
            ("18446744073709551615", u64::MAX, "36893488147419103230"),
            (
                "340282366920938463463374607431768211455",
                1,
                "340282366920938463463374607431768211456",
            ),
        ] {
            assert_eq!(seed.parse::<Seed>().unwrap().plus(n), sum.parse().unwrap());
        }
    }

    #[test]
    fn stored_as_a_number_where_that_is_exact() {
        let huge = Seed::from_u128(u128::from(u64::MAX) + 1);
        for (seed, stored) in [
            (Seed::from(0), json!(0)),
            (Seed::from(7), json!(7)),
            (Seed::from(u64::from(u32::MAX)), json!(u32::MAX)),
            (Seed::from(1 << 32), json!(1_u64 << 32)),
            (Seed::from(u64::MAX), json!(u64::MAX)),
            (huge, json!("18446744073709551616")),
        ] {
            assert_eq!(serde_json::to_value(&seed).unwrap(), stored);
            assert_eq!(serde_json::from_value::<Seed>(stored).unwrap(), seed);
        }
        assert_eq!(
            serde_json::from_value::<Seed>(json!("7")).unwrap(),
            Seed::from(7)
        );
        for stored in [
            json!(-1),
            json!(1.5),
            json!(1e30),
            json!("-1"),
            json!("1.5"),
            json!(null),
            json!([1]),
        ] {
            let error = serde_json::from_value::<Seed>(stored)
                .unwrap_err()
                .to_string();
            assert!(
                error.contains("expected a seed: a whole number, zero or greater"),
                "{error}"
            );
        }
    }

    #[test]
    fn the_operating_system_gives_other_seeds_each_time() {
        assert_ne!(Seed::from_os().unwrap(), Seed::from_os().unwrap());
    }
}
