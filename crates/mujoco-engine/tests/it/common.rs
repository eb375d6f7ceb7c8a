//! Functions that compare recordings.

use gym_numerics::RandomState;
use mujoco_engine::{Data, Model, step};
use serde_json::Value;

/// The digest of the states and sensors of some steps of a model, or why it is refused. `start` sets the state before the
/// first step, and `drive` the controls of each, both at random.
pub(crate) fn digest(
    (text, version): (&str, &str),
    steps: usize,
    start: impl FnOnce(&mut Data, &mut RandomState),
    drive: impl Fn(&Model, &mut Data, &mut RandomState),
) -> String {
    let m = match Model::from_xml_with(text, version.parse().unwrap()) {
        Ok(m) => m,
        Err(error) => return error.to_string(),
    };
    let (mut d, mut random) = (Data::new(&m), RandomState::new(0));
    let mut digest: u64 = 0xcbf2_9ce4_8422_2325;
    start(&mut d, &mut random);
    for _ in 0..steps {
        drive(&m, &mut d, &mut random);
        step(&m, &mut d);
        let numbers = d.qpos.iter().chain(&d.qvel).chain(&d.act);
        for number in numbers.chain(&d.sensordata) {
            digest = (digest ^ number.to_bits()).wrapping_mul(0x100_0000_01b3);
        }
    }
    format!("{digest:016x}")
}

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
