//! The built-in models against the figures that MuJoCo 3.12.0 compiles for the models of Gymnasium 1.4.0.

use std::path::PathBuf;

use gym_mujoco::tasks::load;
use serde_json::Value;

/// Compares numbers, and collects what differs.
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
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap_or(f64::NAN), b.as_f64().unwrap_or(f64::NAN));
            // these come out of a factorisation
            let solved = ["invweight0", "meaninertia", "acc0"].iter().any(|name| path.contains(name));
            let limit = if solved { 1e-10 } else { 1e-12 };
            if (a - b).abs() > limit * a.abs().max(1.0) || !b.is_finite() {
                differences.push(format!("{path}: {b} for {a}"));
            }
        }
        _ if expected == got => {}
        _ => differences.push(format!("{path}: {got} for {expected}")),
    }
}

#[test]
fn built_in_models_have_mujocos_figures() {
    let Some(folder) = std::env::var_os("GYM_REFERENCE") else { return };
    let folder = PathBuf::from(folder).join("models_mujoco");
    let mut files = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let mut recorded: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        // versions of the recorder, and what only MuJoCo's viewer uses
        let object = recorded.as_object_mut().unwrap();
        for key in ["gymnasium", "mujoco", "numpy", "vis", "mat_texrepeat"] {
            object.remove(key);
        }
        let model = load(&format!("{name}.xml")).unwrap();
        let mut differences = Vec::new();
        compare("", &recorded, &Value::Object(model.figures()), &mut differences);
        assert!(
            differences.is_empty(),
            "{name}: {} differ: {:#?}",
            differences.len(),
            &differences[..differences.len().min(20)]
        );
        files += 1;
    }
    assert_eq!(files, 13);
}
