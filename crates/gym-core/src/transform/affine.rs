//! The affine map between two boxes: Gymnasium's `rescale_box`, in its order of operations.

use serde_json::Value as Json;

use crate::array::Scalar;
use crate::spaces::BoxSpace;
use crate::{Array, DType, Data, Error, Result, Space};

/// A bound of [`RescaleObservation`](crate::wrappers::RescaleObservation) or
/// [`RescaleAction`](crate::wrappers::RescaleAction): one for all elements, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum Bound {
    /// The bound of every element.
    Scalar(f64),
    /// The bound of each element, in the shape of the space.
    Array(Array),
}

impl From<f64> for Bound {
    fn from(bound: f64) -> Self {
        Self::Scalar(bound)
    }
}

impl From<Array> for Bound {
    fn from(bounds: Array) -> Self {
        Self::Array(bounds)
    }
}

impl<const N: usize> From<[f32; N]> for Bound {
    fn from(bounds: [f32; N]) -> Self {
        Self::Array(bounds.into())
    }
}

impl<const N: usize> From<[f64; N]> for Bound {
    fn from(bounds: [f64; N]) -> Self {
        Self::Array(bounds.into())
    }
}

impl Bound {
    /// A number or nested lists, with infinity as a string.
    pub(crate) fn to_json(&self) -> Json {
        match self {
            Self::Scalar(x) => super::number_to_json(*x),
            Self::Array(array) => {
                let unbounded = BoxSpace::uniform(
                    f64::NEG_INFINITY,
                    f64::INFINITY,
                    array.shape(),
                    if array.dtype().is_float() { array.dtype() } else { DType::F64 },
                );
                let json = unbounded
                    .and_then(|space| Space::from(space).to_json(&crate::Value::Array(array.clone())));
                json.unwrap_or_default()
            }
        }
    }

    /// Reads what [`to_json`](Self::to_json) wrote, for a box.
    pub(crate) fn from_json(json: &Json, space: &Space) -> Result<Self> {
        match json {
            Json::Number(number) => {
                let not_a_bound = || Error::custom(format!("{number} is not a bound"));
                number.as_f64().map(Self::Scalar).ok_or_else(not_a_bound)
            }
            Json::String(text) if text == "inf" => Ok(Self::Scalar(f64::INFINITY)),
            Json::String(text) if text == "-inf" => Ok(Self::Scalar(f64::NEG_INFINITY)),
            _ => {
                let value = space.from_json(json)?;
                value.as_array().cloned().map(Self::Array).ok_or_else(|| super::not_an_array(&value))
            }
        }
    }

    /// The bound of each element, and whether they count as `float32`: numbers in an array have the
    /// type of the box, a single number is a `float64`.
    fn numbers(&self, name: &str, space: &BoxSpace) -> Result<(Vec<f64>, bool)> {
        match self {
            Self::Scalar(x) => Ok((vec![*x; space.low().len()], false)),
            Self::Array(array) if array.shape() == space.shape() => {
                let mut numbers = Array::zeros(space.dtype(), space.shape());
                numbers.assign_cast(array)?;
                Ok((numbers.iter_f64().collect(), space.dtype() == DType::F32))
            }
            Self::Array(array) => {
                let [actual, expected] = [array.shape(), space.shape()];
                Err(Error::custom(format!("{name} has shape {actual:?} and should have {expected:?}")))
            }
        }
    }
}

/// `gradient * x + intercept` for each element, in the type of the box.
#[derive(Clone, Debug)]
pub(crate) enum Affine {
    F32 { gradient: Vec<f32>, intercept: Vec<f32> },
    F64 { gradient: Vec<f64>, intercept: Vec<f64> },
}

impl Affine {
    /// The map from `inner` to the box between `min` and `max`, and that box.
    ///
    /// Infinite bounds must stay as they are; an element with one of them is shifted so that its finite
    /// bound fits.
    pub(crate) fn new(inner: &BoxSpace, min: &Bound, max: &Bound) -> Result<(Self, BoxSpace)> {
        let (shape, dtype) = (inner.shape(), inner.dtype());
        if !dtype.is_float() {
            return Err(Error::custom(format!(
                "the numbers are {dtype}, which holds no fractions: cast them with DtypeObservation first"
            )));
        }
        let (min, min_is_f32) = min.numbers("the lower bound", inner)?;
        let (max, max_is_f32) = max.numbers("the upper bound", inner)?;
        let (low, high): (Vec<f64>, Vec<f64>) =
            (inner.low().iter_f64().collect(), inner.high().iter_f64().collect());
        for (new, old) in min.iter().zip(&low).chain(max.iter().zip(&high)) {
            if (new.is_infinite() || old.is_infinite()) && new != old {
                return Err(Error::custom(format!(
                    "the new bound {new} stands for {old}: a bound is infinite where it was, and only there"
                )));
            }
        }
        if let Some((min, max)) =
            min.iter().zip(&max).find(|(min, max)| min > max || min.is_nan() || max.is_nan())
        {
            return Err(Error::custom(format!(
                "the lower bound {min} must not be above the upper one, {max}"
            )));
        }
        let bounds = |numbers: &[f64]| Array::new(shape, Data::from_f64(DType::F64, numbers.iter().copied()));
        let outer = BoxSpace::with_dtype(bounds(&min)?, bounds(&max)?, dtype)?;
        // numpy rounds a difference of float32 numbers to float32
        let difference = |a: f64, b: f64, is_f32| if is_f32 { f64::from((a - b) as f32) } else { a - b };
        let (mut gradient, mut intercept) = (vec![1.0; min.len()], vec![0.0; min.len()]);
        for i in 0..min.len() {
            if min[i].is_finite() && max[i].is_finite() {
                gradient[i] = difference(max[i], min[i], min_is_f32 && max_is_f32) / (high[i] - low[i]);
            }
            if dtype == DType::F32 {
                gradient[i] = f64::from(gradient[i] as f32);
            }
            if min[i].is_finite() {
                let product = gradient[i] * -low[i];
                let product = if dtype == DType::F32 { f64::from(product as f32) } else { product };
                intercept[i] = product + min[i];
            } else if max[i].is_finite() {
                intercept[i] = difference(max[i], high[i], max_is_f32);
            }
        }
        let map = match dtype {
            DType::F32 => Self::F32 {
                gradient: gradient.iter().map(|x| *x as f32).collect(),
                intercept: intercept.iter().map(|x| *x as f32).collect(),
            },
            _ => Self::F64 { gradient, intercept },
        };
        Ok((map, outer))
    }

    /// Maps an array, or each row of a batch, in place.
    pub(crate) fn forward(&self, array: &mut Array) {
        self.apply(array, |x, a, b| a * x + b, |x, a, b| a * x + b);
    }

    /// Undoes [`forward`](Self::forward).
    pub(crate) fn backward(&self, array: &mut Array) {
        self.apply(array, |x, a, b| (x - b) / a, |x, a, b| (x - b) / a);
    }

    fn apply(&self, array: &mut Array, f32s: fn(f32, f32, f32) -> f32, f64s: fn(f64, f64, f64) -> f64) {
        match self {
            Self::F32 { gradient, intercept } => map_rows(array, gradient, intercept, f32s),
            Self::F64 { gradient, intercept } => map_rows(array, gradient, intercept, f64s),
        }
    }
}

fn map_rows<T: Scalar>(array: &mut Array, gradient: &[T], intercept: &[T], f: fn(T, T, T) -> T) {
    let numbers = array.as_mut_slice::<T>().unwrap_or_default();
    for row in numbers.chunks_exact_mut(gradient.len().max(1)) {
        for (x, (a, b)) in row.iter_mut().zip(gradient.iter().zip(intercept)) {
            *x = f(*x, *a, *b);
        }
    }
}
