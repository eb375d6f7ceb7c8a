//! `MultiBinary`: arrays of zeros and ones.

use std::fmt;

use gym_numerics::Generator;
use serde::{Deserialize, Serialize};

use crate::value::number::{Number, Numeric, with_type};
use crate::value::{Array, DType, Error, Result, Value, numpy_fmt};

use super::selection::Selection;
use super::weight::Weight;
use super::{array_of, element_count, invalid};
use crate::value::fault::{self, Fault};

/// Arrays of one shape whose elements are 0 or 1: Gymnasium's `MultiBinary`.
///
/// ```
/// use gym_core::spaces::MultiBinary;
/// assert_eq!(MultiBinary::new([6])?.to_string(), "MultiBinary(6)");
/// assert_eq!(MultiBinary::new([2, 3])?.to_string(), "MultiBinary((2, 3))");
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// A sample is a fair coin toss per element, of type `int8`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Description")]
pub struct MultiBinary {
    shape: Vec<usize>,
}

impl MultiBinary {
    /// The type of the samples.
    pub(super) const DTYPE: DType = DType::I8;

    /// The arrays of that shape.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if a length is 0.
    pub fn new(shape: impl Into<Vec<usize>>) -> Result<Self> {
        let shape = shape.into();
        let text = numpy_fmt::shape(&shape);
        if shape.contains(&0) {
            return invalid(format!(
                "MultiBinary cannot have shape {text}: every length must be at least 1"
            ));
        }
        element_count(&shape).map_err(|fault| Error::InvalidSpace(fault.to_string()))?;
        Ok(Self { shape })
    }

    /// The shape of the elements.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Accepts numbers of any type, as Gymnasium does.
    pub(super) fn contains(&self, value: &Value) -> bool {
        let Value::Array(array) = value else {
            return false;
        };
        array.shape() == self.shape
            && with_type!(numbers array.data(), values => values.iter().all(|x| [0.0, 1.0].contains(&x.to_f64())))
    }

    pub(super) fn check(&self, value: &Value) -> Result<(), Fault> {
        let array = self.expect_array(value)?;
        let is_binary = |x: Number| x == Number::Int(0) || x == Number::Int(1);
        match Number::all(array.data())
            .enumerate()
            .find(|(_, x)| !is_binary(*x))
        {
            None => Ok(()),
            Some((i, x)) => {
                Err(Fault::new(format!("{x} is neither 0 nor 1")).at_element(i, &self.shape))
            }
        }
    }

    /// The array of a value, if it has the shape of the elements.
    pub(super) fn expect_array<'a>(&self, value: &'a Value) -> Result<&'a Array, Fault> {
        let own_type = value.as_array().map_or(Self::DTYPE, Array::dtype);
        fault::expect_array(value, &self.shape, own_type)
    }

    pub(super) fn draw<T: Weight>(
        &self,
        rng: &mut Generator,
        selection: &Selection<T>,
        out: &mut Value,
    ) {
        let array = array_of(out, Self::DTYPE, &self.shape);
        let Some(values) = array.as_mut_slice::<i8>() else {
            return;
        };
        match selection {
            Selection::Values(weights) => T::toss(weights, rng, values),
            _ => rng.tosses(values),
        }
    }
}

/// Prints as Gymnasium does: `MultiBinary(3)`, `MultiBinary((2, 3))`.
impl fmt::Display for MultiBinary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.shape[..] {
            [n] => write!(f, "MultiBinary({n})"),
            _ => write!(f, "MultiBinary({})", numpy_fmt::shape(&self.shape)),
        }
    }
}

/// The stored form, before it is checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    shape: Vec<usize>,
}

impl TryFrom<Description> for MultiBinary {
    type Error = Error;

    fn try_from(Description { shape }: Description) -> Result<Self> {
        Self::new(shape)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constructor_refuses_empty_axes() {
        assert!(
            MultiBinary::new([2, 0])
                .unwrap_err()
                .to_string()
                .contains("at least 1")
        );
        assert!(MultiBinary::new([usize::MAX, 2]).is_err());
        assert!(MultiBinary::new([]).is_ok());
    }

    #[test]
    fn contains_zeros_and_ones_of_any_type() {
        let space = MultiBinary::new([2]).unwrap();
        let contains = |array: Array| space.contains(&Value::Array(array));
        assert!(
            contains([0i8, 1].into())
                && contains([1.0f64, 0.0].into())
                && contains([1u64, 1].into())
        );
        assert!(
            !contains([0i8, 2].into())
                && !contains([0.5f32, 0.0].into())
                && !contains([-1i8, 0].into())
        );
        assert!(!contains([1i8].into()) && !space.contains(&Value::Int(1)));
    }

    #[test]
    fn faults_name_the_element() {
        let space = MultiBinary::new([1, 2]).unwrap();
        let values = Array::from([0i8, 3]).reshape([1, 2]).unwrap();
        let fault = space.check(&Value::Array(values)).unwrap_err();
        assert_eq!(fault.to_string(), "[0, 1]: 3 is neither 0 nor 1");
    }

    #[test]
    fn pieces_give_the_bytes_of_the_whole() {
        for n in [1, 63, 64, 65, 130, 200] {
            let (mut values, mut bytes) = (vec![0; n], vec![0; n]);
            let (mut a, mut b) = (Generator::from(3), Generator::from(3));
            a.tosses(&mut values);
            b.integers_u8(0, 1, &mut bytes);
            assert!(
                values
                    .iter()
                    .zip(&bytes)
                    .all(|(value, byte)| *value as u8 == *byte),
                "{n}"
            );
            assert_eq!(a, b);
        }
    }
}
