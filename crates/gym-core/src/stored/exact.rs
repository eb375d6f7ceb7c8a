//! The state of any type, including floats that JSON lacks. serde_json writes those as `null`; here they are written in
//! the [stored form](super).

use serde::Serialize;
use serde::de::value::{MapAccessDeserializer, MapDeserializer, SeqDeserializer};
use serde::de::{DeserializeOwned, Deserializer, Error as _, IntoDeserializer, Unexpected, Visitor};
use serde::ser::{self, Serializer};
use serde_json::{Error, Value as Json};

use super::plain::{float_text, parse_float};
use super::{FLOAT, tagged};

/// State as JSON.
///
/// # Errors
/// For a map whose keys are not strings.
pub(crate) fn write<T: Serialize + ?Sized>(state: &T) -> Result<Json, Error> {
    serde_json::to_value(Exact(state))
}

/// The state that [`write`] stored.
///
/// # Errors
/// For JSON of something else.
pub(crate) fn read<T: DeserializeOwned>(json: &Json) -> Result<T, Error> {
    T::deserialize(Stored(json))
}

/// A value whose non-finite floats are kept.
struct Exact<'a, T: ?Sized>(&'a T);

impl<T: Serialize + ?Sized> Serialize for Exact<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(Writer(serializer))
    }
}

/// A serializer that forwards everything except the floats that JSON lacks.
struct Writer<S>(S);

/// Methods that forward their arguments.
macro_rules! hand_on {
    (values { $($value:ident($($arg:ident: $type:ty),*);)* } around { $($around:ident($($name:ident: $of:ty),*);)* }
     parts { $($part:ident($($about:ident: $kind:ty),*) -> $whole:ident;)* }) => {
        $(fn $value(self, $($arg: $type),*) -> Result<S::Ok, S::Error> {
            self.0.$value($($arg),*)
        })*
        $(fn $around<T: Serialize + ?Sized>(self, $($name: $of,)* value: &T) -> Result<S::Ok, S::Error> {
            self.0.$around($($name,)* &Exact(value))
        })*
        $(
            type $whole = Writer<S::$whole>;

            fn $part(self, $($about: $kind),*) -> Result<Self::$whole, S::Error> {
                self.0.$part($($about),*).map(Writer)
            }
        )*
    };
}

impl<S: Serializer> Serializer for Writer<S> {
    type Ok = S::Ok;
    type Error = S::Error;

    fn serialize_f32(self, value: f32) -> Result<S::Ok, S::Error> {
        if value.is_finite() { self.0.serialize_f32(value) } else { self.serialize_f64(value.into()) }
    }

    fn serialize_f64(self, value: f64) -> Result<S::Ok, S::Error> {
        match float_text(value) {
            Some(text) => tagged(self.0, FLOAT, &text),
            None => self.0.serialize_f64(value),
        }
    }

    hand_on! {
        values {
            serialize_bool(value: bool);
            serialize_i8(value: i8);
            serialize_i16(value: i16);
            serialize_i32(value: i32);
            serialize_i64(value: i64);
            serialize_i128(value: i128);
            serialize_u8(value: u8);
            serialize_u16(value: u16);
            serialize_u32(value: u32);
            serialize_u64(value: u64);
            serialize_u128(value: u128);
            serialize_char(value: char);
            serialize_str(value: &str);
            serialize_bytes(value: &[u8]);
            serialize_unit();
            serialize_none();
            serialize_unit_struct(name: &'static str);
            serialize_unit_variant(name: &'static str, i: u32, variant: &'static str);
        }
        around {
            serialize_some();
            serialize_newtype_struct(name: &'static str);
            serialize_newtype_variant(name: &'static str, i: u32, variant: &'static str);
        }
        parts {
            serialize_seq(len: Option<usize>) -> SerializeSeq;
            serialize_tuple(len: usize) -> SerializeTuple;
            serialize_tuple_struct(name: &'static str, len: usize) -> SerializeTupleStruct;
            serialize_tuple_variant(name: &'static str, i: u32, variant: &'static str, len: usize) -> SerializeTupleVariant;
            serialize_map(len: Option<usize>) -> SerializeMap;
            serialize_struct(name: &'static str, len: usize) -> SerializeStruct;
            serialize_struct_variant(name: &'static str, i: u32, variant: &'static str, len: usize) -> SerializeStructVariant;
        }
    }
}

macro_rules! hand_on_items {
    ($($part:ident { $($method:ident($($key:ident)?))* })*) => {$(
        impl<S: ser::$part> ser::$part for Writer<S> {
            type Ok = S::Ok;
            type Error = S::Error;

            $(fn $method<T: Serialize + ?Sized>(&mut self, $($key: &'static str,)? value: &T) -> Result<(), S::Error> {
                self.0.$method($($key,)? &Exact(value))
            })*

            fn end(self) -> Result<S::Ok, S::Error> {
                self.0.end()
            }
        }
    )*};
}

hand_on_items! {
    SerializeSeq { serialize_element() }
    SerializeTuple { serialize_element() }
    SerializeTupleStruct { serialize_field() }
    SerializeTupleVariant { serialize_field() }
    SerializeStruct { serialize_field(key) }
    SerializeStructVariant { serialize_field(key) }
    // a float as a key is refused
    SerializeMap { serialize_key() serialize_value() }
}

/// JSON that is read with all its floats.
#[derive(Clone, Copy)]
struct Stored<'a>(&'a Json);

impl Stored<'_> {
    /// The number that JSON lacks, if this is one.
    fn float(self) -> Result<Option<f64>, Error> {
        let Some((text, 1)) = self.0.as_object().and_then(|map| Some((map.get(FLOAT)?, map.len()))) else {
            return Ok(None);
        };
        let x = text.as_str().and_then(parse_float);
        x.map(Some).ok_or_else(|| {
            Error::custom(format!("expected \"inf\", \"-inf\" or \"NaN\" under `{FLOAT}`, not {text}"))
        })
    }
}

impl<'de> Deserializer<'de> for Stored<'de> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        if let Some(x) = self.float()? {
            return visitor.visit_f64(x);
        }
        match self.0 {
            Json::Array(items) => {
                let mut items = SeqDeserializer::new(items.iter().map(Stored));
                let value = visitor.visit_seq(&mut items)?;
                items.end()?;
                Ok(value)
            }
            Json::Object(map) => {
                let mut entries =
                    MapDeserializer::new(map.iter().map(|(key, value)| (key.as_str(), Stored(value))));
                let value = visitor.visit_map(&mut entries)?;
                entries.end()?;
                Ok(value)
            }
            plain => plain.deserialize_any(visitor),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        if self.0.is_null() { visitor.visit_none() } else { visitor.visit_some(self) }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        match name {
            // a value, or an inner snapshot: already in stored form
            super::AS_IT_IS => visitor.visit_newtype_struct(self.0),
            _ => visitor.visit_newtype_struct(self),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.0 {
            Json::Object(map) if map.len() == 1 => {
                let entries = map.iter().map(|(key, value)| (key.as_str(), Stored(value)));
                visitor.visit_enum(MapAccessDeserializer::new(MapDeserializer::new(entries)))
            }
            Json::Object(_) => {
                Err(Error::invalid_value(Unexpected::Map, &"a map with the one variant of an enum"))
            }
            plain => plain.deserialize_enum(name, variants, visitor),
        }
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq
        tuple tuple_struct map struct identifier ignored_any
    }
}

impl<'de> IntoDeserializer<'de, Error> for Stored<'de> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde::Deserialize;
    use serde_json::json;

    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    enum Shape {
        Point,
        Circle(f64),
        Ellipse(f64, f32),
        Rectangle { width: f64, height: Option<f64> },
    }

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct State {
        numbers: Vec<f64>,
        single: f32,
        named: BTreeMap<String, f64>,
        maybe: [Option<f64>; 2],
        pair: (i64, f64),
        shapes: Vec<Shape>,
    }

    fn state() -> State {
        State {
            numbers: vec![f64::INFINITY, f64::NEG_INFINITY, 0.1, -0.0, f64::MAX],
            single: f32::NEG_INFINITY,
            named: BTreeMap::from([("a".to_owned(), f64::INFINITY), (FLOAT.to_owned(), 1.0)]),
            maybe: [None, Some(f64::INFINITY)],
            pair: (i64::MIN, f64::INFINITY),
            shapes: vec![
                Shape::Point,
                Shape::Circle(f64::INFINITY),
                Shape::Ellipse(f64::NEG_INFINITY, f32::INFINITY),
                Shape::Rectangle { width: f64::INFINITY, height: Some(f64::NEG_INFINITY) },
            ],
        }
    }

    #[test]
    fn every_float_comes_back() {
        let json = write(&state()).unwrap();
        let text = serde_json::to_string(&json).unwrap();
        let stored: Json = serde_json::from_str(&text).unwrap();
        assert_eq!(read::<State>(&stored).unwrap(), state());
        assert!(read::<f64>(&write(&f64::NAN).unwrap()).unwrap().is_nan());
    }

    #[test]
    fn what_is_not_there_is_no_number() {
        let mut json = write(&state()).unwrap();
        json["numbers"][0] = Json::Null;
        assert!(read::<State>(&json).is_err());
        json["numbers"][0] = json!({ FLOAT: "many" });
        assert_eq!(
            read::<State>(&json).unwrap_err().to_string(),
            "expected \"inf\", \"-inf\" or \"NaN\" under `$float`, not \"many\""
        );
        json["numbers"][0] = json!(0.0);
        assert!(read::<State>(&json).is_ok());
        json["pair"] = json!([1, 2.0, 3.0]);
        assert!(read::<State>(&json).is_err(), "one number too many");
    }
}
