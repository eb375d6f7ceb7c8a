//! Bounds as arguments: one for all elements, or one for each.

use gym_core::spaces::BoxSpace;
use gym_core::{Array, DType, Data, Error, Result};
use serde::{Deserialize, Serialize};

/// A bound of every element of a `Box`, or of each. In JSON it is a number or nested lists of
/// numbers, with infinity as `"inf"` and `"-inf"`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Nested", into = "Nested")]
pub enum Bound {
    /// The bound of every element.
    Scalar(f64),
    /// The bound of each element, in the shape of the space, as `float64`.
    Array(Array),
}

impl gym_core::ArgumentType for Bound {
    fn kind() -> String {
        "number or nested lists of numbers".into()
    }
}

impl Default for Bound {
    fn default() -> Self {
        Self::Scalar(f64::NAN)
    }
}

impl From<f64> for Bound {
    fn from(bound: f64) -> Self {
        Self::Scalar(bound)
    }
}

impl From<Array> for Bound {
    fn from(bounds: Array) -> Self {
        let numbers = Data::F64(bounds.iter_f64().collect());
        // the shape has the same number of elements
        Self::Array(Array::new(bounds.shape(), numbers).unwrap_or_default())
    }
}

impl<const N: usize> From<[f32; N]> for Bound {
    fn from(bounds: [f32; N]) -> Self {
        bounds.map(f64::from).into()
    }
}

impl<const N: usize> From<[f64; N]> for Bound {
    fn from(bounds: [f64; N]) -> Self {
        Self::Array(bounds.into())
    }
}

impl Bound {
    /// The bound of each element, and whether the bounds count as `float32`: an array of bounds has
    /// the type of the box, a scalar bound is `float64`.
    pub(crate) fn numbers(&self, name: &str, space: &BoxSpace) -> Result<(Vec<f64>, bool)> {
        match self {
            Self::Scalar(x) => Ok((vec![*x; space.low().len()], false)),
            Self::Array(array) if array.shape() == space.shape() => {
                let mut numbers = Array::zeros(space.dtype(), space.shape())?;
                numbers.assign_cast(array)?;
                Ok((numbers.iter_f64().collect(), space.dtype() == DType::F32))
            }
            Self::Array(array) => {
                let [actual, expected] = [array.shape(), space.shape()];
                Err(Error::custom(format!(
                    "{name} has shape {actual:?} and should have {expected:?}"
                )))
            }
        }
    }
}

/// The form in JSON.
#[derive(Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number, \"inf\", \"-inf\", or a list of them"
)]
enum Nested {
    Number(f64),
    Infinity(Infinity),
    List(Vec<Nested>),
}

#[derive(Serialize, Deserialize)]
enum Infinity {
    #[serde(rename = "inf")]
    Above,
    #[serde(rename = "-inf")]
    Below,
}

impl Nested {
    fn number(x: f64) -> Self {
        match x {
            f64::INFINITY => Self::Infinity(Infinity::Above),
            f64::NEG_INFINITY => Self::Infinity(Infinity::Below),
            x => Self::Number(x),
        }
    }

    /// Nested lists of a shape, from numbers in row-major order.
    fn list(shape: &[usize], numbers: &mut impl Iterator<Item = f64>) -> Self {
        match shape {
            [] => Self::number(numbers.next().unwrap_or(f64::NAN)),
            [n, rest @ ..] => Self::List((0..*n).map(|_| Self::list(rest, numbers)).collect()),
        }
    }

    /// Appends the numbers to `numbers`, and returns the shape.
    fn flatten(self, numbers: &mut Vec<f64>) -> Result<Vec<usize>, &'static str> {
        match self {
            Self::Number(x) => numbers.push(x),
            Self::Infinity(Infinity::Above) => numbers.push(f64::INFINITY),
            Self::Infinity(Infinity::Below) => numbers.push(f64::NEG_INFINITY),
            Self::List(items) => {
                let mut shape = vec![items.len()];
                for (i, item) in items.into_iter().enumerate() {
                    let row = item.flatten(numbers)?;
                    if i == 0 {
                        shape.extend(row);
                    } else if shape[1..] != row {
                        return Err("the lists of a bound have different lengths");
                    }
                }
                return Ok(shape);
            }
        }
        Ok(Vec::new())
    }
}

impl From<Bound> for Nested {
    fn from(bound: Bound) -> Self {
        match bound {
            Bound::Scalar(x) => Self::number(x),
            Bound::Array(array) => Self::list(array.shape(), &mut array.iter_f64()),
        }
    }
}

impl TryFrom<Nested> for Bound {
    type Error = String;

    fn try_from(nested: Nested) -> Result<Self, String> {
        let mut numbers = Vec::new();
        match nested.flatten(&mut numbers)? {
            shape if shape.is_empty() => Ok(Self::Scalar(numbers[0])),
            shape => Array::new(shape, Data::F64(numbers))
                .map(Self::Array)
                .map_err(|error| error.to_string()),
        }
    }
}
