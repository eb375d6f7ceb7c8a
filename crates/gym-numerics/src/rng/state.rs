//! The stored form of a generator: five words.

use rand_pcg::Pcg64;
use serde::Deserialize;
use serde::de::value::{Error as SerdeError, SeqDeserializer};

use super::Generator;

/// The bit of the last word that marks an unused half word in its lower 32 bits.
const HAS_HALF: u64 = 1 << 32;

impl Generator {
    /// Returns the whole state, which is also the form that serde stores: PCG64's state and
    /// increment, each in two words with the higher one first, and an unused half word (2^32 plus
    /// it, or 0).
    pub fn words(&self) -> [u64; 5] {
        /// The fields of [`Pcg64`], which are accessible only through serde.
        #[derive(Deserialize)]
        struct Fields {
            state: u128,
            increment: u128,
        }

        let fields = serde_json::to_string(&self.pcg).and_then(|json| serde_json::from_str(&json));
        let Fields { state, increment } = fields.expect("a generator has these fields");
        let half = self.half.map_or(0, |half| HAS_HALF | u64::from(half));
        [
            (state >> 64) as u64,
            state as u64,
            (increment >> 64) as u64,
            increment as u64,
            half,
        ]
    }

    /// Makes the generator with the given [`words`](Self::words).
    ///
    /// # Errors
    /// An error text if the increment is even, or the last word is not 0 and not between 2^32 and
    /// 2^33.
    pub fn from_words(
        [state_high, state, increment_high, increment, half]: [u64; 5],
    ) -> Result<Self, String> {
        if increment % 2 == 0 {
            return Err(format!(
                "the generator's increment ends in {increment}: it must be odd"
            ));
        }
        let half = match half {
            0 => None,
            HAS_HALF..0x2_0000_0000 => Some(half as u32),
            _ => {
                return Err(format!(
                    "the kept half of a word is {half}: it must be 0, or between 2^32 and 2^33"
                ));
            }
        };
        let join = |high: u64, low: u64| u128::from(high) << 64 | u128::from(low);
        let fields = [join(state_high, state), join(increment_high, increment)];
        let pcg = Pcg64::deserialize(SeqDeserializer::<_, SerdeError>::new(fields.into_iter()));
        Ok(Self {
            pcg: pcg.map_err(|error| error.to_string())?,
            half,
        })
    }
}

impl From<Generator> for [u64; 5] {
    fn from(generator: Generator) -> Self {
        generator.words()
    }
}

impl TryFrom<[u64; 5]> for Generator {
    type Error = String;

    fn try_from(words: [u64; 5]) -> Result<Self, String> {
        Self::from_words(words)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_fresh_generator_has_numpys_state() {
        for (seed, state, increment) in [
            (
                0,
                0x1aa1b534_5996452d_09585eb7_a69561e3_u128,
                0x418ddadb_3af71a82_588133bc_447873a9_u128,
            ),
            (
                42,
                0xcea44f67_98798f2a_acbc7c9d_68860ac8,
                0xfa505436_c9a8416e_66caf2e2_8d25abff,
            ),
            (
                123,
                0x786df8ae_32b3fe64_5bee00f1_ac1e7b4d,
                0x0d4e48fe_e886333a_26dbcfc7_823f9c3b,
            ),
        ] {
            let words = [state, increment].map(|number| [(number >> 64) as u64, number as u64]);
            let stored = serde_json::to_value(Generator::from(seed)).unwrap();
            assert_eq!(
                stored,
                json!([words[0][0], words[0][1], words[1][0], words[1][1], 0])
            );
        }
    }

    #[test]
    fn a_restored_generator_continues() {
        let mut rng = Generator::from(9);
        for halves in [0, 1, 2, 3] {
            rng.random();
            for _ in 0..halves {
                rng.random_f32();
            }
            let stored = serde_json::to_value(&rng).unwrap();
            let mut restored: Generator = serde_json::from_value(stored).unwrap();
            assert_eq!(restored, rng);
            for _ in 0..20 {
                assert_eq!(restored.random_f32(), rng.random_f32());
                assert_eq!(restored.standard_normal(), rng.standard_normal());
            }
        }
    }

    #[test]
    fn a_damaged_state_is_refused() {
        let read =
            |json| serde_json::from_value::<Generator>(json).map_err(|error| error.to_string());
        assert!(read(json!([0, 0, 0, 1, 0])).is_ok());
        assert!(
            read(json!([0, 0, 1, 16, 0]))
                .unwrap_err()
                .contains("must be odd")
        );
        for half in [1, 1_u64 << 33, u64::MAX] {
            assert!(
                read(json!([0, 0, 0, 1, half]))
                    .unwrap_err()
                    .contains("half of a word")
            );
        }
        assert!(read(json!([0, 0, 0, 1])).is_err() && read(json!([0, 0, 0, 1, 0, 0])).is_err());
    }
}
