//! JSON whose objects have each key once, for `#[serde(deserialize_with = "...")]`. Serde's own
//! [`Json`] keeps the last of two equal keys, and returns no error.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value as Json};

/// Reads JSON of any kind.
///
/// # Errors
/// For a key that an object has twice, and for what is no JSON.
pub fn json<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Json, D::Error> {
    Unique::deserialize(deserializer).map(|Unique(json)| json)
}

/// Reads a text of JSON, to its end.
///
/// # Errors
/// As [`json`], and for what follows the JSON.
pub fn from_str(text: &str) -> serde_json::Result<Json> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = json(&mut deserializer)?;
    deserializer.end().map(|()| value)
}

/// Reads an object.
///
/// # Errors
/// As [`json`], and for what is no object.
pub fn object<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Map<String, Json>, D::Error> {
    match json(deserializer)? {
        Json::Object(object) => Ok(object),
        other => Err(D::Error::custom(format!("expected an object, not {other}"))),
    }
}

/// Reads JSON of any kind; `None` for `null`.
///
/// # Errors
/// As [`json`].
pub fn option<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Json>, D::Error> {
    json(deserializer).map(|json| (!json.is_null()).then_some(json))
}

struct Unique(Json);

impl<'de> Deserialize<'de> for Unique {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(UniqueVisitor).map(Self)
    }
}

struct UniqueVisitor;

impl<'de> Visitor<'de> for UniqueVisitor {
    type Value = Json;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_unit<E>(self) -> Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Json, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Json, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Json, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Json, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Json, E> {
        Ok(value.into())
    }

    fn visit_string<E>(self, value: String) -> Result<Json, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Json, A::Error> {
        let mut all = Vec::new();
        while let Some(Unique(json)) = list.next_element()? {
            all.push(json);
        }
        Ok(all.into())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Json, A::Error> {
        let mut all = Map::new();
        while let Some(key) = map.next_key::<String>()? {
            if all.contains_key(&key) {
                return Err(A::Error::custom(format!("the key `{key}` stands twice")));
            }
            let Unique(json) = map.next_value()?;
            all.insert(key, json);
        }
        Ok(all.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Deserialize)]
    struct Read {
        #[serde(default, deserialize_with = "object")]
        object: Map<String, Json>,
        #[serde(default, deserialize_with = "option")]
        option: Option<Json>,
    }

    #[test]
    fn a_key_stands_once_at_any_depth() {
        let read = |text: &str| serde_json::from_str::<Read>(text);
        let text = r#"{"a": [{"b": -1}, {"b": 1.5e300}], "b": {"a": null, "c": 18446744073709551615}, "d": "é\n", "e": true}"#;
        let whole = read(&format!(r#"{{"object": {text}, "option": {text}}}"#)).unwrap();
        let expected: Json = serde_json::from_str(text).unwrap();
        assert_eq!(Json::Object(whole.object), expected);
        assert_eq!(whole.option, Some(expected));
        for twice in [
            r#"{"a": 1, "a": 1}"#,
            r#"{"b": {"a": 1, "a": 2}}"#,
            r#"{"b": [0, {"c": [{"a": null, "a": null}]}]}"#,
            r#"{"a": 1, "\u0061": 2}"#,
        ] {
            for field in ["object", "option"] {
                let error = read(&format!(r#"{{"{field}": {twice}}}"#)).unwrap_err();
                assert!(
                    error.to_string().starts_with("the key `a` stands twice"),
                    "{error}"
                );
            }
        }
        for (text, fault) in [
            ("{} {}", "trailing"),
            (r#"{"a": 1, "a": 1}"#, "twice"),
            ("{", "EOF"),
        ] {
            let error = from_str(text).unwrap_err().to_string();
            assert!(error.contains(fault), "{text}: {error}");
        }
        assert_eq!(from_str(" [1] ").unwrap(), serde_json::json!([1]));
        let none = read(r#"{"option": null}"#).unwrap();
        assert!(none.option.is_none() && none.object.is_empty());
        let error = read(r#"{"object": [1]}"#).unwrap_err().to_string();
        assert!(error.starts_with("expected an object, not [1]"), "{error}");
    }
}
