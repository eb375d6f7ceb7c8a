//! The bounds of a `Box`: which are possible, and whether numbers lie between them.

use crate::value::array::{Array, Scalar};
use crate::value::fault::Fault;
use crate::value::number::{Number, Numeric, collect, limits, with_type};
use crate::value::{DType, Data};

/// One side of the box.
#[derive(Clone, Copy)]
pub(super) enum Bound {
    Low,
    High,
}

impl Bound {
    /// The bound as a number of the type, and whether it is finite.
    pub(super) fn settle(self, bound: Number, dtype: DType) -> Result<(Number, bool), Fault> {
        let (min, max) = limits(dtype);
        let (name, infinity, limit) = match self {
            Self::Low => ("low", f64::NEG_INFINITY, min),
            Self::High => ("high", f64::INFINITY, max),
        };
        let is_open = bound.to_f64() == infinity;
        let may_be_open = !dtype.is_unsigned();
        if is_open && may_be_open {
            return Ok((if dtype.is_float() { bound } else { limit }, false));
        }
        if bound.fits(dtype) && bound.to_f64().is_finite() {
            return Ok((bound, true));
        }
        let kind = if dtype.is_float() {
            "number"
        } else {
            "whole number"
        };
        let or_open = if may_be_open {
            format!(", or {infinity}")
        } else {
            String::new()
        };
        Err(Fault::new(format!(
            "{name} is {bound}: give {dtype} a {kind} from {min} to {max}{or_open}"
        )))
    }

    pub(super) fn settle_all(
        self,
        bounds: impl Iterator<Item = Number>,
        shape: &[usize],
        dtype: DType,
    ) -> Result<(Array, Vec<bool>), Fault> {
        let settled = bounds.enumerate().map(|(i, bound)| {
            self.settle(bound, dtype)
                .map_err(|fault| fault.at_element(i, shape))
        });
        let (numbers, bounded): (Vec<Number>, Vec<bool>) =
            settled.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        let array = Array::new(shape, collect(dtype, numbers))
            .map_err(|error| Fault::new(error.to_string()))?;
        Ok((array, bounded))
    }
}

/// Returns for each element whether the low and the high bound are finite; `None` for invalid
/// bounds.
pub(super) fn bounded<T: Numeric>(low: &[T], high: &[T]) -> Option<(Vec<bool>, Vec<bool>)> {
    let is_finite = |bound: &T| bound.to_f64().is_finite();
    let are_bounds = low.iter().zip(high).all(|(low, high)| {
        low <= high && low.to_f64() < f64::INFINITY && high.to_f64() > f64::NEG_INFINITY
    });
    are_bounds.then(|| {
        (
            low.iter().map(is_finite).collect(),
            high.iter().map(is_finite).collect(),
        )
    })
}

pub(super) fn all_between(values: &Data, low: &Data, high: &Data) -> bool {
    fn same_type<T: PartialOrd>(values: &[T], low: &[T], high: &[T]) -> bool {
        /// The number of elements compared between two tests for a failure: enough to fill vector
        /// registers.
        const AT_ONCE: usize = 256;
        let parts = values
            .chunks(AT_ONCE)
            .zip(low.chunks(AT_ONCE))
            .zip(high.chunks(AT_ONCE));
        parts.into_iter().all(|((values, low), high)| {
            let between = values
                .iter()
                .zip(low)
                .zip(high)
                .map(|((x, low), high)| (low <= x) & (x <= high));
            between.fold(true, |all, is| all & is)
        })
    }
    let dtype = low.dtype();
    if values.dtype() == dtype {
        return with_type!(dtype, T => match (T::slice(values), T::slice(low), T::slice(high)) {
            (Some(values), Some(low), Some(high)) => same_type(values, low, high),
            _ => false,
        });
    }
    Number::all(values)
        .zip(Number::all(low).zip(Number::all(high)))
        .all(|(x, (low, high))| low <= x && x <= high)
}
