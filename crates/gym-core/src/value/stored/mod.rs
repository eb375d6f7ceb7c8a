//! The stored form of numbers, values and states: JSON that keeps every bit.
//!
//! [`Value`]'s `Serialize` describes the form; [`exact`] handles the floats of any other type. For
//! plain JSON, which a space interprets, see [`Value::to_json`] and
//! [`Space::from_json`](crate::Space::from_json).
//!
//! Snapshots, vectors, the generator and the bridge use this form: floats that JSON lacks are
//! `{"$float": "inf"}`, arrays carry their dtype, and more than 32 numbers are bytes in base64.

pub(crate) mod exact;
pub(crate) mod plain;

use base64::prelude::{BASE64_STANDARD, Engine};
use gym_numerics::rng::Stream;
use serde::de::{Deserialize, Deserializer, Error as _};
use serde::ser::{Serialize, SerializeMap, Serializer};
use serde_json::{Map, Value as Json};

use self::plain::{float_text, list, parse_float, read_array, rows};
use crate::value::array::Scalar;
use crate::value::fault::Fault;
use crate::value::{Array, DType, Error, GraphInstance, Value};

/// The key of a float that JSON lacks.
const FLOAT: &str = "$float";
const DICT: &str = "$dict";
const GRAPH: &str = "$graph";
const ONE_OF: &str = "$one_of";

/// Arrays of more numbers are stored as bytes.
const READABLE: usize = 32;

/// JSON within stored data, unchanged.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "$json")]
struct AsItIs(Json);

/// The name by which [`exact`] recognises such JSON.
const AS_IT_IS: &str = "$json";

/// The numbers of a stored array.
///
/// # Errors
/// [`Error::Snapshot`] for another number of them than `len`, or for numbers of another type.
pub fn numbers<T: Scalar>(array: &Array, len: usize) -> crate::value::Result<Vec<T>> {
    let numbers = array.as_slice::<T>().filter(|numbers| numbers.len() == len);
    let expected = || {
        Error::Snapshot(format!(
            "expected {len} numbers of type {}, not {array}",
            T::DTYPE
        ))
    };
    numbers.map(<[T]>::to_vec).ok_or_else(expected)
}

/// A row of numbers, for `#[serde(with = "row")]`.
pub mod row {
    use super::*;

    /// Stores a row.
    ///
    /// # Errors
    /// The serializer's errors.
    pub fn serialize<T: Scalar, S: Serializer>(
        row: &[T],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        Array::from(row.to_vec()).serialize(serializer)
    }

    /// Reads a row.
    ///
    /// # Errors
    /// The deserializer's errors, and one for an array of another type.
    pub fn deserialize<'de, T: Scalar, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<T>, D::Error> {
        let array = Array::deserialize(deserializer)?;
        numbers(&array, array.len()).map_err(D::Error::custom)
    }
}

/// Streams of random numbers, for `#[serde(with = "words")]`: a row of five words for each.
pub mod words {
    use super::*;

    /// Stores streams.
    ///
    /// # Errors
    /// The serializer's errors.
    pub fn serialize<T: Stream, S: Serializer>(
        streams: &[T],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let words: Vec<u64> = streams.iter().flat_map(Stream::words).collect();
        row::serialize(&words, serializer)
    }

    /// Reads streams.
    ///
    /// # Errors
    /// The deserializer's errors, and one for numbers that are not streams of this type.
    pub fn deserialize<'de, T: Stream, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<T>, D::Error> {
        let words: Vec<u64> = row::deserialize(deserializer)?;
        let (streams, rest) = words.as_chunks();
        if !rest.is_empty() {
            return Err(D::Error::custom(
                "expected five words for each stream of random numbers",
            ));
        }
        streams
            .iter()
            .map(|words| T::from_words(*words).map_err(D::Error::custom))
            .collect()
    }
}

/// One entry under a key that begins with `$`.
fn tagged<S: Serializer>(
    serializer: S,
    tag: &str,
    content: &(impl Serialize + ?Sized),
) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(1))?;
    map.serialize_entry(tag, content)?;
    map.end()
}

impl Serialize for Array {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let tag = format!("${}", self.dtype());
        if (1..=READABLE).contains(&self.len()) {
            return tagged(serializer, &tag, &rows(self));
        }
        let mut map = serializer.serialize_map(Some(2))?;
        map.serialize_entry(&tag, &BASE64_STANDARD.encode(self.to_bytes()))?;
        map.serialize_entry("shape", self.shape())?;
        map.end()
    }
}

/// The stored form: JSON that keeps every bit.
///
/// | value | stored form |
/// |---|---|
/// | a number | a number |
/// | a float that JSON lacks | `{"$float": "inf"}`, `"-inf"` or `"NaN"`; the text alone in an array, and wherever a space says that it is a number |
/// | an array | `{"$float32": [[0.5, 1.0], [2.0, 3.0]]}`, under the name of its type |
/// | an array of more than 32 numbers, or of none | `{"$float32": "AAAAPw...", "shape": [8, 8]}`: their bytes, little-endian, in base64 |
/// | a tuple | a list |
/// | a dict | an object, or `{"$dict": [["key", value], ...]}` where its keys are not in order or begin with `$` |
/// | a graph | `{"$graph": [nodes, edges, edge_links]}` |
/// | an element of a `OneOf` | `{"$one_of": [index, element]}` |
impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Null => serializer.serialize_unit(),
            Self::Bool(b) => serializer.serialize_bool(*b),
            Self::Int(i) => serializer.serialize_i64(*i),
            Self::Float(x) => match float_text(*x) {
                Some(text) => tagged(serializer, FLOAT, &text),
                None => serializer.serialize_f64(*x),
            },
            Self::Text(text) => serializer.serialize_str(text),
            Self::Array(array) => array.serialize(serializer),
            Self::Tuple(items) => items.serialize(serializer),
            Self::Dict(entries) => {
                let plain = entries.is_sorted_by(|(a, _), (b, _)| a < b)
                    && entries.iter().all(|(key, _)| !key.starts_with('$'));
                match plain {
                    true => serializer.collect_map(entries.iter().map(|(key, value)| (key, value))),
                    false => tagged(serializer, DICT, entries),
                }
            }
            Self::Graph(graph) => tagged(
                serializer,
                GRAPH,
                &(&graph.nodes, &graph.edges, &graph.edge_links),
            ),
            Self::OneOf(index, value) => tagged(serializer, ONE_OF, &(index, value)),
        }
    }
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let AsItIs(json) = AsItIs::deserialize(deserializer)?;
        read(&json).map_err(|fault| D::Error::custom(fault.to_string()))
    }
}

impl<'de> Deserialize<'de> for Array {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Value::deserialize(deserializer)? {
            Value::Array(array) => Ok(array),
            other => Err(D::Error::custom(format!("expected an array, not {other}"))),
        }
    }
}

fn read(json: &Json) -> Result<Value, Fault> {
    Ok(match json {
        Json::Null => Value::Null,
        Json::Bool(b) => Value::Bool(*b),
        Json::Number(number) => match number.as_i64() {
            Some(i) => Value::Int(i),
            None => match number.as_f64().filter(|_| number.is_f64()) {
                Some(x) => Value::Float(x),
                None => return Err(Fault::new(format!("{number} does not fit int64"))),
            },
        },
        Json::String(text) => Value::Text(text.clone()),
        Json::Array(items) => {
            let items = items
                .iter()
                .enumerate()
                .map(|(i, item)| read(item).map_err(|fault| fault.at(i)));
            Value::Tuple(items.collect::<Result<_, _>>()?)
        }
        Json::Object(map) => match map.iter().find(|(key, _)| key.starts_with('$')) {
            Some((tag, content)) => {
                read_tagged(tag, content, map).map_err(|fault| fault.under(tag))?
            }
            None => {
                let entries = map.iter().map(|(key, json)| {
                    Ok((key.clone(), read(json).map_err(|fault| fault.under(key))?))
                });
                Value::Dict(entries.collect::<Result<_, _>>()?)
            }
        },
    })
}

fn read_tagged(tag: &str, content: &Json, map: &Map<String, Json>) -> Result<Value, Fault> {
    if let Some(dtype) = DType::ALL
        .into_iter()
        .find(|dtype| dtype.name() == &tag[1..])
    {
        return match (content.as_str(), map.get("shape"), map.len()) {
            (None, None, 1) => read_array(content, &shape_of(content), dtype),
            (Some(bytes), Some(shape), 2) => unpack(dtype, shape, bytes),
            _ => Err(Fault::new(
                "expected lists of numbers alone, or bytes and a `shape`",
            )),
        }
        .map(Value::Array);
    }
    match (tag, content, map.len()) {
        (FLOAT, Json::String(text), 1) => parse_float(text).map(Value::Float),
        (DICT, Json::Array(entries), 1) => Some(Value::Dict(
            entries
                .iter()
                .map(|entry| match list(entry)?.as_slice() {
                    [Json::String(key), value] => Ok((key.clone(), read(value)?)),
                    _ => Err(Fault::new("expected pairs of a key and a value")),
                })
                .collect::<Result<_, Fault>>()?,
        )),
        (GRAPH, Json::Array(parts), 1) => {
            let parts = parts.iter().map(|part| match read(part)? {
                Value::Null => Ok(None),
                value => Ok(Some(value)),
            });
            match <[_; 3]>::try_from(parts.collect::<Result<Vec<_>, Fault>>()?) {
                Ok([Some(nodes), edges, links]) => {
                    let edge_links = match links {
                        None => None,
                        Some(Value::Array(links)) => Some(links),
                        Some(other) => return Err(Fault::kind("an array", &other)),
                    };
                    Some(Value::Graph(Box::new(GraphInstance {
                        nodes,
                        edges,
                        edge_links,
                    })))
                }
                _ => None,
            }
        }
        (ONE_OF, Json::Array(parts), 1) => match parts.as_slice() {
            [index, value] => {
                let index = index.as_u64().and_then(|index| usize::try_from(index).ok());
                index
                    .map(|index| Ok::<_, Fault>(Value::OneOf(index, Box::new(read(value)?))))
                    .transpose()?
            }
            _ => None,
        },
        _ => None,
    }
    .ok_or_else(|| Fault::new("this is not the stored form of a value"))
}

/// The shape of nested lists, from their first items.
fn shape_of(mut json: &Json) -> Vec<usize> {
    let mut shape = Vec::new();
    while let Json::Array(items) = json {
        shape.push(items.len());
        json = items.first().unwrap_or(&Json::Null);
    }
    shape
}

/// The array of some bytes.
fn unpack(dtype: DType, shape: &Json, bytes: &str) -> Result<Array, Fault> {
    let shape = Vec::<usize>::deserialize(shape).ok();
    let bytes = BASE64_STANDARD.decode(bytes).ok();
    let array = shape
        .zip(bytes)
        .and_then(|(shape, bytes)| Array::from_bytes(dtype, shape, &bytes));
    array.ok_or_else(|| {
        Fault::new(format!(
            "expected the bytes of {dtype} in base64, as many as the shape asks for"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::value::Snapshot;

    fn values() -> Vec<Value> {
        let single = Array::from([1.5f32, f32::NAN, -0.0, f32::INFINITY])
            .reshape([2, 2])
            .unwrap();
        let graph = GraphInstance {
            nodes: Value::Array([1i64, 2].into()),
            edges: Some(Value::Tuple(vec![Value::Text("a".into())])),
            edge_links: Some([0u8].into()),
        };
        let many: Vec<f64> = (0..33)
            .map(|i| f64::from(i) / 7.0 - 1.0)
            .chain([f64::NAN, -0.0])
            .collect();
        vec![
            Value::Null,
            Value::Tuple(vec![
                Value::Null,
                Value::Bool(true),
                Value::Int(i64::MIN),
                Value::Float(1.0),
                Value::Float(-0.0),
            ]),
            Value::Tuple(
                [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 5e-324, f64::MAX]
                    .map(Value::Float)
                    .into(),
            ),
            Value::Array(single),
            Value::Array([u64::MAX, 0].into()),
            Value::Array(many.into()),
            Value::Array(Array::zeros(DType::F32, [0, 3]).unwrap()),
            Value::Array(Array::zeros(DType::I8, []).unwrap()),
            Value::Array(Array::zeros(DType::U16, [5, 7]).unwrap()),
            Value::from([("b", Value::from("inf")), ("a", Value::Int(1))]),
            Value::from([("#", Value::from("é")), ("$float", Value::from("inf"))]),
            Value::from([("a", Value::Int(1)), ("a", Value::Int(2))]),
            Value::from([
                ("a", Value::Dict(vec![])),
                ("shape", Value::Float(f64::NAN)),
            ]),
            Value::OneOf(3, Box::new(Value::Text(String::new()))),
            Value::Graph(Box::new(graph)),
        ]
    }

    #[test]
    fn every_bit_returns() {
        for value in values() {
            // NaN differs from itself, so compare the printed text
            let text = serde_json::to_string(&value).unwrap();
            let read: Value = serde_json::from_str(&text).unwrap();
            assert_eq!(format!("{read:?}"), format!("{value:?}"), "{text}");
            let snapshot = Snapshot::of(&(1, &value)).unwrap();
            let snapshot: Snapshot =
                serde_json::from_str(&serde_json::to_string(&snapshot).unwrap()).unwrap();
            let (_, read): (i64, Value) = snapshot.get().unwrap();
            assert_eq!(format!("{read:?}"), format!("{value:?}"), "{text}");
        }
    }

    #[test]
    fn short_arrays_are_readable_and_long_ones_compact() {
        let json = |value: Value| serde_json::to_string(&value).unwrap();
        assert_eq!(
            json([0.5f32, f32::NAN].into()),
            r#"{"$float32":[0.5,"NaN"]}"#
        );
        assert_eq!(
            json(vec![0.1f64; 300].into()).len(),
            4 * 800 + r#"{"$float64":"","shape":[300]}"#.len()
        );
    }

    #[test]
    fn damage_is_refused() {
        for text in [
            r#"{"$float32": [1, [2]]}"#,
            r#"{"$float32": [[1, 2], [3]]}"#,
            r#"{"$uint8": [256]}"#,
            r#"{"$uint8": [0.5]}"#,
            r#"{"$uint8": ["NaN"]}"#,
            r#"{"$uint8": "AAA", "shape": [2]}"#,
            r#"{"$uint8": "AAA=", "shape": [3]}"#,
            r#"{"$uint16": "AAAA", "shape": [2]}"#,
            r#"{"$uint8": "AAAA", "shape": [18446744073709551615, 18446744073709551615]}"#,
            r#"{"$uint8": [1], "shape": [1]}"#,
            r#"{"$uint8": "AAAA"}"#,
            r#"{"$float": "1.5"}"#,
            r#"{"$float": "inf", "a": 1}"#,
            r#"{"$dict": [["a"]]}"#,
            r#"{"$graph": [null, null, null]}"#,
            r#"{"$one_of": [-1, null]}"#,
            r#"{"$what": 1}"#,
            "18446744073709551615",
        ] {
            assert!(serde_json::from_str::<Value>(text).is_err(), "{text}");
        }
    }
}
