//! Actions of a `Box`, in their own precision.

use std::fmt;

use crate::value::{Data, Element, Value};

/// The precision of an action's numbers, in which numpy computes.
// as wide as a number: native vectors then read both with SIMD, which saves 5 % of a step
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u64)]
pub enum Precision {
    /// `float32`, as samples of most action spaces have it.
    #[default]
    Single,
    /// `float64`, as a controller computes it. An array of integers counts as this.
    Double,
    /// Python numbers, such as the items of a list: they take the precision of the other operand.
    Python,
}

/// An action of `N` numbers for a `Box`, in its own precision.
///
/// Gymnasium computes in the action's precision: a `float64` action gives other last bits than the
/// same action rounded to `float32`. As a [`Value`] it is an array of `float32`, or one of another
/// type for [`Precision::Double`], or a tuple of numbers for [`Precision::Python`].
///
/// ```
/// use gym_core::{Continuous, Precision};
///
/// let push = Continuous::from([0.1]);
/// assert_eq!((push.numbers, push.precision), ([0.1], Precision::Double));
/// assert_eq!(Continuous::from([0.1_f32]).numbers, [f64::from(0.1_f32)]);
/// ```
#[derive(Clone, Copy, PartialEq)]
pub struct Continuous<const N: usize> {
    /// The numbers, without a loss.
    pub numbers: [f64; N],
    /// The previous values.
    pub precision: Precision,
}

impl<const N: usize> Continuous<N> {
    /// Whether all numbers are finite.
    #[inline(always)]
    pub fn is_finite(&self) -> bool {
        self.numbers
            .iter()
            .fold(true, |finite, x| finite & x.is_finite())
    }
}

impl<const N: usize> From<[f32; N]> for Continuous<N> {
    #[inline(always)]
    fn from(numbers: [f32; N]) -> Self {
        // no `map`: the compiler does not always inline `map`, and a call is compiled without the
        // CPU's features
        let mut wide = [0.0; N];
        for (x, y) in wide.iter_mut().zip(numbers) {
            *x = f64::from(y);
        }
        Self {
            numbers: wide,
            precision: Precision::Single,
        }
    }
}

impl<const N: usize> From<[f64; N]> for Continuous<N> {
    #[inline(always)]
    fn from(numbers: [f64; N]) -> Self {
        Self {
            numbers,
            precision: Precision::Double,
        }
    }
}

impl<const N: usize> Default for Continuous<N> {
    fn default() -> Self {
        Self::from([0.0_f32; N])
    }
}

/// Prints the numbers in their precision.
impl<const N: usize> fmt::Debug for Continuous<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.precision {
            Precision::Single => self.numbers.map(|x| x as f32).fmt(f),
            Precision::Double | Precision::Python => self.numbers.fmt(f),
        }
    }
}

impl<const N: usize> Element for Continuous<N> {
    fn empty() -> Self {
        Self::default()
    }

    // inlined, to stay in registers: a copy right after the writes stalls the CPU, for a fifth of a
    // step of Pendulum
    #[inline(always)]
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Array(array) if array.shape() == [N] => Some(match array.data() {
                Data::F32(numbers) => Self::from(<[f32; N]>::try_from(numbers.as_slice()).ok()?),
                Data::F64(numbers) => Self::from(<[f64; N]>::try_from(numbers.as_slice()).ok()?),
                _ => {
                    let mut numbers = [0.0; N];
                    numbers
                        .iter_mut()
                        .zip(array.iter_f64())
                        .for_each(|(x, y)| *x = y);
                    Self::from(numbers)
                }
            }),
            Value::Tuple(items) if items.len() == N => {
                let mut numbers = [0.0; N];
                for (x, item) in numbers.iter_mut().zip(items) {
                    *x = item.as_float()?;
                }
                Some(Self {
                    numbers,
                    precision: Precision::Python,
                })
            }
            _ => None,
        }
    }

    fn write(&self, out: &mut Value) {
        match (self.precision, &mut *out) {
            (Precision::Single, _) => self.numbers.map(|x| x as f32).write(out),
            (Precision::Double, _) => self.numbers.write(out),
            (Precision::Python, Value::Tuple(items)) if items.len() == N => {
                items
                    .iter_mut()
                    .zip(self.numbers)
                    .for_each(|(item, x)| *item = Value::Float(x));
            }
            (Precision::Python, _) => *out = Value::Tuple(self.numbers.map(Value::Float).to_vec()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_keep_their_precision() {
        for action in [
            Continuous::from([0.1_f32, -3.0]),
            Continuous::from([0.1, -3.0]),
            Continuous {
                numbers: [0.1, -3.0],
                precision: Precision::Python,
            },
        ] {
            assert_eq!(Continuous::from_value(&action.to_value()), Some(action));
        }
        let integers = Continuous::<2>::from_value(&Value::Array([1_i64, -3].into()));
        assert_eq!(integers, Some(Continuous::from([1.0, -3.0])));
        for other in [
            Value::Array([0.1_f32].into()),
            Value::Int(1),
            Value::Tuple(vec![Value::Null; 2]),
        ] {
            assert_eq!(Continuous::<2>::from_value(&other), None, "{other}");
        }
    }
}
