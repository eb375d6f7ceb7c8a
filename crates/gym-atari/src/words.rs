//! Serde for a generator's words, as hexadecimal digits.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serializer};

pub(crate) fn serialize<S: Serializer>(
    words: &[u32; 624],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let text: String = words.iter().map(|word| format!("{word:08x}")).collect();
    serializer.serialize_str(&text)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<[u32; 624], D::Error> {
    let text = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
    let bytes = crate::bytes::decode::<2496>(&text)
        .ok_or_else(|| D::Error::custom("expected 624 words as 4992 hexadecimal digits"))?;
    Ok(std::array::from_fn(|i| {
        u32::from_be_bytes(std::array::from_fn(|j| bytes[4 * i + j]))
    }))
}
