//! JSON that keeps every float: the state of any type, including floats that JSON lacks. serde_json
//! writes those as `null`; here they are `{"$float": "inf"}`.

mod finite;

use serde::de::value::{BorrowedStrDeserializer, MapAccessDeserializer};
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, Error as _, Expected, MapAccess, SeqAccess,
    Unexpected, Visitor,
};
use serde::ser::{self, SerializeMap, Serializer};
use serde::{Deserialize, Serialize};
use serde_json::{Error, Value as Json};

pub use finite::{every_float, is_finite};

/// The key of a float that JSON lacks.
pub const FLOAT: &str = "$float";

/// The name of a newtype struct whose content is JSON, to be stored unchanged.
const AS_IT_IS: &str = "$json";

/// The text of a float that JSON lacks.
pub fn float_text(x: f64) -> Option<String> {
    (!x.is_finite()).then(|| x.to_string())
}

/// The float with this text.
pub fn parse_float(text: &str) -> Option<f64> {
    text.parse()
        .ok()
        .filter(|x| float_text(*x).is_some_and(|own| own == text))
}

/// Serializes one entry under a key that begins with `$`.
///
/// # Errors
/// The serializer's errors.
pub fn tagged<S: Serializer>(
    serializer: S,
    tag: &str,
    content: &(impl Serialize + ?Sized),
) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(1))?;
    map.serialize_entry(tag, content)?;
    map.end()
}

/// State as JSON.
///
/// # Errors
/// For a map whose keys are not strings.
pub fn write<T: Serialize + ?Sized>(state: &T) -> Result<Json, Error> {
    serde_json::to_value(Exact(state))
}

/// The state that [`write()`] stored.
///
/// # Errors
/// For JSON that `write` did not make from this type.
pub fn read<T: DeserializeOwned>(json: &Json) -> Result<T, Error> {
    T::deserialize(Stored {
        json,
        as_it_is: false,
    })
}

/// A value whose floats are all kept, whoever writes and reads the JSON: for a type's own
/// `Serialize` and `Deserialize`.
#[derive(Debug)]
pub struct Exact<T>(pub T);

impl<T: Serialize> Serialize for Exact<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            self.0.serialize(Writer(serializer))
        } else {
            self.0.serialize(serializer)
        }
    }
}

impl<'de, T: DeserializeOwned> Deserialize<'de> for Exact<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        /// JSON that [`Stored`] hands over unchanged.
        #[derive(Deserialize)]
        #[serde(rename = "$json")]
        struct Plain(Json);

        if !deserializer.is_human_readable() {
            return T::deserialize(deserializer).map(Self);
        }
        let Plain(json) = Plain::deserialize(deserializer)?;
        read(&json).map(Self).map_err(D::Error::custom)
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
        if value.is_finite() {
            self.0.serialize_f32(value)
        } else {
            self.serialize_f64(value.into())
        }
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
///
/// Each method reads only the kinds of JSON that its type can have. The methods call no general
/// method, because the compiler would instantiate that method for each type in each crate.
#[derive(Clone, Copy)]
struct Stored<'de> {
    json: &'de Json,
    /// Whether the JSON is plain: floats have no replacements.
    as_it_is: bool,
}

impl<'de> Stored<'de> {
    /// Returns a reader of `json`, which is a part of this JSON.
    fn part(self, json: &'de Json) -> Self {
        Self { json, ..self }
    }

    /// Returns the float that this JSON stores; `None` if the JSON stores something else.
    fn float(self) -> Result<Option<f64>, Error> {
        let tagged = self
            .json
            .as_object()
            .and_then(|map| Some((map.get(FLOAT)?, map.len())));
        let Some((text, 1)) = tagged.filter(|_| !self.as_it_is) else {
            return Ok(None);
        };
        let x = text.as_str().and_then(parse_float);
        x.map(Some).ok_or_else(|| {
            Error::custom(format!(
                "expected \"inf\", \"-inf\" or \"NaN\" under `{FLOAT}`, not {text}"
            ))
        })
    }

    fn is_not(self, expected: &dyn Expected) -> Error {
        let found = match self.json {
            Json::Null => Unexpected::Unit,
            Json::Bool(b) => Unexpected::Bool(*b),
            Json::Number(number) => match (number.as_u64(), number.as_i64(), number.as_f64()) {
                (Some(n), ..) => Unexpected::Unsigned(n),
                (_, Some(n), _) => Unexpected::Signed(n),
                (.., x) => Unexpected::Float(x.unwrap_or_default()),
            },
            Json::String(text) => Unexpected::Str(text),
            Json::Array(_) => Unexpected::Seq,
            Json::Object(_) => Unexpected::Map,
        };
        Error::invalid_type(found, expected)
    }

    fn scalar<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.json {
            Json::Null => visitor.visit_unit(),
            Json::Bool(b) => visitor.visit_bool(*b),
            Json::Number(number) => match (number.as_u64(), number.as_i64(), number.as_f64()) {
                (Some(n), ..) => visitor.visit_u64(n),
                (_, Some(n), _) => visitor.visit_i64(n),
                (.., Some(x)) => visitor.visit_f64(x),
                _ => Err(self.is_not(&visitor)),
            },
            Json::String(text) => visitor.visit_borrowed_str(text),
            Json::Array(_) => Err(self.is_not(&visitor)),
            Json::Object(_) => match self.float()? {
                Some(x) => visitor.visit_f64(x),
                None => Err(self.is_not(&visitor)),
            },
        }
    }

    fn list<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let Json::Array(list) = self.json else {
            return Err(self.is_not(&visitor));
        };
        let mut items = Items {
            list: self,
            rest: list.iter(),
        };
        let value = visitor.visit_seq(&mut items)?;
        match items.rest.len() {
            0 => Ok(value),
            rest => Err(Error::invalid_length(
                list.len(),
                &&*format!("{} items", list.len() - rest),
            )),
        }
    }

    fn map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let Json::Object(map) = self.json else {
            return Err(self.is_not(&visitor));
        };
        let mut entries = Entries {
            map: self,
            rest: map.iter(),
            value: None,
        };
        let value = visitor.visit_map(&mut entries)?;
        match entries.rest.len() {
            0 => Ok(value),
            rest => Err(Error::invalid_length(
                map.len(),
                &&*format!("{} entries", map.len() - rest),
            )),
        }
    }
}

/// Defines deserializer methods that call one of the methods above.
macro_rules! deserialize {
    ($($by:ident { $($method:ident($($arg:ident: $type:ty),*))* })*) => {
        $($(fn $method<V: Visitor<'de>>(self, $($arg: $type,)* visitor: V) -> Result<V::Value, Error> {
            $(let _ = $arg;)*
            self.$by(visitor)
        })*)*
    };
}

impl<'de> Deserializer<'de> for Stored<'de> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.json {
            Json::Array(_) => self.list(visitor),
            Json::Object(_) if self.float()?.is_none() => self.map(visitor),
            _ => self.scalar(visitor),
        }
    }

    deserialize! {
        scalar {
            deserialize_bool() deserialize_i8() deserialize_i16() deserialize_i32()
            deserialize_i64() deserialize_i128() deserialize_u8() deserialize_u16()
            deserialize_u32() deserialize_u64() deserialize_u128() deserialize_f32()
            deserialize_f64() deserialize_char() deserialize_str() deserialize_string()
            deserialize_unit() deserialize_unit_struct(name: &'static str) deserialize_identifier()
        }
        list {
            deserialize_bytes() deserialize_byte_buf() deserialize_seq()
            deserialize_tuple(len: usize) deserialize_tuple_struct(name: &'static str, len: usize)
        }
        map { deserialize_map() deserialize_struct(name: &'static str, fields: &'static [&'static str]) }
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_unit()
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        if self.json.is_null() {
            visitor.visit_none()
        } else {
            visitor.visit_some(self)
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        // a newtype with this name contains plain JSON, such as an inner snapshot
        let as_it_is = self.as_it_is || name == AS_IT_IS;
        visitor.visit_newtype_struct(Self { as_it_is, ..self })
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.json {
            Json::String(variant) => visitor.visit_enum(BorrowedStrDeserializer::new(variant)),
            Json::Object(map) if map.len() == 1 => {
                let entries = Entries {
                    map: self,
                    rest: map.iter(),
                    value: None,
                };
                visitor.visit_enum(MapAccessDeserializer::new(entries))
            }
            _ => Err(self.is_not(&"the name of a variant, or a map with one")),
        }
    }
}

/// The remaining items of a list.
struct Items<'de> {
    list: Stored<'de>,
    rest: std::slice::Iter<'de, Json>,
}

impl<'de> SeqAccess<'de> for Items<'de> {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Error> {
        self.rest
            .next()
            .map(|item| seed.deserialize(self.list.part(item)))
            .transpose()
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}

/// The remaining entries of a map.
struct Entries<'de> {
    map: Stored<'de>,
    rest: serde_json::map::Iter<'de>,
    /// The value of the key that was read last.
    value: Option<&'de Json>,
}

impl<'de> MapAccess<'de> for Entries<'de> {
    type Error = Error;

    fn next_key_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Error> {
        let Some((key, value)) = self.rest.next() else {
            return Ok(None);
        };
        self.value = Some(value);
        seed.deserialize(BorrowedStrDeserializer::new(key))
            .map(Some)
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, Error> {
        let value = self
            .value
            .take()
            .ok_or_else(|| Error::custom("a value was read before its key"))?;
        seed.deserialize(self.map.part(value))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

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
                Shape::Rectangle {
                    width: f64::INFINITY,
                    height: Some(f64::NEG_INFINITY),
                },
            ],
        }
    }

    #[test]
    fn every_float_comes_back_from_any_json() {
        let text = serde_json::to_string(&Exact(state())).unwrap();
        let json: Json = serde_json::from_str(&text).unwrap();
        assert_eq!(json, write(&state()).unwrap());
        let Exact(read) = serde_json::from_str::<Exact<State>>(&text).unwrap();
        assert_eq!(read, state());
        let nested = write(&[Exact(state())]).unwrap();
        let [Exact(read)] = super::read::<[Exact<State>; 1]>(&nested).unwrap();
        assert_eq!(read, state());
        assert!(serde_json::from_str::<Exact<f64>>("null").is_err());
    }

    /// A number in a format for machines, which has all floats.
    struct Machine(f64);

    impl<'de> Deserializer<'de> for Machine {
        type Error = serde::de::value::Error;

        fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
            visitor.visit_f64(self.0)
        }

        fn is_human_readable(&self) -> bool {
            false
        }

        serde::forward_to_deserialize_any! {
            bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit
            unit_struct newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
        }
    }

    #[test]
    fn formats_for_machines_keep_their_own_floats() {
        for x in [0.1, f64::INFINITY, f64::NEG_INFINITY] {
            let Exact(read) = Exact::<f64>::deserialize(Machine(x)).unwrap();
            assert_eq!(read, x);
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
