//! What snapshots of vectors hold: numbers to the last bit, whether or not they lie in their space, and
//! compact.

use base64::prelude::{BASE64_STANDARD, Engine};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::spaces::number::{with_numbers, with_type};
use crate::{Array, DType, Error, GraphInstance, Result, Value};

/// Plain data in binary form, as text. The data must not nest without end.
pub(super) fn pack<T: Serialize + ?Sized>(data: &T) -> Result<String> {
    let bytes = postcard::to_allocvec(data).map_err(|error| Error::Snapshot(error.to_string()))?;
    Ok(BASE64_STANDARD.encode(bytes))
}

/// Reads what [`pack`] wrote.
pub(super) fn unpack<T: DeserializeOwned>(text: &str) -> Result<T> {
    let damaged = || Error::Snapshot("the numbers it holds are damaged".into());
    let bytes = BASE64_STANDARD.decode(text).map_err(|_| damaged())?;
    match postcard::take_from_bytes(&bytes) {
        Ok((data, [])) => Ok(data),
        _ => Err(damaged()),
    }
}

/// The stored form of a [`Value`].
#[derive(Serialize, Deserialize)]
#[serde(try_from = "Stored", into = "Stored")]
#[derive(Clone)]
pub(super) struct Kept(pub(super) Value);

#[derive(Clone, Serialize, Deserialize)]
enum Stored {
    Null,
    Bool(bool),
    Int(i64),
    /// Its bits: JSON has no NaN.
    Float(u64),
    Text(String),
    Array(StoredArray),
    Tuple(Vec<Stored>),
    Dict(Vec<(String, Stored)>),
    Graph {
        nodes: StoredArray,
        edges: Option<StoredArray>,
        edge_links: Option<StoredArray>,
    },
    OneOf(usize, Box<Stored>),
}

#[derive(Clone, Serialize, Deserialize)]
struct StoredArray {
    dtype: DType,
    shape: Vec<usize>,
    /// The numbers in little-endian order, in base64.
    data: String,
}

impl From<Kept> for Stored {
    fn from(Kept(value): Kept) -> Self {
        match value {
            Value::Null => Self::Null,
            Value::Bool(b) => Self::Bool(b),
            Value::Int(i) => Self::Int(i),
            Value::Float(x) => Self::Float(x.to_bits()),
            Value::Text(text) => Self::Text(text),
            Value::Array(array) => Self::Array((&array).into()),
            Value::Tuple(items) => Self::Tuple(items.into_iter().map(|item| Kept(item).into()).collect()),
            Value::Dict(entries) => {
                Self::Dict(entries.into_iter().map(|(key, value)| (key, Kept(value).into())).collect())
            }
            Value::Graph(graph) => Self::Graph {
                nodes: (&graph.nodes).into(),
                edges: graph.edges.as_ref().map(Into::into),
                edge_links: graph.edge_links.as_ref().map(Into::into),
            },
            Value::OneOf(index, value) => Self::OneOf(index, Box::new(Kept(*value).into())),
        }
    }
}

impl TryFrom<Stored> for Kept {
    type Error = Error;

    fn try_from(stored: Stored) -> Result<Self> {
        let value = |stored: Stored| Self::try_from(stored).map(|kept| kept.0);
        Ok(Self(match stored {
            Stored::Null => Value::Null,
            Stored::Bool(b) => Value::Bool(b),
            Stored::Int(i) => Value::Int(i),
            Stored::Float(bits) => Value::Float(f64::from_bits(bits)),
            Stored::Text(text) => Value::Text(text),
            Stored::Array(array) => Value::Array(array.try_into()?),
            Stored::Tuple(items) => Value::Tuple(items.into_iter().map(value).collect::<Result<_>>()?),
            Stored::Dict(entries) => {
                let entries = entries.into_iter().map(|(key, entry)| Ok((key, value(entry)?)));
                Value::Dict(entries.collect::<Result<_>>()?)
            }
            Stored::Graph { nodes, edges, edge_links } => Value::Graph(Box::new(GraphInstance {
                nodes: nodes.try_into()?,
                edges: edges.map(TryInto::try_into).transpose()?,
                edge_links: edge_links.map(TryInto::try_into).transpose()?,
            })),
            Stored::OneOf(index, stored) => Value::OneOf(index, Box::new(value(*stored)?)),
        }))
    }
}

impl From<&Array> for StoredArray {
    fn from(array: &Array) -> Self {
        let bytes: Vec<u8> =
            with_numbers!(array.data(), values => values.iter().flat_map(|x| x.to_le_bytes()).collect());
        Self { dtype: array.dtype(), shape: array.shape().to_vec(), data: BASE64_STANDARD.encode(bytes) }
    }
}

impl TryFrom<StoredArray> for Array {
    type Error = Error;

    fn try_from(StoredArray { dtype, shape, data }: StoredArray) -> Result<Self> {
        let damaged = || Error::Snapshot("an array it holds is damaged".into());
        let bytes = BASE64_STANDARD.decode(data).map_err(|_| damaged())?;
        let array = with_type!(dtype, T => {
            let (numbers, rest) = bytes.as_chunks::<{ size_of::<T>() }>();
            let numbers: Vec<T> = numbers.iter().map(|bytes| T::from_le_bytes(*bytes)).collect();
            rest.is_empty().then(|| Self::from(numbers))
        });
        array.and_then(|array| array.reshape(shape).ok()).ok_or_else(damaged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_return_to_the_bit() {
        let array = Array::from([1.5f32, f32::NAN, -0.0, f32::INFINITY]).reshape([2, 2]).unwrap();
        let graph = GraphInstance { nodes: [1i64, 2].into(), edges: None, edge_links: Some([0u8].into()) };
        let value = Value::Dict(vec![
            ("b".into(), Value::Tuple(vec![Value::Null, Value::Bool(true), Value::Int(i64::MIN)])),
            ("a".into(), Value::Array(array)),
            ("x".into(), Value::Float(f64::NEG_INFINITY)),
            ("c".into(), Value::OneOf(3, Box::new(Value::Text("é".into())))),
            ("g".into(), Value::Graph(Box::new(graph))),
        ]);
        let json = serde_json::to_string(&Kept(value.clone())).unwrap();
        let read: Kept = serde_json::from_str(&json).unwrap();
        // NaN equals nothing, so compare what is printed
        assert_eq!(format!("{:?}", read.0), format!("{value:?}"));
    }

    #[test]
    fn damage_is_refused() {
        let json = serde_json::to_string(&Kept(Value::Array([1i64, 2].into()))).unwrap();
        for damaged in
            [json.replace("[2]", "[3]"), json.replace("int64", "int32"), json.replace("AAA", "A?A")]
        {
            assert!(serde_json::from_str::<Kept>(&damaged).is_err(), "{damaged}");
        }
        let text = pack(&[1u64, 2, 3]).unwrap();
        assert_eq!(unpack::<[u64; 3]>(&text).unwrap(), [1, 2, 3]);
        assert!(unpack::<[u64; 2]>(&text).is_err() && unpack::<[u64; 4]>(&text).is_err());
        assert!(unpack::<Vec<u64>>("####").is_err());
    }
}
