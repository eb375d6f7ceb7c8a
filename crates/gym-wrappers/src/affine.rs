//! The affine map between two boxes: Gymnasium's `rescale_box`, in its order of operations.

use gym_core::array::Scalar;
use gym_core::spaces::BoxSpace;
use gym_core::{Array, DType, Data, Error, Result};

use crate::Bound;

/// `gradient * x + intercept` for each element, in the type of the box.
#[derive(Clone, Debug)]
pub(crate) enum Affine {
    F32 {
        gradient: Vec<f32>,
        intercept: Vec<f32>,
    },
    F64 {
        gradient: Vec<f64>,
        intercept: Vec<f64>,
    },
}

impl Affine {
    /// Returns the map from `inner` to the box between `min` and `max`, and the box.
    ///
    /// Infinite bounds must stay infinite. The map shifts an element with one infinite bound, from
    /// its finite bound to the new finite bound.
    pub(crate) fn new(inner: &BoxSpace, min: &Bound, max: &Bound) -> Result<(Self, BoxSpace)> {
        let (shape, dtype) = (inner.shape(), inner.dtype());
        if !dtype.is_float() {
            return Err(Error::custom(format!(
                "{dtype} holds no fractions: cast the observations with DtypeObservation first"
            )));
        }
        let (min, min_is_f32) = min.numbers("the lower bound", inner)?;
        let (max, max_is_f32) = max.numbers("the upper bound", inner)?;
        let (low, high): (Vec<f64>, Vec<f64>) = (
            inner.low().iter_f64().collect(),
            inner.high().iter_f64().collect(),
        );
        for (new, old) in min.iter().zip(&low).chain(max.iter().zip(&high)) {
            if (new.is_infinite() || old.is_infinite()) && new != old {
                return Err(Error::custom(format!(
                    "the new bound {new} replaces {old}: both must be finite, or both infinite"
                )));
            }
        }
        if let Some((min, max)) = min
            .iter()
            .zip(&max)
            .find(|(min, max)| min > max || min.is_nan() || max.is_nan())
        {
            return Err(Error::custom(format!(
                "the lower bound {min} must not be above the upper one, {max}"
            )));
        }
        let bounds = |numbers: &[f64]| {
            Array::new(shape, Data::from_f64(DType::F64, numbers.iter().copied()))
        };
        let outer = BoxSpace::with_dtype(bounds(&min)?, bounds(&max)?, dtype)?;
        // numpy rounds a difference of float32 numbers to float32
        let difference = |a: f64, b: f64, is_f32| {
            if is_f32 {
                f64::from((a - b) as f32)
            } else {
                a - b
            }
        };
        let (mut gradient, mut intercept) = (vec![1.0; min.len()], vec![0.0; min.len()]);
        for i in 0..min.len() {
            if min[i].is_finite() && max[i].is_finite() {
                gradient[i] =
                    difference(max[i], min[i], min_is_f32 && max_is_f32) / (high[i] - low[i]);
            }
            if dtype == DType::F32 {
                gradient[i] = f64::from(gradient[i] as f32);
            }
            if min[i].is_finite() {
                let product = gradient[i] * -low[i];
                let product = if dtype == DType::F32 {
                    f64::from(product as f32)
                } else {
                    product
                };
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
            _ => Self::F64 {
                gradient,
                intercept,
            },
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

    fn apply(
        &self,
        array: &mut Array,
        f32s: fn(f32, f32, f32) -> f32,
        f64s: fn(f64, f64, f64) -> f64,
    ) {
        match self {
            // a `float64` array is mapped in `float64`
            Self::F32 {
                gradient,
                intercept,
            } if array.dtype() == DType::F64 => {
                map_rows(array, gradient, intercept, |x: f64, a, b| {
                    f64s(x, f64::from(a), f64::from(b))
                });
            }
            Self::F32 {
                gradient,
                intercept,
            } => map_rows(array, gradient, intercept, f32s),
            Self::F64 {
                gradient,
                intercept,
            } => map_rows(array, gradient, intercept, f64s),
        }
    }
}

fn map_rows<T: Scalar, C: Copy>(
    array: &mut Array,
    gradient: &[C],
    intercept: &[C],
    f: impl Fn(T, C, C) -> T,
) {
    let numbers = array.as_mut_slice::<T>().unwrap_or_default();
    for row in numbers.chunks_exact_mut(gradient.len().max(1)) {
        for (x, (a, b)) in row.iter_mut().zip(gradient.iter().zip(intercept)) {
            *x = f(*x, *a, *b);
        }
    }
}
