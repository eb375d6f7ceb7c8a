//! Recorded episodes come out equal.

use std::path::Path;

use gym_core::{Env, EnvExt, Value, builder};

use crate::{has, python};

/// Episodes of gym 0.26, minigrid, highway-env and ale-py, recorded in Python.
#[test]
fn recorded_episodes_come_out_equal() {
    if !has(&["numpy"]) {
        return;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference");
    let mut compared = 0;
    for entry in std::fs::read_dir(folder).expect("the recordings") {
        let path = entry.expect("readable").path();
        let trace: serde_json::Value =
            serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        let text = |key: &str| trace[key].as_str().map(str::to_owned);
        let backend = text("backend").expect("a library");
        let modules: Vec<String> = [Some(backend.clone()), text("module")]
            .into_iter()
            .flatten()
            .collect();
        if !has(&modules.iter().map(String::as_str).collect::<Vec<_>>()) {
            continue;
        }
        let mut env = builder("GymV26Environment-v0")
            .arg("env_id", text("id"))
            .arg("make_kwargs", trace["kwargs"].clone())
            .arg("backend", backend)
            .arg("module", trace["module"].clone())
            .arg("python", python())
            .build()
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        for (i, event) in trace["events"]
            .as_array()
            .expect("events")
            .iter()
            .enumerate()
        {
            let place = format!("{}, event {i}", path.display());
            let observation = match event.get("step") {
                None => env
                    .reset(event["reset"]["seed"].as_u64())
                    .unwrap_or_else(|error| panic!("{place}: {error}")),
                Some(action) => {
                    let action = env.action_space().from_json(action).unwrap();
                    let step = env
                        .step(&action)
                        .unwrap_or_else(|error| panic!("{place}: {error}"));
                    assert_eq!(Some(step.reward), event["reward"].as_f64(), "{place}");
                    assert_eq!(
                        Some(step.terminated),
                        event["terminated"].as_bool(),
                        "{place}"
                    );
                    assert_eq!(
                        Some(step.truncated),
                        event["truncated"].as_bool(),
                        "{place}"
                    );
                    step.observation
                }
            };
            assert!(
                is_recorded(&event["observation"], &observation),
                "{place}: {observation:?}"
            );
            let recorded = event["info"].as_object().expect("info");
            let info = env.info_map();
            for (key, value) in recorded
                .iter()
                .filter(|(key, _)| trace["info_same_twice"] == true || *key != "action")
            {
                let ours = info
                    .get(key)
                    .unwrap_or_else(|| panic!("{place}: info has no {key}"));
                assert!(
                    is_recorded(value, ours),
                    "{place}, info {key}: {ours:?} for {value}"
                );
            }
            assert_eq!(info.len(), recorded.len(), "{place}: {info:?}");
        }
        compared += 1;
    }
    println!("{compared} recorded environments compared");
}

/// Whether `value` equals `recorded`, which contains the numbers or, for a large array, a checksum.
fn is_recorded(recorded: &serde_json::Value, value: &Value) -> bool {
    use serde_json::Value as Json;
    match (recorded, value) {
        (Json::Object(map), Value::Array(array)) => {
            let bytes = array.as_slice::<u8>().expect("only pictures are large");
            map["crc32"].as_u64() == Some(crc32fast::hash(bytes).into())
        }
        (Json::Object(map), Value::Dict(entries)) => {
            map.len() == entries.len()
                && entries
                    .iter()
                    .all(|(key, value)| map.get(key).is_some_and(|json| is_recorded(json, value)))
        }
        (Json::Array(items), Value::Tuple(values)) => {
            items.len() == values.len()
                && items
                    .iter()
                    .zip(values)
                    .all(|(item, value)| is_recorded(item, value))
        }
        (Json::Array(_), Value::Array(array)) => {
            let mut flat = Vec::new();
            flatten(recorded, &mut flat);
            flat.len() == array.len()
                && flat
                    .iter()
                    .zip(array.iter_f64())
                    .all(|(a, b)| a.to_bits() == b.to_bits())
        }
        (Json::Bool(a), Value::Bool(b)) => a == b,
        (Json::Bool(a), Value::Int(b)) => i64::from(*a) == *b,
        (Json::Number(a), Value::Int(b)) => a.as_i64() == Some(*b),
        (Json::Number(a), Value::Float(b)) => a.as_f64().map(f64::to_bits) == Some(b.to_bits()),
        (Json::String(a), Value::Text(b)) => a == b,
        (Json::Null, Value::Null) => true,
        _ => false,
    }
}

fn flatten(json: &serde_json::Value, out: &mut Vec<f64>) {
    match json.as_array() {
        Some(items) => items.iter().for_each(|item| flatten(item, out)),
        None => out.extend(json.as_f64().or(match json.as_str() {
            Some("inf") => Some(f64::INFINITY),
            Some("-inf") => Some(f64::NEG_INFINITY),
            _ => None,
        })),
    }
}
