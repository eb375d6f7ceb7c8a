//! Single numbers of any type, and numpy's rules of conversion.

use std::cmp::Ordering;
use std::fmt;

use crate::value::data::{DType, Data, Scalar};

/// Evaluates `$body` with `$type` standing for the Rust type of a [`DType`], or, after `numbers`,
/// with `$values` bound to the numbers of a [`Data`] of any type.
#[doc(hidden)]
#[macro_export]
macro_rules! with_type {
    (numbers $data:expr, $values:ident => $body:expr) => {
        $crate::with_type!(@all numbers $data, $values => $body)
    };
    ($dtype:expr, $type:ident => $body:expr) => {
        $crate::with_type!(@all type $dtype, $type => $body)
    };
    (@all $kind:tt $of:expr, $name:ident => $body:expr) => {
        $crate::with_type!(@$kind $of, $name => $body;
            I8 i8, U8 u8, I16 i16, U16 u16, I32 i32, U32 u32, I64 i64, U64 u64, F32 f32, F64 f64)
    };
    (@numbers $data:expr, $values:ident => $body:expr; $($variant:ident $rust:ty),*) => {
        match $data { $($crate::Data::$variant($values) => $body,)* }
    };
    (@type $dtype:expr, $type:ident => $body:expr; $($variant:ident $rust:ty),*) => {
        match $dtype { $($crate::DType::$variant => { type $type = $rust; $body })* }
    };
}

pub(crate) use with_type;

/// One number, exactly.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Number {
    Int(i128),
    Float(f64),
}

impl Number {
    /// Rounded to the nearest `f64`.
    pub(crate) fn to_f64(self) -> f64 {
        match self {
            Self::Int(i) => i as f64,
            Self::Float(x) => x,
        }
    }

    /// Returns the number as an `i128` if the number is an integer.
    pub(crate) fn to_int(self) -> Option<i128> {
        match self {
            Self::Int(i) => Some(i),
            Self::Float(x) => (x.fract() == 0.0).then_some(x as i128),
        }
    }

    /// Returns the number as an `i64` if the number is an integer that fits.
    pub(crate) fn to_i64(self) -> Option<i64> {
        i64::try_from(self.to_int()?).ok()
    }

    /// The element of an array in row-major order.
    pub(crate) fn at(data: &Data, index: usize) -> Self {
        with_type!(numbers data, values => values[index].number())
    }

    /// All elements of an array in row-major order.
    pub(crate) fn all(data: &Data) -> impl Iterator<Item = Self> + '_ {
        (0..data.len()).map(|index| Self::at(data, index))
    }

    /// Whether `dtype` can represent the number. Fractions are rounded to the precision of `dtype`.
    /// Infinities fit the float types; NaN fits no type.
    pub(crate) fn fits(self, dtype: DType) -> bool {
        let (min, max) = limits(dtype);
        match self {
            Self::Float(x) if dtype.is_float() => x.is_infinite() || (min <= self && self <= max),
            _ => self.to_int().is_some() && min <= self && self <= max,
        }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Int(i) => write!(f, "{i}"),
            Self::Float(x) => write!(f, "{x:?}"),
        }
    }
}

impl PartialEq for Number {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl PartialOrd for Number {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match (self, other) {
            (Self::Int(a), Self::Int(b)) => Some(a.cmp(b)),
            _ => self.to_f64().partial_cmp(&other.to_f64()),
        }
    }
}

/// A number type that [`Number`] can hold exactly.
pub(crate) trait Numeric: Scalar + PartialOrd {
    const MIN: Self;
    const MAX: Self;

    fn number(self) -> Number;

    /// Rounded to the nearest `f64`.
    fn to_f64(self) -> f64;

    /// The end of the half-open range whose last number is `self`: `self` for a real type, `self +
    /// 1` for an integer type, rounded to the nearest `f64`.
    fn range_end(self) -> f64;

    /// Converts as numpy's `astype`: truncates a fraction, and wraps an integer that is too large.
    fn cast(number: Number) -> Self;
}

macro_rules! numeric {
    (@end Int, $x:expr, $type:ty) => {
        $x.checked_add(1).map_or(<$type>::MAX as f64 + 1.0, |end| end as f64)
    };
    (@end Float, $x:expr, $type:ty) => { f64::from($x) };
    ($kind:ident, $wide:ty: $($type:ty),*) => {$(
        impl Numeric for $type {
            const MIN: Self = <$type>::MIN;
            const MAX: Self = <$type>::MAX;

            #[inline]
            fn number(self) -> Number {
                Number::$kind(<$wide>::from(self))
            }

            #[inline]
            fn to_f64(self) -> f64 {
                self as f64
            }

            #[inline]
            fn range_end(self) -> f64 {
                numeric!(@end $kind, self, $type)
            }

            #[inline]
            fn cast(number: Number) -> Self {
                match number {
                    Number::Int(i) => i as Self,
                    Number::Float(x) => x as Self,
                }
            }
        }
    )*};
}
numeric!(Int, i128: i8, u8, i16, u16, i32, u32, i64, u64);
numeric!(Float, f64: f32, f64);

/// The smallest and the largest finite number of a type.
pub(crate) fn limits(dtype: DType) -> (Number, Number) {
    with_type!(dtype, T => (<T as Numeric>::MIN.number(), <T as Numeric>::MAX.number()))
}

/// Numbers of a type, each made with [`Numeric::cast`].
pub(crate) fn collect(dtype: DType, numbers: impl IntoIterator<Item = Number>) -> Data {
    with_type!(dtype, T => T::into_data(numbers.into_iter().map(T::cast).collect()))
}

/// Numbers of any type as [`Data`].
pub(crate) fn into_data<T: Scalar>(numbers: Vec<T>) -> Data {
    T::into_data(numbers)
}

fn bits(dtype: DType) -> u32 {
    match dtype {
        DType::I8 | DType::U8 => 8,
        DType::I16 | DType::U16 => 16,
        DType::I32 | DType::U32 | DType::F32 => 32,
        DType::I64 | DType::U64 | DType::F64 => 64,
    }
}

/// numpy's `can_cast(from, to)`: whether `to` can represent every number of `from`. As in numpy,
/// `float64` can represent 64-bit integers.
#[inline]
pub(crate) fn can_cast(from: DType, to: DType) -> bool {
    from == to || promote(from, to) == to
}

/// numpy's `promote_types`: the smallest type that the numbers of both fit.
fn promote(a: DType, b: DType) -> DType {
    match (a.is_float(), b.is_float()) {
        (true, true) => wider(a, b),
        (true, false) => promote(b, a),
        (false, true) if bits(a) <= 16 => b,
        (false, true) => DType::F64,
        (false, false) => match (a.is_unsigned(), b.is_unsigned()) {
            (true, false) if bits(a) < bits(b) => b,
            (true, false) => match a {
                DType::U8 => DType::I16,
                DType::U16 => DType::I32,
                DType::U32 => DType::I64,
                _ => DType::F64,
            },
            (false, true) => promote(b, a),
            _ => wider(a, b),
        },
    }
}

fn wider(a: DType, b: DType) -> DType {
    if bits(a) >= bits(b) { a } else { b }
}

/// numpy's `result_type` of `dtypes`; `None` for no types. If there is a float type, the function
/// promotes it with each other type one by one, rather than with the common type of the others.
pub(crate) fn result_type(dtypes: impl IntoIterator<Item = DType>) -> Option<DType> {
    let mut dtypes: Vec<_> = dtypes.into_iter().collect();
    dtypes.sort_by_key(|dtype| !dtype.is_float());
    dtypes.into_iter().reduce(promote)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn promotion_is_numpys() {
        use DType::*;
        for (types, expected) in [
            (vec![I8, U8], I16),
            (vec![U16, I16], I32),
            (vec![U32, I8], I64),
            (vec![U64, I8], F64),
            (vec![U64, U8], U64),
            (vec![I16, F32], F32),
            (vec![I32, F32], F64),
            (vec![F64, I8], F64),
            (vec![I16, U16, F32], F32),
            (vec![U16, F32, I16], F32),
            (vec![I64], I64),
        ] {
            assert_eq!(result_type(types.clone()), Some(expected), "{types:?}");
        }
        assert_eq!(result_type([]), None);
    }

    #[test]
    fn casts_are_safe() {
        use DType::*;
        for (from, to) in [
            (I16, F32),
            (I64, F64),
            (U64, F64),
            (U8, I16),
            (F32, F64),
            (I32, I64),
        ] {
            assert!(can_cast(from, to) && !can_cast(to, from), "{from} {to}");
        }
        assert!(!can_cast(U64, I64) && !can_cast(I64, U64) && !can_cast(I32, F32));
    }

    #[test]
    fn numbers_compare_exactly_and_know_their_types() {
        assert!(Number::Int(i128::from(u64::MAX)) > Number::Int(i128::from(u64::MAX) - 1));
        assert!(Number::Int(1) < Number::Float(1.5));
        assert_eq!(Number::Int(2), Number::Float(2.0));
        assert!(
            Number::Float(f64::NAN)
                .partial_cmp(&Number::Int(0))
                .is_none()
        );

        assert!(Number::Int(255).fits(DType::U8) && !Number::Int(256).fits(DType::U8));
        assert!(!Number::Int(-1).fits(DType::U64));
        assert!(Number::Float(3.0).fits(DType::I8) && !Number::Float(3.5).fits(DType::I8));
        assert!(Number::Float(0.1).fits(DType::F32) && !Number::Float(1e39).fits(DType::F32));
        assert!(Number::Float(f64::INFINITY).fits(DType::F32));
        assert!(!Number::Float(f64::INFINITY).fits(DType::I64));
        assert!(!Number::Float(f64::NAN).fits(DType::F64));
        assert!(!Number::Float(9.3e18).fits(DType::I64));
    }
}
