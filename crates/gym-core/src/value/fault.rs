//! Why a value is not in a space.

use std::fmt;

use crate::value::array::Array;
use crate::value::number::can_cast;
use crate::value::{DType, Value, numpy_fmt};

/// The fault of a value or a description, and its place.
#[derive(Debug, PartialEq)]
pub(crate) struct Fault {
    /// `["x"][1]`; empty at the top.
    path: String,
    reason: String,
}

impl Fault {
    pub(crate) fn new(reason: impl Into<String>) -> Self {
        Self {
            path: String::new(),
            reason: reason.into(),
        }
    }

    /// The value is of another kind.
    pub(crate) fn kind(expected: &str, value: &Value) -> Self {
        let actual = match value {
            Value::Null => "nothing",
            Value::Bool(_) => "a truth value",
            Value::Int(_) => "a whole number",
            Value::Float(_) => "a real number",
            Value::Text(_) => "a text",
            Value::Array(_) => "an array",
            Value::Tuple(_) => "a tuple",
            Value::Dict(_) => "a dict",
            Value::Graph(_) => "a graph",
            Value::OneOf(..) => "an index with a value",
        };
        Self::new(format!("expected {expected}, not {actual}"))
    }

    /// Adds to the fault's place the key of the member with the fault.
    #[must_use]
    pub(crate) fn under(self, key: &str) -> Self {
        self.within(format_args!("[{key:?}]"))
    }

    /// Adds to the fault's place the index of the member with the fault.
    #[must_use]
    pub(crate) fn at(self, index: usize) -> Self {
        self.within(format_args!("[{index}]"))
    }

    /// Adds to the fault's place the indices of the array element with the fault. `flat` is its
    /// index in row-major order.
    #[must_use]
    pub(crate) fn at_element(self, flat: usize, shape: &[usize]) -> Self {
        let mut rest = flat;
        let mut index: Vec<usize> = shape
            .iter()
            .rev()
            .map(|&n| {
                // `flat` may be the index of a superfluous number, and an axis may have length 0.
                let n = n.max(1);
                let i = rest % n;
                rest /= n;
                i
            })
            .collect();
        index.reverse();
        if index.is_empty() {
            self
        } else {
            self.within(format_args!("{index:?}"))
        }
    }

    #[must_use]
    pub(crate) fn within(mut self, part: impl fmt::Display) -> Self {
        self.path.insert_str(0, &part.to_string());
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.path.is_empty() {
            f.write_str(&self.reason)
        } else {
            write!(f, "{}: {}", self.path, self.reason)
        }
    }
}

/// Returns the array of `value` if the array has the shape `shape` and its numbers can be cast to
/// `dtype`.
#[inline]
pub(crate) fn expect_array<'a>(
    value: &'a Value,
    shape: &[usize],
    dtype: DType,
) -> Result<&'a Array, Fault> {
    match value {
        Value::Array(array) if array.has_shape(shape) && can_cast(array.dtype(), dtype) => {
            Ok(array)
        }
        _ => Err(no_such_array(value, shape, dtype)),
    }
}

#[cold]
fn no_such_array(value: &Value, shape: &[usize], dtype: DType) -> Fault {
    let Value::Array(array) = value else {
        return Fault::kind("an array", value);
    };
    if !array.has_shape(shape) {
        let [actual, expected] = [array.shape(), shape].map(numpy_fmt::shape);
        return Fault::new(format!("the shape is {actual} and should be {expected}"));
    }
    Fault::new(format!(
        "the numbers are {} and should be {dtype}: convert them first",
        array.dtype()
    ))
}

/// Whether [`expect_array`] succeeds; allocates nothing.
pub(crate) fn is_array(value: &Value, shape: &[usize], dtype: DType) -> bool {
    value
        .as_array()
        .is_some_and(|array| array.has_shape(shape) && can_cast(array.dtype(), dtype))
}
