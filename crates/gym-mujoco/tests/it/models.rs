//! Compares the built-in models with Gymnasium 1.4.0's models, as MuJoCo 3.12.0 and 4.0.0 compile
//! them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use gym_mujoco::load;
use mujoco_engine::Model;
use serde_json::Value;

use crate::common::same;

/// Collects the differences between `expected` and `got`. Numbers are compared to the last bit.
fn compare(path: &str, expected: &Value, got: &Value, differences: &mut Vec<String>) {
    match (expected, got) {
        (Value::Object(a), _) => {
            for (key, a) in a {
                compare(&format!("{path}.{key}"), a, &got[key], differences);
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                compare(&format!("{path}[{i}]"), a, b, differences);
            }
        }
        _ if same(expected, got) => {}
        _ => differences.push(format!("{path}: {got} for {expected}")),
    }
}

/// Returns the folders of compiled models: in this crate, and in the folder `GYM_REFERENCE`.
fn folders() -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recorded");
    let more =
        std::env::var_os("GYM_REFERENCE").map(|folder| PathBuf::from(folder).join("models_mujoco"));
    [own.join("4.0"), own]
        .into_iter()
        .chain(more.filter(|folder| folder.is_dir()))
        .collect()
}

#[test]
fn models_have_mujocos_figures() {
    let (mut files, mut wrong) = (0, Vec::new());
    for folder in folders() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let mut recorded: Value = match path.extension() {
                Some(json) if json == "json" => {
                    serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap()
                }
                _ => continue,
            };
            if recorded.get("body_mass").is_none() {
                continue;
            }
            let revision = recorded["mujoco"].as_str().unwrap().parse().unwrap();
            let model = match recorded["xml"].as_str() {
                Some(xml) => Arc::new(Model::from_path_with(folder.join(xml), revision).unwrap()),
                None => load(
                    &format!("{}.xml", recorded["model"].as_str().unwrap()),
                    revision,
                )
                .unwrap(),
            };
            // remove names and versions of the recorder, and fields that only MuJoCo's viewer uses
            let object = recorded.as_object_mut().unwrap();
            for key in [
                "model",
                "xml",
                "gymnasium",
                "mujoco",
                "numpy",
                "vis",
                "mat_texrepeat",
            ] {
                object.remove(key);
            }
            let mut differences = Vec::new();
            compare(
                "",
                &recorded,
                &Value::Object(model.figures()),
                &mut differences,
            );
            if !differences.is_empty() {
                differences.truncate(12);
                wrong.push(format!("{}: {differences:#?}", path.display()));
            }
            files += 1;
        }
    }
    if std::env::var_os("GYM_REFERENCE").is_none() {
        assert_eq!(files, 42);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
