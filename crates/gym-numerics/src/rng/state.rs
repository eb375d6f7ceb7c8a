//! The stored form of a generator: JSON cannot hold PCG64's 128-bit numbers, so they are hex strings.

use rand_pcg::Pcg64;
use serde::de::{DeserializeOwned, Deserializer, Error as _};
use serde::ser::Error as _;
use serde::{Deserialize, Serialize, Serializer};

use super::Generator;

#[derive(Serialize, Deserialize)]
struct Stored {
    state: String,
    increment: String,
    half: Option<u32>,
}

/// The fields of [`Pcg64`], which shows them through serde alone.
#[derive(Serialize, Deserialize)]
struct Fields {
    state: u128,
    increment: u128,
}

fn through_json<T: DeserializeOwned>(from: &impl Serialize) -> serde_json::Result<T> {
    serde_json::from_str(&serde_json::to_string(from)?)
}

fn to_hex(number: u128) -> String {
    format!("{number:#x}")
}

fn from_hex(text: &str) -> Result<u128, String> {
    text.strip_prefix("0x").and_then(|digits| u128::from_str_radix(digits, 16).ok()).ok_or_else(|| {
        format!("`{text}` is no generator state: expected `0x` and 1 to 32 hexadecimal digits")
    })
}

impl Serialize for Generator {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Fields { state, increment } = through_json(&self.pcg).map_err(S::Error::custom)?;
        Stored { state: to_hex(state), increment: to_hex(increment), half: self.half }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Generator {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let stored = Stored::deserialize(deserializer)?;
        let state = from_hex(&stored.state).map_err(D::Error::custom)?;
        let increment = from_hex(&stored.increment).map_err(D::Error::custom)?;
        if increment % 2 == 0 {
            return Err(D::Error::custom(format!(
                "`{}` is no generator increment: it must be odd",
                stored.increment
            )));
        }
        let pcg: Pcg64 = through_json(&Fields { state, increment }).map_err(D::Error::custom)?;
        Ok(Self { pcg, half: stored.half })
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_fresh_generator_has_numpys_state() {
        for (seed, state, increment) in [
            (0, "0x1aa1b5345996452d09585eb7a69561e3", "0x418ddadb3af71a82588133bc447873a9"),
            (42, "0xcea44f6798798f2aacbc7c9d68860ac8", "0xfa505436c9a8416e66caf2e28d25abff"),
            (123, "0x786df8ae32b3fe645bee00f1ac1e7b4d", "0xd4e48fee886333a26dbcfc7823f9c3b"),
        ] {
            let stored = serde_json::to_value(Generator::from(seed)).unwrap();
            assert_eq!(stored, json!({"state": state, "increment": increment, "half": null}));
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
        let stored = |state: &str, increment: &str| {
            let json = json!({"state": state, "increment": increment, "half": null});
            serde_json::from_value::<Generator>(json).map_err(|error| error.to_string())
        };
        assert!(stored("0x0", "0x1").is_ok());
        assert!(stored("0x0", "0x10").unwrap_err().contains("must be odd"));
        for state in ["", "12", "0x", "0xg", "0x100000000000000000000000000000000"] {
            assert!(stored(state, "0x1").unwrap_err().contains("hexadecimal"));
        }
    }
}
