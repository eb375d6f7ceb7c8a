//! What an actuator has from a class that sets another kind of actuator is what it has in libmujoco.
//! `recorded/classes/record.py` recorded the digests.

use mujoco_engine::Model;
use serde_json::Value;

use super::digest::Digest;

const FIELDS: [&str; 11] = [
    "actuator_dyntype",
    "actuator_gaintype",
    "actuator_biastype",
    "actuator_ctrllimited",
    "actuator_dynprm",
    "actuator_gainprm",
    "actuator_biasprm",
    "actuator_ctrlrange",
    "actuator_forcerange",
    "actuator_actrange",
    "actuator_gear",
];

fn add(value: &Value, digest: &mut Digest) {
    match value {
        Value::Array(all) => all.iter().for_each(|value| add(value, digest)),
        Value::Bool(is) => add(&Value::from(f64::from(u8::from(*is))), digest),
        number => digest.numbers(&[number.as_f64().unwrap()]),
    }
}

#[test]
fn actuators_have_from_other_kinds_what_they_have_in_libmujoco() {
    let models = include_str!("../recorded/classes/models.txt");
    let mut unlike = Vec::new();
    for (version, digests) in [
        ("3.12", include_str!("../recorded/classes/3.12.txt")),
        ("3.17", include_str!("../recorded/classes/3.17.txt")),
        ("4.0", include_str!("../recorded/classes/4.0.txt")),
    ] {
        assert_eq!(models.lines().count(), digests.lines().count());
        for (text, expected) in models.lines().zip(digests.lines()) {
            let found = match Model::from_xml_with(text, version.parse().unwrap()) {
                Ok(m) => {
                    let figures = serde_json::to_value(&*m).unwrap();
                    let mut digest = Digest::default();
                    FIELDS
                        .iter()
                        .for_each(|field| add(&figures[field], &mut digest));
                    format!("{:016x}", digest.0)
                }
                Err(error) => error.to_string(),
            };
            if found != expected && (expected != "-" || !found.contains("line 1")) {
                unlike.push(format!("{version}: {found}, not {expected}: {text}"));
            }
        }
    }
    assert!(unlike.is_empty(), "{unlike:#?}");
}
