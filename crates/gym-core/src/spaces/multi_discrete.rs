//! `MultiDiscrete`: arrays of integers, each from its own range.

use std::fmt;

use gym_numerics::Generator;
use serde::{Deserialize, Serialize};

use crate::value::array::Array;
use crate::value::number::{Number, Numeric, with_type};
use crate::value::{DType, Data, Error, Result, Value, numpy_fmt};

use super::selection::Selection;
use super::weight::Weight;
use super::{array_of, invalid};
use crate::value::fault::{Fault, expect_array, is_array};

/// Arrays whose elements are the integers `start, ..., start + n - 1`, with `n` and `start` for
/// each: Gymnasium's `MultiDiscrete`.
///
/// ```
/// use gym_core::spaces::MultiDiscrete;
/// let buttons = MultiDiscrete::new([5, 2, 2])?;
/// assert_eq!(buttons.to_string(), "MultiDiscrete([5 2 2])");
/// let offset = MultiDiscrete::new([3, 4])?.with_start([10, -2])?;
/// assert_eq!(offset.to_string(), "MultiDiscrete([3 4], start=[10 -2])");
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// A sample is uniform. The elements are of type `int64` unless [set](Self::with_dtype).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Description")]
pub struct MultiDiscrete {
    shape: Vec<usize>,
    nvec: Vec<i64>,
    start: Vec<i64>,
    dtype: DType,
}

impl MultiDiscrete {
    /// The arrays of the shape of `nvec` whose elements are `0, ..., nvec - 1`.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] unless each element of `nvec` is a whole number of 1 or more.
    pub fn new(nvec: impl Into<Array>) -> Result<Self> {
        let nvec = nvec.into();
        let (shape, nvec) = (nvec.shape().to_vec(), integers("nvec", &nvec)?);
        Self {
            start: vec![0; nvec.len()],
            shape,
            nvec,
            dtype: DType::I64,
        }
        .checked()
    }

    /// The integers from `start` on, `nvec` of them for each element.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if the shapes differ, or an element's largest integer does not fit
    /// the type.
    pub fn with_start(self, start: impl Into<Array>) -> Result<Self> {
        let start = start.into();
        if start.shape() != self.shape {
            let [start, shape] = [start.shape(), &self.shape].map(numpy_fmt::shape);
            return invalid(format!(
                "start has shape {start} and nvec has shape {shape}: make them equal"
            ));
        }
        Self {
            start: integers("start", &start)?,
            ..self
        }
        .checked()
    }

    /// The same integers as numbers of another type.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if the type is not an integer type, or the integers do not fit it.
    pub fn with_dtype(self, dtype: DType) -> Result<Self> {
        Self { dtype, ..self }.checked()
    }

    fn checked(self) -> Result<Self> {
        let dtype = self.dtype;
        if dtype.is_float() {
            return invalid(format!(
                "MultiDiscrete cannot be of type {dtype}: choose an integer type"
            ));
        }
        let fits = |number: i64| Number::Int(number.into()).fits(dtype);
        for (i, (&n, &start)) in self.nvec.iter().zip(&self.start).enumerate() {
            let reason = match n.checked_sub(1).and_then(|last| start.checked_add(last)) {
                _ if n < 1 => format!("n is {n} and must be at least 1"),
                Some(last) if fits(start) && fits(last) && fits(n) => continue,
                _ => {
                    format!("{n} integers from {start} on do not fit {dtype}: choose a larger type")
                }
            };
            return invalid(Fault::new(reason).at_element(i, &self.shape).to_string());
        }
        Ok(self)
    }

    /// The shape of the elements.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// The number of values of each element, in row-major order.
    pub fn nvec(&self) -> &[i64] {
        &self.nvec
    }

    /// The smallest integer of each element, in row-major order.
    pub fn start(&self) -> &[i64] {
        &self.start
    }

    /// The integer type.
    pub fn dtype(&self) -> DType {
        self.dtype
    }

    /// The smallest and the largest integer of each element.
    pub(super) fn ranges(&self) -> impl Iterator<Item = (i64, i64)> + '_ {
        self.nvec
            .iter()
            .zip(&self.start)
            .map(|(n, start)| (*start, start + (n - 1)))
    }

    pub(super) fn contains(&self, value: &Value) -> bool {
        fn inside<T: Numeric>(values: &[T], ranges: impl Iterator<Item = (i64, i64)>) -> bool {
            values
                .iter()
                .zip(ranges)
                .all(|(x, (start, last))| match x.number().to_int() {
                    Some(x) => i128::from(start) <= x && x <= i128::from(last),
                    None => false,
                })
        }
        let Value::Array(array) = value else {
            return false;
        };
        is_array(value, &self.shape, self.dtype)
            && with_type!(array.dtype(), T => {
                array.as_slice::<T>().is_some_and(|values| inside(values, self.ranges()))
            })
    }

    pub(super) fn check(&self, value: &Value) -> Result<(), Fault> {
        let array = expect_array(value, &self.shape, self.dtype)?;
        for (i, (x, (start, last))) in Number::all(array.data()).zip(self.ranges()).enumerate() {
            if x < Number::Int(start.into()) || x > Number::Int(last.into()) {
                let reason = format!("{x} is not between {start} and {last}");
                return Err(Fault::new(reason).at_element(i, &self.shape));
            }
        }
        Ok(())
    }

    pub(super) fn draw<T: Weight>(
        &self,
        rng: &mut Generator,
        selection: &Selection<T>,
        out: &mut Value,
    ) {
        let array = array_of(out, self.dtype, &self.shape);
        with_type!(self.dtype, N => {
            for (i, value) in array.as_mut_slice::<N>().into_iter().flatten().enumerate() {
                let index = match selection {
                    Selection::Each(weights) => T::choose_rescaled(&weights[i], rng) as i64,
                    // a single list of weights for all nodes of a graph equals the same list for
                    // each node
                    Selection::Values(weights) => T::choose_rescaled(weights, rng) as i64,
                    _ => (rng.random() * self.nvec[i] as f64) as i64,
                };
                *value = N::cast(Number::Int((self.start[i] + index).into()));
            }
        });
    }

    /// Numbers in this space's shape, as numpy prints them.
    fn text(&self, numbers: &[i64]) -> String {
        numpy_fmt::array(
            &Data::from_i64(self.dtype, numbers.iter().copied()),
            &self.shape,
        )
    }

    /// Converts to an array of the space's type.
    pub(super) fn array(&self, numbers: &[i64]) -> Array {
        let data = Data::from_i64(self.dtype, numbers.iter().copied());
        Array::new(self.shape.clone(), data).unwrap_or_default()
    }
}

/// The numbers of an array, if they are whole and fit `i64`.
fn integers(name: &str, array: &Array) -> Result<Vec<i64>> {
    let ints: Option<Vec<i64>> = Number::all(array.data()).map(Number::to_i64).collect();
    ints.map_or_else(
        || {
            invalid(format!(
                "{name} is {array}: give whole numbers that fit int64"
            ))
        },
        Ok,
    )
}

/// Prints as Gymnasium does: `MultiDiscrete([3 4])`.
impl fmt::Display for MultiDiscrete {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "MultiDiscrete({}", self.text(&self.nvec))?;
        if self.start.iter().any(|&start| start != 0) {
            write!(f, ", start={}", self.text(&self.start))?;
        }
        f.write_str(")")
    }
}

/// The stored form, before it is checked: `nvec` and `start` in row-major order.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    shape: Vec<usize>,
    nvec: Vec<i64>,
    start: Vec<i64>,
    dtype: DType,
}

impl TryFrom<Description> for MultiDiscrete {
    type Error = Error;

    fn try_from(stored: Description) -> Result<Self> {
        let [nvec, start] = [stored.nvec, stored.start]
            .map(|numbers| Array::from(numbers).reshape(stored.shape.clone()));
        Self::new(nvec?)?
            .with_start(start?)?
            .with_dtype(stored.dtype)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space() -> MultiDiscrete {
        MultiDiscrete::new([3, 4])
            .unwrap()
            .with_start([10, -2])
            .unwrap()
    }

    #[test]
    fn constructors_refuse_empty_and_oversized_ranges() {
        let text = MultiDiscrete::new([3, 0]).unwrap_err().to_string();
        assert_eq!(text, "invalid space: [1]: n is 0 and must be at least 1");
        assert!(MultiDiscrete::new([1.5]).is_err() && MultiDiscrete::new([u64::MAX]).is_err());
        assert!(MultiDiscrete::new([i64::MIN]).is_err());
        assert!(
            space()
                .with_start([1])
                .unwrap_err()
                .to_string()
                .contains("make them equal")
        );
        assert!(space().with_start([i64::MAX, 0]).is_err());
        assert!(space().with_dtype(DType::U8).is_err() && space().with_dtype(DType::F64).is_err());
        assert_eq!(space().with_dtype(DType::I8).unwrap().dtype(), DType::I8);
    }

    #[test]
    fn contains_castable_arrays_in_range() {
        let contains = |array: Array| space().contains(&Value::Array(array));
        assert!(
            contains([10i64, -2].into())
                && contains([12i32, 1].into())
                && contains([12i8, 0].into())
        );
        assert!(
            !contains([13i64, 0].into())
                && !contains([9i64, 0].into())
                && !contains([10i64, 2].into())
        );
        assert!(!contains([10.0f64, 0.0].into()) && !contains([10u64, 0].into()));
        assert!(!contains([10i64].into()) && !space().contains(&Value::Tuple(vec![])));
        // `x - start` would overflow here.
        let edge = MultiDiscrete::new([10])
            .unwrap()
            .with_start([-128])
            .unwrap()
            .with_dtype(DType::I8)
            .unwrap();
        assert!(!edge.contains(&Value::Array([127i8].into())));
        assert!(edge.contains(&Value::Array([-119i8].into())));
    }

    #[test]
    fn faults_name_the_element() {
        let fault = space().check(&Value::Array([10i64, 5].into())).unwrap_err();
        assert_eq!(fault.to_string(), "[1]: 5 is not between -2 and 1");
    }

    #[test]
    fn prints_as_gymnasium() {
        assert_eq!(space().to_string(), "MultiDiscrete([3 4], start=[10 -2])");
        let table = Array::from([1, 2, 3, 4]).reshape([2, 2]).unwrap();
        assert_eq!(
            MultiDiscrete::new(table).unwrap().to_string(),
            "MultiDiscrete([[1 2]\n [3 4]])"
        );
    }

    #[test]
    fn stored_form_is_checked() {
        let stored = serde_json::to_string(&space()).unwrap();
        assert_eq!(
            stored,
            r#"{"shape":[2],"nvec":[3,4],"start":[10,-2],"dtype":"int64"}"#
        );
        assert_eq!(
            serde_json::from_str::<MultiDiscrete>(&stored).unwrap(),
            space()
        );
        let bad = stored.replace("[2]", "[3]");
        assert!(serde_json::from_str::<MultiDiscrete>(&bad).is_err());
    }
}
