//! What holds of every float of a state: that it is finite, or not too large.

use std::fmt;

use serde::Serialize;
use serde::ser::{self, Serializer};

/// Whether every float of a state is finite. For states that come from outside.
pub fn is_finite<T: Serialize + ?Sized>(state: &T) -> bool {
    every_float(state, f64::is_finite)
}

/// Whether `holds` is true of every float of a state, as its `Serialize` shows it: a field that is
/// added later is covered too.
pub fn every_float<T: Serialize + ?Sized>(state: &T, holds: impl Fn(f64) -> bool) -> bool {
    state.serialize(Every(&holds)).is_ok()
}

/// A serializer that writes nothing, and fails at a float of which its function is false.
#[derive(Clone, Copy)]
struct Every<'a>(&'a dyn Fn(f64) -> bool);

/// A float of which the function is false.
#[derive(Debug)]
struct Found;

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a float is not as it must be")
    }
}

impl std::error::Error for Found {}

impl ser::Error for Found {
    fn custom<T: fmt::Display>(_: T) -> Self {
        Self
    }
}

/// Methods by what they do with their arguments.
macro_rules! look {
    (skip { $($skipped:ident($($skip:ty),*);)* } into { $($into:ident($($before:ty),*);)* }
     parts { $($part:ident($($about:ty),*) -> $whole:ident;)* }) => {
        $(fn $skipped(self, $(_: $skip),*) -> Result<(), Found> {
            Ok(())
        })*
        $(fn $into<T: Serialize + ?Sized>(self, $(_: $before,)* value: &T) -> Result<(), Found> {
            value.serialize(self)
        })*
        $(
            type $whole = Self;

            fn $part(self, $(_: $about),*) -> Result<Self, Found> {
                Ok(self)
            }
        )*
    };
}

impl Serializer for Every<'_> {
    type Ok = ();
    type Error = Found;

    fn serialize_f32(self, value: f32) -> Result<(), Found> {
        self.serialize_f64(value.into())
    }

    fn serialize_f64(self, value: f64) -> Result<(), Found> {
        (self.0)(value).then_some(()).ok_or(Found)
    }

    look! {
        skip {
            serialize_bool(bool);
            serialize_i8(i8);
            serialize_i16(i16);
            serialize_i32(i32);
            serialize_i64(i64);
            serialize_i128(i128);
            serialize_u8(u8);
            serialize_u16(u16);
            serialize_u32(u32);
            serialize_u64(u64);
            serialize_u128(u128);
            serialize_char(char);
            serialize_str(&str);
            serialize_bytes(&[u8]);
            serialize_unit();
            serialize_none();
            serialize_unit_struct(&'static str);
            serialize_unit_variant(&'static str, u32, &'static str);
        }
        into {
            serialize_some();
            serialize_newtype_struct(&'static str);
            serialize_newtype_variant(&'static str, u32, &'static str);
        }
        parts {
            serialize_seq(Option<usize>) -> SerializeSeq;
            serialize_tuple(usize) -> SerializeTuple;
            serialize_tuple_struct(&'static str, usize) -> SerializeTupleStruct;
            serialize_tuple_variant(&'static str, u32, &'static str, usize) -> SerializeTupleVariant;
            serialize_map(Option<usize>) -> SerializeMap;
            serialize_struct(&'static str, usize) -> SerializeStruct;
            serialize_struct_variant(&'static str, u32, &'static str, usize) -> SerializeStructVariant;
        }
    }
}

macro_rules! look_at_items {
    ($($part:ident { $($method:ident($($key:ty)?))* })*) => {$(
        impl ser::$part for Every<'_> {
            type Ok = ();
            type Error = Found;

            $(fn $method<T: Serialize + ?Sized>(&mut self, $(_: $key,)? value: &T) -> Result<(), Found> {
                value.serialize(*self)
            })*

            fn end(self) -> Result<(), Found> {
                Ok(())
            }
        }
    )*};
}

look_at_items! {
    SerializeSeq { serialize_element() }
    SerializeTuple { serialize_element() }
    SerializeTupleStruct { serialize_field() }
    SerializeTupleVariant { serialize_field() }
    SerializeStruct { serialize_field(&'static str) }
    SerializeStructVariant { serialize_field(&'static str) }
    SerializeMap { serialize_key() serialize_value() }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn a_float_is_found_wherever_it_is() {
        #[derive(Serialize)]
        struct Tuple(u8, f32);
        #[derive(Serialize)]
        enum Kind {
            Whole(f64),
            Pair(f64, f64),
            Named { x: f64 },
            Unit,
        }
        #[derive(Serialize)]
        struct State {
            list: Vec<f64>,
            pair: (bool, f32),
            tuple: Tuple,
            kinds: [Kind; 4],
            map: BTreeMap<String, Option<f64>>,
        }
        let state = |bad: [f64; 8]| State {
            list: vec![0.0, bad[0]],
            pair: (true, bad[1] as f32),
            tuple: Tuple(1, bad[2] as f32),
            kinds: [
                Kind::Whole(bad[3]),
                Kind::Pair(bad[4], bad[5]),
                Kind::Named { x: bad[6] },
                Kind::Unit,
            ],
            map: BTreeMap::from([("a".to_owned(), None), ("b".to_owned(), Some(bad[7]))]),
        };
        assert!(is_finite(&state([f64::MIN_POSITIVE; 8])));
        assert!(every_float(&state([-1.0; 8]), |x| x.abs() <= 1.0));
        for i in 0..8 {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut numbers = [1.0; 8];
                numbers[i] = bad;
                assert!(!is_finite(&state(numbers)), "{i} {bad}");
            }
            let mut numbers = [1.0; 8];
            numbers[i] = 2.0;
            assert!(!every_float(&state(numbers), |x| x.abs() <= 1.0), "{i}");
        }
    }
}
