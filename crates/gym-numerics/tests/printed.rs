//! Arrays of every kind of number, as numpy 2.5.5 prints them.

use gym_numerics::text::{Numbers, array};
use serde_json::Value as Json;

/// The number, also if it is infinite or none.
fn number(json: &Json) -> f64 {
    let special = json.as_str().map(|text| text.parse().expect("a float"));
    special.unwrap_or_else(|| json.as_f64().expect("a number"))
}

#[test]
fn arrays_are_printed_as_numpy_prints_them() {
    let text = include_str!("printed.json");
    let all: Vec<(String, Vec<usize>, Vec<Json>, String)> = serde_json::from_str(text).unwrap();
    assert!(all.len() > 150);
    let mut wrong = Vec::new();
    for (dtype, shape, numbers, expected) in all {
        let floats = || numbers.iter().map(number);
        let integers = |i: usize| i128::from(numbers[i].as_i64().expect("an integer"));
        let printed = match dtype.as_str() {
            "float32" => array(
                Numbers::F32(&Vec::from_iter(floats().map(|x| x as f32))),
                &shape,
            ),
            "float64" => array(Numbers::F64(&Vec::from_iter(floats())), &shape),
            _ => array(Numbers::Whole(&integers), &shape),
        };
        if printed != expected {
            wrong.push(format!("{dtype}:\n{printed}\nshould be\n{expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
