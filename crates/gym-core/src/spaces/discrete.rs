//! `Discrete`: a range of integers.

use std::fmt;

use gym_numerics::Generator;
use serde::{Deserialize, Serialize};

use crate::value::number::Number;
use crate::value::{DType, Error, Result, Value};

use super::invalid;
use super::selection::Selection;
use super::weight::Weight;
use crate::value::fault::Fault;

/// The integers `start, ..., start + n - 1`: Gymnasium's `Discrete`.
///
/// ```
/// use gym_core::{Value, spaces::Discrete};
/// let steps = Discrete::new(3)?.with_start(-1)?; // -1, 0, 1
/// assert_eq!(steps.to_string(), "Discrete(3, start=-1)");
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// A sample is uniform. The type is `int64` unless [set](Self::with_dtype). It affects only the
/// stream of random numbers and [`flatten_space`](super::Space::flatten_space), because an element
/// is always a [`Value::Int`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Description")]
pub struct Discrete {
    n: i64,
    start: i64,
    dtype: DType,
}

impl Discrete {
    /// The integers `0, ..., n - 1`.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if `n` is below 1.
    pub fn new(n: i64) -> Result<Self> {
        Self {
            n,
            start: 0,
            dtype: DType::I64,
        }
        .checked()
    }

    /// The same number of integers, beginning at `start`.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if the largest integer does not fit the type.
    pub fn with_start(self, start: i64) -> Result<Self> {
        Self { start, ..self }.checked()
    }

    /// The same integers as numbers of another type.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if the type is not an integer type, or the integers do not fit it.
    pub fn with_dtype(self, dtype: DType) -> Result<Self> {
        Self { dtype, ..self }.checked()
    }

    fn checked(self) -> Result<Self> {
        let Self { n, start, dtype } = self;
        if n < 1 {
            return invalid(format!(
                "Discrete({n}) has no elements: n must be at least 1"
            ));
        }
        if dtype.is_float() {
            return invalid(format!(
                "Discrete cannot be of type {dtype}: choose an integer type"
            ));
        }
        // numpy also stores `n` itself in the type.
        let last = start.checked_add(n - 1).map(i128::from);
        let fits = |number: i128| Number::Int(number).fits(dtype);
        match last {
            Some(last) if fits(last) && fits(start.into()) && fits(n.into()) => Ok(self),
            _ => invalid(format!(
                "{n} integers from {start} on do not fit {dtype}: choose a larger type"
            )),
        }
    }

    /// The number of elements.
    pub fn n(&self) -> i64 {
        self.n
    }

    /// The smallest element.
    pub fn start(&self) -> i64 {
        self.start
    }

    /// The largest element.
    pub fn last(&self) -> i64 {
        self.start + (self.n - 1)
    }

    /// The integer type.
    pub fn dtype(&self) -> DType {
        self.dtype
    }

    pub(super) fn contains(&self, value: &Value) -> bool {
        matches!(*value, Value::Int(i) if self.start <= i && i <= self.last())
    }

    pub(super) fn check(&self, value: &Value) -> Result<(), Fault> {
        let Value::Int(i) = *value else {
            return Err(Fault::kind("a whole number", value));
        };
        if self.contains(value) {
            return Ok(());
        }
        Err(Fault::new(format!(
            "{i} is not between {} and {}",
            self.start,
            self.last()
        )))
    }

    pub(super) fn draw<T: Weight>(
        &self,
        rng: &mut Generator,
        selection: &Selection<T>,
        out: &mut Value,
    ) {
        let index = match selection {
            Selection::Values(weights) => T::choose(weights, rng) as i64,
            _ => self.draw_index(rng),
        };
        *out = Value::Int(self.start + index);
    }

    /// numpy's `integers(n, dtype=...)`, whose draws depend on the size of the type.
    fn draw_index(&self, rng: &mut Generator) -> i64 {
        match self.dtype {
            DType::I8 | DType::U8 => {
                let mut out = [0];
                rng.integers_u8(0, (self.n - 1) as u8, &mut out);
                out[0].into()
            }
            DType::I16 | DType::U16 => rng.integer_u16((self.n - 1) as u16).into(),
            _ => rng.integers(0, self.n),
        }
    }
}

/// Prints as Gymnasium does: `Discrete(3)`, `Discrete(3, start=1)`.
impl fmt::Display for Discrete {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Discrete({}", self.n)?;
        if self.start != 0 {
            write!(f, ", start={}", self.start)?;
        }
        if self.dtype != DType::I64 {
            write!(f, ", dtype={}", self.dtype)?;
        }
        f.write_str(")")
    }
}

/// The stored form, before it is checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    n: i64,
    start: i64,
    dtype: DType,
}

impl TryFrom<Description> for Discrete {
    type Error = Error;

    fn try_from(Description { n, start, dtype }: Description) -> Result<Self> {
        Self { n, start, dtype }.checked()
    }
}

/// Defines an enum of actions, numbered from 0 in the order written, as the elements of
/// `Discrete(n)`.
///
/// ```
/// gym_core::discrete! {
///     /// The direction of the push.
///     pub enum Push {
///         /// To the left.
///         Left,
///         /// To the right.
///         Right,
///     }
/// }
/// assert_eq!(Push::ALL[1], Push::Right);
/// assert_eq!(Push::space().to_string(), "Discrete(2)");
/// ```
#[macro_export]
macro_rules! discrete {
    ($(#[$meta:meta])* $vis:vis enum $name:ident { $($(#[doc = $doc:literal])* $variant:ident),+ $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        $vis enum $name { $($(#[doc = $doc])* $variant),+ }

        impl $name {
            /// Every value, in the order of its number.
            pub const ALL: [Self; [$(Self::$variant),+].len()] = [$(Self::$variant),+];

            /// Names and meanings, in the order of the numbers.
            pub const VARIANTS: &'static [(&'static str, &'static str)] =
                &[$((stringify!($variant), concat!($($doc, "\n"),*))),+];

            /// The space of these values: `Discrete(n)`.
            pub fn space() -> $crate::Space {
                $crate::Space::discrete(Self::ALL.len() as i64)
            }
        }

        impl $crate::Element for $name {
            fn empty() -> Self {
                Self::ALL[0]
            }

            fn from_value(value: &$crate::Value) -> Option<Self> {
                Self::ALL.get(usize::try_from(value.as_int()?).ok()?).copied()
            }

            fn write(&self, out: &mut $crate::Value) {
                *out = $crate::Value::Int(*self as i64);
            }
        }

        impl $crate::spaces::ActionColumn for $name {
            type Item = i64;
            type Items<'a> = &'a [i64];

            fn items(batch: &$crate::Value, n: usize) -> Option<&[i64]> {
                $crate::spaces::indices(batch, n)
            }

            #[inline(always)]
            fn item(items: &[i64], index: usize) -> i64 {
                items[index]
            }

            #[inline(always)]
            fn block<'r, 'a: 'r, const LEN: usize>(
                items: &'a [i64],
                first: usize,
                len: usize,
                room: &'r mut [i64; LEN],
            ) -> &'r [i64; LEN] {
                $crate::spaces::block_of(items, first, len, room)
            }

            // without early exit, which would keep the compiler from vector instructions
            #[inline(always)]
            fn all_valid(items: &[i64], n: usize) -> bool {
                items[..n].iter().fold(true, |valid, item| valid & Self::is_valid(*item))
            }

            #[inline(always)]
            fn is_valid(index: i64) -> bool {
                (index as u64) < Self::ALL.len() as u64
            }

            #[inline(always)]
            fn from_item(index: i64) -> Self {
                // the compiler turns this loop into a minimum and vectorises the minimum; a look-up
                // would not be vectorised
                let mut action = Self::ALL[Self::ALL.len() - 1];
                $(
                    if index == Self::$variant as i64 {
                        action = Self::$variant;
                    }
                )+
                action
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constructors_refuse_empty_and_oversized_ranges() {
        assert!(
            Discrete::new(0)
                .unwrap_err()
                .to_string()
                .contains("n must be at least 1")
        );
        assert!(Discrete::new(-3).is_err());
        let three = Discrete::new(3).unwrap();
        assert!(three.clone().with_start(i64::MAX - 2).is_ok());
        assert!(three.clone().with_start(i64::MAX - 1).is_err());
        assert!(three.clone().with_dtype(DType::F32).is_err());
        assert!(
            three
                .clone()
                .with_dtype(DType::U8)
                .unwrap()
                .with_start(-1)
                .is_err()
        );
        assert!(Discrete::new(128).unwrap().with_dtype(DType::I8).is_err());
        assert!(
            Discrete::new(i64::MAX)
                .unwrap()
                .with_start(i64::MIN)
                .is_ok()
        );
    }

    #[test]
    fn contains_whole_numbers_of_the_range() {
        let space = Discrete::new(3).unwrap().with_start(-1).unwrap();
        for (value, expected) in [
            (-2, false),
            (-1, true),
            (1, true),
            (2, false),
            (i64::MIN, false),
        ] {
            assert_eq!(space.contains(&Value::Int(value)), expected, "{value}");
        }
        assert!(!space.contains(&Value::Float(0.0)) && !space.contains(&Value::Bool(true)));
        let widest = Discrete::new(i64::MAX).unwrap().with_start(1).unwrap();
        assert!(widest.contains(&Value::Int(i64::MAX)) && !widest.contains(&Value::Int(0)));
    }

    #[test]
    fn faults_tell_the_range() {
        let space = Discrete::new(4).unwrap();
        let fault = |value| space.check(&value).unwrap_err().to_string();
        assert_eq!(fault(Value::Int(4)), "4 is not between 0 and 3");
        assert_eq!(
            fault(Value::Float(1.0)),
            "expected a whole number, not a real number"
        );
        assert_eq!(space.check(&Value::Int(3)), Ok(()));
    }

    #[test]
    fn prints_as_gymnasium() {
        let three = Discrete::new(3).unwrap();
        assert_eq!(three.to_string(), "Discrete(3)");
        assert_eq!(
            three.clone().with_start(1).unwrap().to_string(),
            "Discrete(3, start=1)"
        );
        assert_eq!(
            three.with_dtype(DType::I32).unwrap().to_string(),
            "Discrete(3, dtype=int32)"
        );
    }

    #[test]
    fn stored_form_is_checked() {
        let space = Discrete::new(7).unwrap().with_start(-3).unwrap();
        let stored = serde_json::to_string(&space).unwrap();
        assert_eq!(stored, r#"{"n":7,"start":-3,"dtype":"int64"}"#);
        assert_eq!(serde_json::from_str::<Discrete>(&stored).unwrap(), space);
        assert!(serde_json::from_str::<Discrete>(r#"{"n":0,"start":0,"dtype":"int64"}"#).is_err());
    }
}
