//! Values: numbers, arrays, the observations and actions of an erased environment, their stored
//! form, and errors.
//!
//! A typed environment observes `[f32; 4]` and takes an enum; [`BoxEnv`](crate::BoxEnv) uses
//! [`Value`] for both. [`Element`] converts between them.

pub mod array;
mod continuous;
mod data;
mod element;
pub(crate) mod error;
pub(crate) mod fault;
pub(crate) mod number;
pub(crate) mod numpy_fmt;
mod snapshot;
pub(crate) mod stored;

use std::fmt;

use array::Scalar;
pub use array::{Array, DType, Data};
pub use continuous::{Continuous, Precision};
pub use element::Element;
pub use error::{Error, Result, printable};
pub use snapshot::Snapshot;

/// The entries of [`Env::info`](crate::Env::info) by name.
pub type Info = std::collections::BTreeMap<String, Value>;

/// One dynamic value: an observation, an action, or an entry of `info`.
///
/// An element of a `Discrete` is an `Int`, of a `Box`, `MultiDiscrete` or `MultiBinary` an `Array`,
/// of a `Sequence` a `Tuple`. `Bool`, `Float` and `Null` occur only in `info`.
///
/// ```
/// use gym_core::Value;
///
/// let action = Value::from([0.5_f32, -1.0]);
/// assert_eq!(action.as_slice::<f32>(), Some(&[0.5, -1.0][..]));
/// let observation = Value::from([("cell", Value::from(3)), ("speed", Value::from(vec![0.1, 0.2]))]);
/// assert_eq!(observation.get("cell").and_then(Value::as_int), Some(3));
/// assert_eq!(observation.to_string(), "{cell: 3, speed: [0.1 0.2]}");
/// ```
#[derive(Debug, Default, PartialEq)]
pub enum Value {
    /// Nothing.
    #[default]
    Null,
    /// A truth value.
    Bool(bool),
    /// A whole number; an element of a `Discrete` space.
    Int(i64),
    /// A single real number.
    Float(f64),
    /// A string; an element of a `Text` space.
    Text(String),
    /// Numbers of one type in a shape.
    Array(Array),
    /// Some values in order; an element of a `Tuple` or `Sequence` space.
    Tuple(Vec<Value>),
    /// Named values in the order of their space's keys.
    Dict(Vec<(String, Value)>),
    /// Nodes, edges and the node pairs that the edges link.
    Graph(Box<GraphInstance>),
    /// The index of the chosen space, and an element of it.
    OneOf(usize, Box<Value>),
}

/// `clone_from` keeps the storage if kind, type and shape agree.
impl Clone for Value {
    fn clone(&self) -> Self {
        match self {
            Self::Null => Self::Null,
            Self::Bool(b) => Self::Bool(*b),
            Self::Int(i) => Self::Int(*i),
            Self::Float(x) => Self::Float(*x),
            Self::Text(text) => Self::Text(text.clone()),
            Self::Array(array) => Self::Array(array.clone()),
            Self::Tuple(items) => Self::Tuple(items.clone()),
            Self::Dict(entries) => Self::Dict(entries.clone()),
            Self::Graph(graph) => Self::Graph(graph.clone()),
            Self::OneOf(index, value) => Self::OneOf(*index, value.clone()),
        }
    }

    fn clone_from(&mut self, source: &Self) {
        match (self, source) {
            (Self::Text(to), Self::Text(from)) => to.clone_from(from),
            (Self::Array(to), Self::Array(from)) => to.clone_from(from),
            (Self::Tuple(to), Self::Tuple(from)) => to.clone_from(from),
            (Self::Dict(to), Self::Dict(from)) if to.len() == from.len() => {
                for ((to_key, to), (from_key, from)) in to.iter_mut().zip(from) {
                    to_key.clone_from(from_key);
                    to.clone_from(from);
                }
            }
            (to, from) => *to = from.clone(),
        }
    }
}

/// An element of a `Graph` space.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphInstance {
    /// The nodes as one value, in the form of the node space's [batch](crate::Space::batch): an
    /// array with a row per node, or a tuple or dict of such.
    pub nodes: Value,
    /// The edges as one value; `None` if edges have no features.
    pub edges: Option<Value>,
    /// Shape `(edges, 2)`: source and target node of each edge; `None` exactly if `edges` is.
    pub edge_links: Option<Array>,
}

impl Value {
    /// The whole number of an `Int`.
    pub fn as_int(&self) -> Option<i64> {
        if let Self::Int(i) = self {
            Some(*i)
        } else {
            None
        }
    }

    /// The number of a `Float` or an `Int`.
    pub fn as_float(&self) -> Option<f64> {
        match self {
            Self::Float(x) => Some(*x),
            Self::Int(i) => Some(*i as f64),
            _ => None,
        }
    }

    /// The truth value of a `Bool`.
    pub fn as_bool(&self) -> Option<bool> {
        if let Self::Bool(b) = self {
            Some(*b)
        } else {
            None
        }
    }

    /// The text of a `Text`.
    pub fn as_text(&self) -> Option<&str> {
        if let Self::Text(text) = self {
            Some(text)
        } else {
            None
        }
    }

    /// The array of an `Array`.
    pub fn as_array(&self) -> Option<&Array> {
        if let Self::Array(array) = self {
            Some(array)
        } else {
            None
        }
    }

    /// The numbers of an `Array` of that type, in row-major order.
    pub fn as_slice<T: Scalar>(&self) -> Option<&[T]> {
        self.as_array()?.as_slice()
    }

    /// The members of a `Tuple`.
    pub fn as_tuple(&self) -> Option<&[Value]> {
        if let Self::Tuple(items) = self {
            Some(items)
        } else {
            None
        }
    }

    /// The member of a `Dict` under a key.
    pub fn get(&self, key: &str) -> Option<&Value> {
        let Self::Dict(entries) = self else {
            return None;
        };
        entries
            .iter()
            .find_map(|(name, value)| (name == key).then_some(value))
    }

    /// Whether every number within is finite.
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Float(x) => x.is_finite(),
            Self::Array(array) => array.is_finite(),
            Self::Tuple(items) => items.iter().all(Self::is_finite),
            Self::Dict(entries) => entries.iter().all(|(_, value)| value.is_finite()),
            Self::Graph(graph) => {
                graph.nodes.is_finite() && graph.edges.as_ref().is_none_or(Self::is_finite)
            }
            Self::OneOf(_, value) => value.is_finite(),
            Self::Null | Self::Bool(_) | Self::Int(_) | Self::Text(_) => true,
        }
    }
}

/// Whole numbers, as for a `Discrete` space.
macro_rules! value_from_integer {
    ($($type:ty),*) => {$(
        impl From<$type> for Value {
            fn from(i: $type) -> Self {
                Self::Int(i.into())
            }
        }
    )*};
}
value_from_integer!(i8, u8, i16, u16, i32, u32, i64);

impl From<f32> for Value {
    fn from(x: f32) -> Self {
        Self::Float(x.into())
    }
}

impl From<f64> for Value {
    fn from(x: f64) -> Self {
        Self::Float(x)
    }
}

impl From<bool> for Value {
    fn from(b: bool) -> Self {
        Self::Bool(b)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<Array> for Value {
    fn from(array: Array) -> Self {
        Self::Array(array)
    }
}

/// A one-dimensional array, as for a `Box`, `MultiDiscrete` or `MultiBinary` of one axis.
impl<T: Scalar, const N: usize> From<[T; N]> for Value {
    fn from(numbers: [T; N]) -> Self {
        Self::Array(numbers.into())
    }
}

/// A one-dimensional array.
impl<T: Scalar> From<Vec<T>> for Value {
    fn from(numbers: Vec<T>) -> Self {
        Self::Array(numbers.into())
    }
}

/// A tuple, as for a `Tuple` or `Sequence` space.
impl From<Vec<Value>> for Value {
    fn from(items: Vec<Value>) -> Self {
        Self::Tuple(items)
    }
}

/// A dict; the keys are in the order of their space, which sorts them.
impl<const N: usize> From<[(&str, Value); N]> for Value {
    fn from(entries: [(&str, Value); N]) -> Self {
        Self::Dict(entries.map(|(key, value)| (key.to_owned(), value)).into())
    }
}

/// Compact and readable: `3`, `[0.1 0.2]`, `(1, [0.5])`, `{a: 1}`.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => f.write_str("None"),
            Self::Bool(b) => write!(f, "{b}"),
            Self::Int(i) => write!(f, "{i}"),
            Self::Float(x) if x.is_nan() => f.write_str("nan"),
            Self::Float(x) => write!(f, "{x:?}"),
            Self::Text(text) => write!(f, "{text:?}"),
            Self::Array(array) => write!(f, "{array}"),
            Self::Tuple(items) => {
                f.write_str("(")?;
                for (i, item) in items.iter().enumerate() {
                    write!(f, "{}{item}", if i == 0 { "" } else { ", " })?;
                }
                f.write_str(")")
            }
            Self::Dict(entries) => {
                f.write_str("{")?;
                for (i, (key, value)) in entries.iter().enumerate() {
                    write!(f, "{}{key}: {value}", if i == 0 { "" } else { ", " })?;
                }
                f.write_str("}")
            }
            Self::Graph(graph) => write!(f, "Graph(nodes={})", graph.nodes),
            Self::OneOf(index, value) => write!(f, "({index}, {value})"),
        }
    }
}
