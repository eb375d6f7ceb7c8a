//! What cannot be read from a stored state, and how that is told.

use std::collections::BTreeMap;
use std::fmt::Debug;

use gym_numerics::exact::read;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Error, Value as Json, json};

#[derive(Debug, Deserialize)]
#[expect(dead_code, reason = "shown by Debug")]
enum Shape {
    Point,
    Circle(f64),
    Ellipse(f64, f32),
    Rectangle { width: f64, height: Option<f64> },
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "shown by Debug")]
struct State {
    numbers: Vec<f64>,
    pair: (i64, f64),
    shapes: BTreeMap<String, Shape>,
}

/// What cannot be read is told as serde_json tells it, except how many items there should be, and what
/// an enum is.
#[test]
fn errors_are_serde_jsons() {
    fn compare<T: DeserializeOwned + Debug>(json: &Json) {
        let told = |read: Result<T, Error>| match read {
            Ok(value) => format!("{value:?}"),
            Err(error) => error.to_string(),
        };
        let (ours, theirs) = (told(read(json)), told(serde_json::from_value(json.clone())));
        let theirs = theirs
            .replace("string or map", "the name of a variant, or a map with one")
            .replace(
                "invalid value: map, expected map with a single key",
                "invalid type: map, expected the name of a variant, or a map with one",
            );
        let cut = |told: String| match told.find("invalid length") {
            Some(at) => told[..at + 14].to_owned(),
            None => told,
        };
        assert_eq!(
            cut(ours),
            cut(theirs),
            "{} {json}",
            std::any::type_name::<T>()
        );
    }
    for json in [
        json!(null),
        json!(true),
        json!(0),
        json!(7),
        json!(-7),
        json!(300),
        json!(u64::MAX),
        json!(i64::MIN),
        json!(1.5),
        json!(-0.0),
        json!(""),
        json!("a"),
        json!("Point"),
        json!([]),
        json!([1]),
        json!([1, -2]),
        json!([1, 2, 3]),
        json!(["a", null]),
        json!({}),
        json!({"a": 1.0}),
        json!({"Point": null}),
        json!({"Circle": 1}),
        json!({"Circle": "a"}),
        json!({"Ellipse": [1, 2]}),
        json!({"Ellipse": [1]}),
        json!({"Rectangle": {"width": 1}}),
        json!({"Rectangle": {"height": 1}}),
        json!({"Square": 1}),
        json!({"Circle": 1, "Point": null}),
        json!({"numbers": [1, "a"], "pair": [1, 2], "shapes": {}}),
        json!({"numbers": [1, 2], "pair": [1.5, 2], "shapes": {}}),
        json!({"numbers": [1, 2], "pair": [1, 2], "shapes": {"a": "Point", "b": "Circle"}}),
        json!({"numbers": [], "pair": [-1, -2], "shapes": {"a": {"Circle": 1}}}),
        json!({"numbers": [], "pair": [-1, -2]}),
        json!({"numbers": [], "pair": [-1, -2], "shapes": {}, "more": 1}),
    ] {
        compare::<()>(&json);
        compare::<bool>(&json);
        compare::<u8>(&json);
        compare::<i8>(&json);
        compare::<u64>(&json);
        compare::<i64>(&json);
        compare::<f32>(&json);
        compare::<f64>(&json);
        compare::<char>(&json);
        compare::<String>(&json);
        compare::<Option<i64>>(&json);
        compare::<Vec<i64>>(&json);
        compare::<[u8; 2]>(&json);
        compare::<(i64, f64)>(&json);
        compare::<BTreeMap<String, f64>>(&json);
        compare::<Shape>(&json);
        // (serde_json also reads a struct from a list)
        if !json.is_array() {
            compare::<State>(&json);
        }
        compare::<Json>(&json);
    }
}
