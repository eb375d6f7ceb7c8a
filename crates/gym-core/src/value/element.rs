//! Rust types as elements of spaces.

use std::fmt;

use crate::value::Value;
use crate::value::array::{Array, Scalar};

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

    /// Reads a tuple of numbers as an array of `float64`, as numpy's `asarray` reads a list.
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
