//! Dynamic values: the observations and actions of an erased environment.
//!
//! A typed environment observes `[f32; 4]` and takes an enum; [`BoxEnv`](crate::BoxEnv) uses
//! [`Value`] for both. [`Element`] converts between them.

use std::fmt;

use crate::array::{Array, Scalar};

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
    /// One row per node.
    pub nodes: Array,
    /// One row per edge; `None` if edges have no features.
    pub edges: Option<Array>,
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
                graph.nodes.is_finite() && graph.edges.as_ref().is_none_or(Array::is_finite)
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

/// The observation or action type of a typed environment, and its form as a [`Value`].
///
/// | type | is an element of |
/// |---|---|
/// | `i64`, `usize`, `u8`, `u32` | a `Discrete` |
/// | an enum of [`discrete!`](crate::discrete) | a `Discrete`, from 0 on |
/// | `[T; N]` of numbers | a `Box`, `MultiDiscrete` or `MultiBinary` of one axis |
/// | [`Continuous<N>`](crate::Continuous) | an action in a `Box` of one axis, in its own precision |
/// | [`Array`] | these of any shape |
/// | [`String`] | a `Text` |
/// | tuples of two to four of these | a `Tuple` |
/// | [`Value`] | any space; the only one for a `Dict`, `Sequence`, `Graph` or `OneOf` |
///
/// A type of your own needs three functions: [`empty`](Self::empty),
/// [`from_value`](Self::from_value) and [`write`](Self::write).
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an observation or action type",
    note = "the types are `i64`, `usize`, `u8`, `u32`, enums of `discrete!`, arrays `[T; N]` of numbers, `String`, and \
            tuples of two to four of these; `Array` takes any length and shape, and `Value` anything, such as dicts"
)]
pub trait Element: Clone + fmt::Debug + PartialEq + Send + 'static {
    /// A buffer for [`reset_into`](crate::Env::reset_into) and [`step_into`](crate::Env::step_into)
    /// to fill; its content before is meaningless.
    fn empty() -> Self;

    /// The typed form; `None` if kind, type, shape or range do not fit.
    fn from_value(value: &Value) -> Option<Self>;

    /// Writes the dynamic form, reusing the storage of `out` if type and shape agree.
    fn write(&self, out: &mut Value);

    /// The dynamic form.
    fn to_value(&self) -> Value {
        let mut value = Value::Null;
        self.write(&mut value);
        value
    }

    /// Calls `f` with the typed form of `value`. A type that a `Value` contains is borrowed, not
    /// copied.
    fn with<R>(value: &Value, f: impl FnOnce(&Self) -> R) -> Option<R> {
        Self::from_value(value).map(|element| f(&element))
    }

    /// Calls `f` to fill a typed form, then writes its dynamic form to `out`. A type that a `Value`
    /// contains is filled in place.
    fn fill<R>(out: &mut Value, f: impl FnOnce(&mut Self) -> R) -> R {
        let mut element = Self::empty();
        let result = f(&mut element);
        element.write(out);
        result
    }
}

impl Element for Value {
    fn empty() -> Self {
        Self::Null
    }

    fn from_value(value: &Value) -> Option<Self> {
        Some(value.clone())
    }

    fn write(&self, out: &mut Value) {
        out.clone_from(self);
    }

    fn with<R>(value: &Value, f: impl FnOnce(&Self) -> R) -> Option<R> {
        Some(f(value))
    }

    fn fill<R>(out: &mut Value, f: impl FnOnce(&mut Self) -> R) -> R {
        f(out)
    }
}

impl Element for Array {
    fn empty() -> Self {
        Self::default()
    }

    /// A tuple of numbers is an array of `float64`, as numpy's `asarray` makes one of a list.
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Array(array) => Some(array.clone()),
            Value::Tuple(items) => {
                let numbers: Option<Vec<f64>> = items.iter().map(Value::as_float).collect();
                numbers.map(Self::from)
            }
            _ => None,
        }
    }

    fn write(&self, out: &mut Value) {
        if let Value::Array(array) = out {
            array.clone_from(self);
        } else {
            *out = Value::Array(self.clone());
        }
    }

    fn with<R>(value: &Value, f: impl FnOnce(&Self) -> R) -> Option<R> {
        match value {
            Value::Array(array) => Some(f(array)),
            _ => Self::from_value(value).map(|array| f(&array)),
        }
    }

    fn fill<R>(out: &mut Value, f: impl FnOnce(&mut Self) -> R) -> R {
        if !matches!(out, Value::Array(_)) {
            *out = Value::Array(Self::default());
        }
        let Value::Array(array) = out else {
            unreachable!("`out` was just made an array")
        };
        f(array)
    }
}

impl<T: Scalar, const N: usize> Element for [T; N] {
    fn empty() -> Self {
        [T::default(); N]
    }

    fn from_value(value: &Value) -> Option<Self> {
        let array = value.as_array()?;
        if array.shape() != [N] {
            return None;
        }
        array.as_slice::<T>()?.try_into().ok()
    }

    fn write(&self, out: &mut Value) {
        if let Value::Array(array) = out
            && array.shape().len() == 1
            && let Some(slice) = array.as_mut_slice::<T>()
            && let Ok(slice) = <&mut [T; N]>::try_from(slice)
        {
            *slice = *self;
            return;
        }
        *out = Value::Array(Array::from(self.to_vec()));
    }
}

macro_rules! integer_element {
    ($($type:ty),*) => {$(
        impl Element for $type {
            fn empty() -> Self {
                0
            }

            fn from_value(value: &Value) -> Option<Self> {
                value.as_int()?.try_into().ok()
            }

            fn write(&self, out: &mut Value) {
                *out = Value::Int(*self as i64);
            }
        }
    )*};
}
integer_element!(i64, usize, u8, u32);

impl Element for String {
    fn empty() -> Self {
        Self::new()
    }

    fn from_value(value: &Value) -> Option<Self> {
        value.as_text().map(str::to_owned)
    }

    fn write(&self, out: &mut Value) {
        if let Value::Text(text) = out {
            text.clone_from(self);
        } else {
            *out = Value::Text(self.clone());
        }
    }
}

macro_rules! tuple_element {
    ($($name:ident $index:tt),*) => {
        impl<$($name: Element),*> Element for ($($name,)*) {
            fn empty() -> Self {
                ($($name::empty(),)*)
            }

            fn from_value(value: &Value) -> Option<Self> {
                let items = value.as_tuple()?;
                if items.len() != [$($index),*].len() {
                    return None;
                }
                Some(($($name::from_value(&items[$index])?,)*))
            }

            fn write(&self, out: &mut Value) {
                const LEN: usize = [$($index),*].len();
                if !matches!(out, Value::Tuple(items) if items.len() == LEN) {
                    *out = Value::Tuple(vec![Value::Null; LEN]);
                }
                if let Value::Tuple(items) = out {
                    $(self.$index.write(&mut items[$index]);)*
                }
            }
        }
    };
}
tuple_element!(A 0, B 1);
tuple_element!(A 0, B 1, C 2);
tuple_element!(A 0, B 1, C 2, D 3);

/// Defines an enum of actions, numbered from 0 in the order written, as the elements of
/// `Discrete(n)`.
///
/// ```
/// gym_core::discrete! {
///     /// The direction of the push.
///     pub enum Push {
///         /// To the left.
///         Left,
///         /// To the right.
///         Right,
///     }
/// }
/// assert_eq!(Push::ALL[1], Push::Right);
/// assert_eq!(Push::space().to_string(), "Discrete(2)");
/// ```
#[macro_export]
macro_rules! discrete {
    ($(#[$meta:meta])* $vis:vis enum $name:ident { $($(#[doc = $doc:literal])* $variant:ident),+ $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        $vis enum $name { $($(#[doc = $doc])* $variant),+ }

        impl $name {
            /// Every value, in the order of its number.
            pub const ALL: [Self; [$(Self::$variant),+].len()] = [$(Self::$variant),+];

            /// Names and meanings, in the order of the numbers.
            pub const VARIANTS: &'static [(&'static str, &'static str)] =
                &[$((stringify!($variant), concat!($($doc, "\n"),*))),+];

            /// The space of these values: `Discrete(n)`.
            pub fn space() -> $crate::Space {
                $crate::Space::discrete(Self::ALL.len() as i64)
            }
        }

        impl $crate::Element for $name {
            fn empty() -> Self {
                Self::ALL[0]
            }

            fn from_value(value: &$crate::Value) -> Option<Self> {
                Self::ALL.get(usize::try_from(value.as_int()?).ok()?).copied()
            }

            fn write(&self, out: &mut $crate::Value) {
                *out = $crate::Value::Int(*self as i64);
            }
        }

        impl $crate::vector::ActionColumn for $name {
            type Item = i64;
            type Items<'a> = &'a [i64];

            fn items(batch: &$crate::Value, n: usize) -> Option<&[i64]> {
                $crate::vector::indices(batch, n)
            }

            #[inline(always)]
            fn item(items: &[i64], index: usize) -> i64 {
                items[index]
            }

            #[inline(always)]
            fn block<'r, 'a: 'r, const LEN: usize>(
                items: &'a [i64],
                first: usize,
                len: usize,
                room: &'r mut [i64; LEN],
            ) -> &'r [i64; LEN] {
                $crate::vector::block_of(items, first, len, room)
            }

            // without early exit, which would keep the compiler from vector instructions
            #[inline(always)]
            fn all_valid(items: &[i64], n: usize) -> bool {
                items[..n].iter().fold(true, |valid, item| valid & Self::is_valid(*item))
            }

            #[inline(always)]
            fn is_valid(index: i64) -> bool {
                (index as u64) < Self::ALL.len() as u64
            }

            #[inline(always)]
            fn from_item(index: i64) -> Self {
                // the compiler turns this into a minimum, which vectorises; a look-up would not
                let mut action = Self::ALL[Self::ALL.len() - 1];
                $(
                    if index == Self::$variant as i64 {
                        action = Self::$variant;
                    }
                )+
                action
            }
        }
    };
}
