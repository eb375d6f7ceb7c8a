//! `Box`: arrays of numbers between bounds.

mod bounds;
mod stored;

use std::fmt;
use std::sync::Arc;

use gym_numerics::Generator;
use serde::{Deserialize, Serialize};

use crate::value::array::{Array, Scalar};
use crate::value::number::{Number, Numeric, with_type};
use crate::value::{DType, Error, Result, Value, numpy_fmt};

use super::{array_of, element_count, invalid};
use crate::value::fault::{Fault, expect_array, is_array};
use bounds::{Bound, all_between, bounded};
use stored::Description;

/// Arrays of one shape and type. Each element has its own bounds (inclusive), which may be
/// infinite: Gymnasium's `Box`.
///
/// ```
/// use gym_core::spaces::BoxSpace;
/// use gym_core::DType;
/// let position = BoxSpace::new([-1.5f32, 0.0], [1.5, f32::INFINITY])?;
/// let picture = BoxSpace::uniform(0.0, 255.0, [96, 96, 3], DType::U8)?;
/// assert_eq!(picture.to_string(), "Box(0, 255, (96, 96, 3), uint8)");
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// A sample of a bounded element is uniform. If one bound is infinite, it is the other bound plus
/// or minus an exponential variable; if both are, a normal variable.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Description", into = "Description")]
pub struct BoxSpace(Arc<Bounds>);

/// The bounds, shared by clones of a space, because the bounds of an image are larger than the
/// image.
#[derive(Debug)]
struct Bounds {
    low: Array,
    high: Array,
    bounded_below: Vec<bool>,
    bounded_above: Vec<bool>,
}

impl BoxSpace {
    /// The box between two arrays of one type and shape.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if types or shapes differ, a bound is NaN, or a low bound is above
    /// its high bound.
    pub fn new<A: Into<Array>>(low: A, high: A) -> Result<Self> {
        let (low, high) = (low.into(), high.into());
        let dtype = low.dtype();
        if high.dtype() != dtype {
            return invalid(format!(
                "low is {dtype} and high is {}: make them one type, or use `BoxSpace::with_dtype`",
                high.dtype()
            ));
        }
        Self::with_dtype(low, high, dtype)
    }

    /// The box of numbers of type `dtype` between two arrays of one shape and any types.
    ///
    /// Infinite bounds of a signed integer type become the ends of its range, but the element still
    /// counts as [unbounded](Self::bounded_below) and is sampled as such.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if shapes differ, a bound is NaN, has no number of that type (such
    /// as infinity for an unsigned one), or a low bound is above its high bound.
    pub fn with_dtype(low: impl Into<Array>, high: impl Into<Array>, dtype: DType) -> Result<Self> {
        let (low, high) = (low.into(), high.into());
        if low.shape() != high.shape() {
            let [low, high] = [&low, &high].map(|array| numpy_fmt::shape(array.shape()));
            return invalid(format!(
                "low has shape {low} and high has shape {high}: make them equal"
            ));
        }
        if low.dtype() == dtype && high.dtype() == dtype {
            let bounded = with_type!(dtype, T => match (low.as_slice::<T>(), high.as_slice::<T>()) {
                (Some(low), Some(high)) => bounded(low, high),
                _ => None,
            });
            if let Some((bounded_below, bounded_above)) = bounded {
                return Ok(Self(Arc::new(Bounds {
                    low,
                    high,
                    bounded_below,
                    bounded_above,
                })));
            }
        }
        // `from_numbers` converts the bounds, and returns the error
        Self::from_numbers(
            Number::all(low.data()),
            Number::all(high.data()),
            low.shape(),
            dtype,
        )
    }

    /// The box whose elements all have the same bounds.
    ///
    /// # Errors
    /// The errors of [`with_dtype`](Self::with_dtype).
    pub fn uniform(
        low: f64,
        high: f64,
        shape: impl Into<Vec<usize>>,
        dtype: DType,
    ) -> Result<Self> {
        let shape = shape.into();
        let build = || {
            // Bounds are checked even without elements.
            let (low, bounded_below) = Bound::Low.settle(Number::Float(low), dtype)?;
            let (high, bounded_above) = Bound::High.settle(Number::Float(high), dtype)?;
            let (low, high) =
                with_type!(dtype, T => (T::cast(low).number(), T::cast(high).number()));
            let len = element_count(&shape)?;
            if low > high && len > 0 {
                return Err(
                    Fault::new(format!("low {low} is above high {high}")).at_element(0, &shape)
                );
            }
            let array = |bound| {
                let data = with_type!(dtype, T => T::into_data(vec![T::cast(bound); len]));
                Array::new(shape.as_slice(), data).map_err(|error| Fault::new(error.to_string()))
            };
            let (low, high) = (array(low)?, array(high)?);
            let (bounded_below, bounded_above) =
                (vec![bounded_below; len], vec![bounded_above; len]);
            Ok(Self(Arc::new(Bounds {
                low,
                high,
                bounded_below,
                bounded_above,
            })))
        };
        build().map_err(|fault: Fault| Error::InvalidSpace(fault.to_string()))
    }

    fn from_numbers(
        low: impl Iterator<Item = Number>,
        high: impl Iterator<Item = Number>,
        shape: &[usize],
        dtype: DType,
    ) -> Result<Self> {
        let build = || {
            let (low, bounded_below) = Bound::Low.settle_all(low, shape, dtype)?;
            let (high, bounded_above) = Bound::High.settle_all(high, shape, dtype)?;
            let mut pairs = Number::all(low.data())
                .zip(Number::all(high.data()))
                .enumerate();
            if let Some((i, (low, high))) = pairs.find(|(_, (low, high))| low > high) {
                return Err(
                    Fault::new(format!("low {low} is above high {high}")).at_element(i, shape)
                );
            }
            drop(pairs);
            Ok(Self(Arc::new(Bounds {
                low,
                high,
                bounded_below,
                bounded_above,
            })))
        };
        build().map_err(|fault: Fault| Error::InvalidSpace(fault.to_string()))
    }

    /// The lower bounds.
    pub fn low(&self) -> &Array {
        &self.0.low
    }

    /// The upper bounds.
    pub fn high(&self) -> &Array {
        &self.0.high
    }

    /// The shape of the elements.
    pub fn shape(&self) -> &[usize] {
        self.0.low.shape()
    }

    /// The type of the elements' numbers.
    pub fn dtype(&self) -> DType {
        self.0.low.dtype()
    }

    /// Whether each element has a finite lower bound, in row-major order.
    pub fn bounded_below(&self) -> &[bool] {
        &self.0.bounded_below
    }

    /// Whether each element has a finite upper bound, in row-major order.
    pub fn bounded_above(&self) -> &[bool] {
        &self.0.bounded_above
    }

    /// Whether every bound is finite.
    pub fn is_bounded(&self) -> bool {
        self.0
            .bounded_below
            .iter()
            .chain(&self.0.bounded_above)
            .all(|&bounded| bounded)
    }

    pub(super) fn contains(&self, value: &Value) -> bool {
        is_array(value, self.shape(), self.dtype())
            && value.as_array().is_some_and(|array| {
                all_between(array.data(), self.0.low.data(), self.0.high.data())
            })
    }

    pub(super) fn check(&self, value: &Value) -> Result<(), Fault> {
        let array = expect_array(value, self.shape(), self.dtype())?;
        for i in 0..array.len() {
            let [x, low, high] =
                [array, &self.0.low, &self.0.high].map(|array| Number::at(array.data(), i));
            if !(low <= x && x <= high) {
                let reason = format!("{x} is not between {low} and {high}");
                return Err(Fault::new(reason).at_element(i, self.shape()));
            }
        }
        Ok(())
    }

    pub(super) fn draw(&self, rng: &mut Generator, out: &mut Value) {
        let array = array_of(out, self.dtype(), self.shape());
        with_type!(self.dtype(), T => {
            if let (Some(values), Some(low), Some(high)) =
                (array.as_mut_slice::<T>(), self.0.low.as_slice::<T>(), self.0.high.as_slice::<T>())
            {
                self.draw_into(rng, values, low, high);
            }
        });
    }

    fn draw_into<T: Numeric>(&self, rng: &mut Generator, values: &mut [T], low: &[T], high: &[T]) {
        // Gymnasium draws all elements that are unbounded, then those bounded below, bounded above,
        // and bounded on both sides.
        for kind @ (below, above) in [(false, false), (true, false), (false, true), (true, true)] {
            for i in 0..values.len() {
                if (self.0.bounded_below[i], self.0.bounded_above[i]) != kind {
                    continue;
                }
                let (start, end) = (low[i].to_f64(), high[i].range_end());
                let x = match (below, above) {
                    (false, false) => rng.normal(0.0, 1.0),
                    (true, false) => rng.exponential(1.0) + start,
                    (false, true) => -rng.exponential(1.0) + end,
                    (true, true) => uniform(rng, start, end),
                };
                values[i] = settle(x, low[i], high[i]);
            }
        }
    }
}

/// Gymnasium's equality: the bounds agree to about five digits (numpy's `allclose`, here with the
/// larger of the two sizes so that the order does not matter).
impl PartialEq for BoxSpace {
    fn eq(&self, other: &Self) -> bool {
        self.shape() == other.shape()
            && self.dtype() == other.dtype()
            && all_close(&self.0.low, &other.0.low)
            && all_close(&self.0.high, &other.0.high)
    }
}

fn all_close(a: &Array, b: &Array) -> bool {
    const RELATIVE: f64 = 1e-5;
    const ABSOLUTE: f64 = 1e-8;
    a.iter_f64().zip(b.iter_f64()).all(|(a, b)| {
        a == b
            || (a - b).abs() <= ABSOLUTE + RELATIVE * a.abs().max(b.abs())
                && a.is_finite()
                && b.is_finite()
    })
}

/// Prints as Gymnasium does: `Box(-1.0, 1.0, (2,), float32)`.
impl fmt::Display for BoxSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] =
            [&self.0.low, &self.0.high].map(|array| numpy_fmt::bound(array.data(), array.shape()));
        write!(
            f,
            "Box({low}, {high}, {}, {})",
            numpy_fmt::shape(self.shape()),
            self.dtype()
        )
    }
}

/// numpy's `uniform`, which refuses a range wider than the largest `f64`.
fn uniform(rng: &mut Generator, start: f64, end: f64) -> f64 {
    if (end - start).is_finite() {
        rng.uniform(start, end)
    } else {
        let r = rng.random();
        start * (1.0 - r) + end * r
    }
}

/// Converts a drawn number to an element. Integers are rounded down and kept within the bounds.
fn settle<T: Numeric>(x: f64, low: T, high: T) -> T {
    /// From this number on, numpy's cast to `int64` overflows to the smallest `int64`.
    const I64_END: f64 = (1u64 << 63) as f64;

    if T::DTYPE.is_float() {
        return T::cast(Number::Float(x));
    }
    if T::DTYPE == DType::I64 && x >= I64_END {
        return low;
    }
    let x = T::cast(Number::Float(x.floor()));
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::value::Data;

    fn error(result: Result<BoxSpace>) -> String {
        result.unwrap_err().to_string()
    }

    #[test]
    fn whole_arrays_are_checked_as_single_numbers_are() {
        let (low, high) = ([f32::NEG_INFINITY, -1.0, 0.0], [0.5, f32::INFINITY, 0.0]);
        let numbers = |bounds: [f32; 3]| bounds.map(|x| Number::Float(x.into())).into_iter();
        let one_by_one =
            BoxSpace::from_numbers(numbers(low), numbers(high), &[3], DType::F32).unwrap();
        let space = BoxSpace::new(low, high).unwrap();
        assert_eq!(
            (space.low(), space.high()),
            (one_by_one.low(), one_by_one.high())
        );
        assert_eq!(
            (space.bounded_below(), space.bounded_above()),
            (&[false, true, true][..], &[true, false, true][..])
        );
        assert_eq!(space.bounded_below(), one_by_one.bounded_below());
        assert_eq!(space.bounded_above(), one_by_one.bounded_above());
        assert!(
            std::ptr::eq(space.low(), space.clone().low()),
            "clones share their bounds"
        );

        let large = BoxSpace::uniform(0.0, 1.0, [1000], DType::F32).unwrap();
        for wrong in 0..1000 {
            let mut value = vec![0.5f32; 1000];
            assert!(large.contains(&Value::Array(value.clone().into())));
            value[wrong] = if wrong % 2 == 0 { 2.0 } else { f32::NAN };
            assert!(!large.contains(&Value::Array(value.into())), "{wrong}");
        }
    }

    #[test]
    fn constructors_refuse_bad_bounds() {
        use DType::*;
        let text = error(BoxSpace::new([0.0f32, 2.0], [1.0, 1.0]));
        assert_eq!(text, "invalid space: [1]: low 2.0 is above high 1.0");
        assert!(
            error(BoxSpace::new([f64::NAN], [1.0]))
                .contains("low is NaN: give float64 a number from")
        );
        let mixed = BoxSpace::new(Array::from([0.0f32]), Array::from([1.0f64]));
        assert!(error(mixed).contains("use `BoxSpace::with_dtype`"));
        assert!(
            error(BoxSpace::new(
                Array::from([0.0f32]),
                Array::from([1.0f32, 1.0])
            ))
            .contains("low has shape (1,) and high has shape (2,)")
        );
        for (low, high, dtype) in [
            (0.0, f64::INFINITY, U8),
            (-1.0, 1.0, U32),
            (0.0, 256.0, U8),
            (-1e39, 0.0, F32),
            (0.5, 1.0, I64),
            (f64::INFINITY, f64::INFINITY, F64),
            (f64::NEG_INFINITY, f64::NEG_INFINITY, F64),
            (0.0, f64::NAN, F32),
        ] {
            assert!(
                BoxSpace::uniform(low, high, [2], dtype).is_err(),
                "{low} {high} {dtype}"
            );
            assert!(
                BoxSpace::uniform(low, high, [0], dtype).is_err(),
                "{low} {high} {dtype}, empty"
            );
        }
        assert!(BoxSpace::uniform(0.0, 1.0, [usize::MAX, 2], F32).is_err());
    }

    #[test]
    fn infinite_bounds_of_integers_become_limits_but_stay_unbounded() {
        let space =
            BoxSpace::with_dtype([f64::NEG_INFINITY, 0.0], [5.0, f64::INFINITY], DType::I32)
                .unwrap();
        assert_eq!(space.low(), &Array::from([i32::MIN, 0]));
        assert_eq!(space.high(), &Array::from([5, i32::MAX]));
        assert_eq!(
            (space.bounded_below(), space.bounded_above()),
            (&[false, true][..], &[true, false][..])
        );
        assert!(!space.is_bounded());
        let stored = serde_json::to_string(&space).unwrap();
        assert_eq!(
            stored,
            r#"{"low":["-inf",0],"high":[5,"inf"],"shape":[2],"dtype":"int32"}"#
        );
        let restored: BoxSpace = serde_json::from_str(&stored).unwrap();
        assert_eq!(restored, space);
        assert_eq!(restored.bounded_below(), space.bounded_below());
    }

    #[test]
    fn contains_takes_castable_arrays_of_the_shape() {
        let space = BoxSpace::uniform(-1.0, 3.0, [2], DType::F32).unwrap();
        let contains = |array: Array| space.contains(&Value::Array(array));
        assert!(
            contains([-1.0f32, 3.0].into())
                && contains([0i16, 3].into())
                && contains([1u8, 2].into())
        );
        assert!(!contains([0.0f64, 0.0].into()) && !contains([0i32, 0].into()));
        assert!(
            !contains([0.0f32, 3.1].into())
                && !contains([0.0f32, f32::NAN].into())
                && !contains([4i16, 0].into())
        );
        assert!(!contains([0.0f32].into()) && !contains(Array::zeros(DType::F32, [2, 1]).unwrap()));
        assert!(!space.contains(&Value::Float(0.0)));

        let unbounded =
            BoxSpace::uniform(f64::NEG_INFINITY, f64::INFINITY, [], DType::F64).unwrap();
        let scalar = |x: f64| Value::Array(Array::new([], Data::F64(vec![x])).unwrap());
        assert!(
            unbounded.contains(&scalar(f64::INFINITY)) && !unbounded.contains(&scalar(f64::NAN))
        );
        let whole = BoxSpace::new([i64::MIN], [i64::MAX - 1]).unwrap();
        assert!(whole.contains(&Value::Array([i64::MAX - 1].into())));
        assert!(!whole.contains(&Value::Array([i64::MAX].into())));
    }

    #[test]
    fn faults_name_the_element() {
        let space = BoxSpace::uniform(0.0, 1.0, [2, 2], DType::F32).unwrap();
        let fault = |array: Array| space.check(&Value::Array(array)).unwrap_err().to_string();
        let values = Array::from([0.0f32, 0.0, 2.5, 0.0]);
        assert_eq!(
            fault(values.clone()),
            "the shape is (4,) and should be (2, 2)"
        );
        assert_eq!(
            fault(values.reshape([2, 2]).unwrap()),
            "[1, 0]: 2.5 is not between 0.0 and 1.0"
        );
        assert_eq!(
            fault(Array::zeros(DType::F64, [2, 2]).unwrap()),
            "the numbers are float64 and should be float32: convert them first"
        );
        assert_eq!(
            space.check(&Value::Int(1)).unwrap_err().to_string(),
            "expected an array, not a whole number"
        );
    }

    #[test]
    fn prints_as_gymnasium() {
        let cart = BoxSpace::new(
            [-4.8, f32::NEG_INFINITY, -0.418_879_03, f32::NEG_INFINITY],
            [4.8, f32::INFINITY, 0.418_879_03, f32::INFINITY],
        );
        assert_eq!(
            cart.unwrap().to_string(),
            "Box([-4.8               -inf -0.41887903        -inf], \
             [4.8               inf 0.41887903        inf], (4,), float32)"
        );
        let scalar = BoxSpace::uniform(0.0, 1.0, [], DType::F64).unwrap();
        assert_eq!(scalar.to_string(), "Box(0.0, 1.0, (), float64)");
    }

    #[test]
    fn equality_allows_rounding() {
        let space = |high: f64| BoxSpace::uniform(0.0, high, [2], DType::F64).unwrap();
        assert_eq!(space(1.0), space(1.0 + 1e-9));
        assert_ne!(space(1.0), space(1.0 + 1e-4));
        assert_eq!(space(f64::INFINITY), space(f64::INFINITY));
        assert_ne!(space(f64::INFINITY), space(1.0));
        assert_ne!(
            space(1.0),
            BoxSpace::uniform(0.0, 1.0, [2], DType::F32).unwrap()
        );
        assert_ne!(
            space(1.0),
            BoxSpace::uniform(0.0, 1.0, [2, 1], DType::F64).unwrap()
        );
    }

    #[test]
    fn samples_lie_within() {
        let mut rng = Generator::from(1);
        let mut out = Value::Null;
        for space in [
            BoxSpace::new([i64::MIN, i64::MAX - 3], [i64::MAX, i64::MAX]).unwrap(),
            BoxSpace::new([0u64, u64::MAX], [u64::MAX, u64::MAX]).unwrap(),
            BoxSpace::new([f64::MIN], [f64::MAX]).unwrap(),
            BoxSpace::new([f32::MIN], [f32::MAX]).unwrap(),
            BoxSpace::with_dtype([f64::NEG_INFINITY], [-100.0], DType::I8).unwrap(),
        ] {
            for _ in 0..200 {
                space.draw(&mut rng, &mut out);
                assert!(space.contains(&out), "{out} in {space}");
            }
        }
    }
}
