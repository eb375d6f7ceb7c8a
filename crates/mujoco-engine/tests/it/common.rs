//! Functions that compare recordings.

use serde_json::Value;

/// Whether two values are equal. Numbers are compared to the last bit, so `0.0` is not `-0.0`; `1`
/// equals `1.0`.
pub(crate) fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            a.as_f64().map(f64::to_bits) == b.as_f64().map(f64::to_bits)
        }
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
        }
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len()
                && a.iter()
                    .all(|(key, a)| b.get(key).is_some_and(|b| same(a, b)))
        }
        _ => a == b,
    }
}

#[test]
fn zeros_have_a_sign() {
    let read = |text: &str| serde_json::from_str::<Value>(text).unwrap();
    assert!(same(&read("[0, 1]"), &read("[0.0, 1.0]")));
    assert!(!same(&read("[0.0]"), &read("[-0.0]")));
}
