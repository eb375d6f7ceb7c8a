//! The stored form of a `Box`.

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::BoxSpace;
use crate::spaces::element_count;
use crate::value::array::Array;
use crate::value::number::Number;
use crate::value::stored::plain;
use crate::value::{DType, Error, Result};

/// The stored form. A bound is one number if all elements have equal bounds, and `"inf"` or
/// `"-inf"` for an infinite number.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Description {
    low: Json,
    high: Json,
    shape: Vec<usize>,
    dtype: DType,
}

impl From<BoxSpace> for Description {
    fn from(space: BoxSpace) -> Self {
        let describe = |bounds: &Array, bounded: &[bool], infinity: f64| {
            let number = |(number, &bounded)| {
                plain::write_number(if bounded {
                    number
                } else {
                    Number::Float(infinity)
                })
            };
            // 0 and -0 are different here, so that the sign of a zero bound survives.
            let sign = |bound: &Json| bound.as_f64().map(f64::is_sign_negative);
            let same = |a: &Json, b: &Json| a == b && sign(a) == sign(b);
            let mut all: Vec<Json> = Number::all(bounds.data())
                .zip(bounded)
                .map(number)
                .collect();
            match all.pop() {
                Some(last) if all.iter().all(|bound| same(bound, &last)) => last,
                last => {
                    all.extend(last);
                    Json::Array(all)
                }
            }
        };
        Self {
            low: describe(&space.0.low, &space.0.bounded_below, f64::NEG_INFINITY),
            high: describe(&space.0.high, &space.0.bounded_above, f64::INFINITY),
            shape: space.shape().to_vec(),
            dtype: space.dtype(),
        }
    }
}

impl TryFrom<Description> for BoxSpace {
    type Error = Error;

    fn try_from(description: Description) -> Result<Self> {
        let Description {
            low,
            high,
            shape,
            dtype,
        } = description;
        let bounds = |bounds: &Json| match bounds {
            Json::Array(bounds) => bounds
                .iter()
                .map(plain::parse_number)
                .collect::<Result<Vec<_>, _>>(),
            bound => {
                let len = element_count(&shape)?;
                plain::parse_number(bound).map(|bound| vec![bound; len])
            }
        };
        let numbers = bounds(&low).and_then(|low| Ok((low, bounds(&high)?)));
        let (low, high) = numbers.map_err(|fault| Error::InvalidSpace(fault.to_string()))?;
        Self::from_numbers(low.into_iter(), high.into_iter(), &shape, dtype)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_keep_the_sign_of_zero_in_json() {
        for low in [[0.0, -0.0], [-0.0, 0.0], [-0.0, -0.0], [0.0, 0.0]] {
            let space = BoxSpace::new(low, [1.0, 1.0]).unwrap();
            let again: BoxSpace =
                serde_json::from_value(serde_json::to_value(&space).unwrap()).unwrap();
            let bits =
                |space: &BoxSpace| space.low().iter_f64().map(f64::to_bits).collect::<Vec<_>>();
            assert_eq!(bits(&again), low.map(f64::to_bits));
        }
    }

    #[test]
    fn stored_form_is_checked() {
        let space: BoxSpace =
            serde_json::from_str(r#"{"low":"-inf","high":[1,2.5],"shape":[2],"dtype":"float32"}"#)
                .unwrap();
        assert_eq!(
            space,
            BoxSpace::new([f32::NEG_INFINITY; 2], [1.0, 2.5]).unwrap()
        );
        for bad in [
            r#"{"low":0,"high":[1,2,3],"shape":[2],"dtype":"float32"}"#,
            r#"{"low":2,"high":1,"shape":[2],"dtype":"float32"}"#,
            r#"{"low":null,"high":1,"shape":[2],"dtype":"float32"}"#,
            r#"{"low":0,"high":"inf","shape":[2],"dtype":"uint8"}"#,
            r#"{"low":["inf"],"high":[1],"shape":[0],"dtype":"float32"}"#,
        ] {
            assert!(serde_json::from_str::<BoxSpace>(bad).is_err(), "{bad}");
        }
    }
}
