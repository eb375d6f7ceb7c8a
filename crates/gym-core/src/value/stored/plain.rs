//! Numbers in plain JSON: arrays as nested lists, infinities and NaN as texts.

use gym_numerics::exact::{float_text, parse_float};
use serde_json::Value as Json;

use crate::value::fault::Fault;
use crate::value::number::{Number, collect};
use crate::value::{Array, DType};

pub(crate) fn read_array(json: &Json, shape: &[usize], dtype: DType) -> Result<Array, Fault> {
    let mut numbers = Vec::new();
    read_numbers(json, shape, dtype, &mut numbers)?;
    Array::new(shape, collect(dtype, numbers)).map_err(|error| Fault::new(error.to_string()))
}

fn read_numbers(
    json: &Json,
    shape: &[usize],
    dtype: DType,
    out: &mut Vec<Number>,
) -> Result<(), Fault> {
    let Some((&n, inner)) = shape.split_first() else {
        out.push(read_number(json, dtype)?);
        return Ok(());
    };
    let items = list(json)?;
    check_length(items, n)?;
    for (i, item) in items.iter().enumerate() {
        read_numbers(item, inner, dtype, out).map_err(|fault| fault.at(i))?;
    }
    Ok(())
}

/// A number rounded to the precision of `dtype`, if it fits.
pub(crate) fn read_number(json: &Json, dtype: DType) -> Result<Number, Fault> {
    let number = parse_number(json)?;
    if number.fits(dtype) || dtype.is_float() && number.to_f64().is_nan() {
        Ok(number)
    } else {
        Err(Fault::new(format!(
            "{number} is not a number of type {dtype}"
        )))
    }
}

pub(crate) fn list(json: &Json) -> Result<&Vec<Json>, Fault> {
    json.as_array().ok_or_else(|| Fault::new("expected a list"))
}

pub(crate) fn check_length(items: &[Json], expected: usize) -> Result<(), Fault> {
    let actual = items.len();
    if actual == expected {
        return Ok(());
    }
    Err(Fault::new(format!(
        "the list has {actual} items and should have {expected}"
    )))
}

/// Reads a number: a JSON number, or the text `"inf"`, `"-inf"` or `"NaN"`.
pub(crate) fn parse_number(json: &Json) -> Result<Number, Fault> {
    let number = match json {
        Json::Number(number) => match (number.as_i64(), number.as_u64()) {
            (Some(i), _) => Some(Number::Int(i.into())),
            (_, Some(i)) => Some(Number::Int(i.into())),
            _ => number.as_f64().map(Number::Float),
        },
        Json::String(text) => parse_float(text).map(Number::Float),
        _ => None,
    };
    number.ok_or_else(|| {
        Fault::new(format!(
            "expected a number, \"inf\", \"-inf\" or \"NaN\", not {json}"
        ))
    })
}

/// The form that [`parse_number`] reads.
pub(crate) fn write_number(number: Number) -> Json {
    match number {
        Number::Int(i) => i64::try_from(i).map_or_else(|_| Json::from(i as u64), Json::from),
        Number::Float(x) => float_text(x).map_or_else(|| x.into(), Json::from),
    }
}

/// The numbers of an array as nested lists; a single number where the shape is `[]`.
pub(crate) fn rows(array: &Array) -> Json {
    fn rows(array: &Array, axis: usize, start: usize) -> Json {
        match array.shape()[axis..].split_first() {
            None => write_number(Number::at(array.data(), start)),
            Some((&n, inner)) => {
                let stride: usize = inner.iter().product();
                (0..n)
                    .map(|i| rows(array, axis + 1, start + i * stride))
                    .collect()
            }
        }
    }
    rows(array, 0, 0)
}
