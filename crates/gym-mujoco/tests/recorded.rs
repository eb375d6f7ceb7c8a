//! Steps and forward calls of libmujoco 3.12.0, repeated.
//!
//! The recordings of this crate are always compared; more, where `GYM_REFERENCE` names a folder that has them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gym_mujoco::recording;
use serde_json::{Map, Value};

/// All recordings of a kind.
fn recordings(kind: &str) -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recorded");
    let more = std::env::var_os("GYM_REFERENCE").map(|folder| PathBuf::from(folder).join("traces_mujoco"));
    let folders = std::iter::once(own).chain(more.filter(|folder| folder.is_dir()));
    let entries = folders.flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let is_kind = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy();
        name.starts_with(&format!("{kind}.")) && name.ends_with(".json")
    };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).filter(is_kind).collect();
    paths.sort();
    paths
}

/// The largest difference, relative above 1; infinite where lengths, keys or whole numbers differ.
fn off(expected: &Value, got: &Value) -> f64 {
    match (expected, got) {
        (Value::Number(a), Value::Number(b)) => match (a.as_i64(), a.as_f64(), b.as_f64()) {
            (Some(_), Some(a), Some(b)) if a != b && got.is_u64() => f64::INFINITY,
            (_, Some(a), Some(b)) => (a - b).abs() / a.abs().max(1.0),
            _ => f64::INFINITY,
        },
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            a.iter().zip(b).map(|(a, b)| off(a, b)).fold(0.0, f64::max)
        }
        (Value::Object(a), Value::Object(b)) if a.len() == b.len() => {
            a.iter().map(|(key, a)| b.get(key).map_or(f64::INFINITY, |b| off(a, b))).fold(0.0, f64::max)
        }
        _ => f64::INFINITY,
    }
}

/// Compares all cases of a recording: tells the worst, and fails with all that is off.
fn compare(path: &Path, side: &str) -> Result<(), String> {
    let name = path.file_name().unwrap().to_string_lossy();
    let fail = |error: &dyn std::fmt::Display| format!("{name}: {error}");
    let text = std::fs::read_to_string(path).map_err(|error| fail(&error))?;
    let file: Map<String, Value> = serde_json::from_str(&text).map_err(|error| fail(&error))?;
    let answer = recording::answer(&file, path.parent().unwrap()).map_err(|error| fail(&error))?;
    let (mut worst, mut bad, mut iterations) = (BTreeMap::<&str, f64>::new(), Vec::new(), 0);
    let cases = |file: &Map<String, Value>| file["cases"].as_array().unwrap().clone();
    let (asked, answered) = (cases(&file), cases(&answer));
    assert_eq!(asked.len(), answered.len());
    for (i, (case, got)) in asked.iter().zip(&answered).enumerate() {
        if case["deep"] == true {
            continue;
        }
        let limit = case["tolerance"].as_f64().unwrap_or(1e-9);
        for (key, expected) in case[side].as_object().unwrap() {
            let Some(got) = got[side].get(key) else { continue };
            let here = off(expected, got);
            if key == "solver_niter" {
                iterations += usize::from(here > 0.0);
            } else {
                let entry = worst.entry(key).or_default();
                *entry = entry.max(here);
                if here > limit {
                    bad.push(format!("case {i}, {key} {here:.1e}"));
                }
            }
        }
    }
    let told: Vec<String> =
        worst.iter().filter(|(_, w)| **w > 0.0).map(|(k, w)| format!("{k} {w:.0e}")).collect();
    println!("{name}: {}; iterations differ in {iterations} of {} cases", told.join(" "), asked.len());
    if bad.is_empty() {
        Ok(())
    } else {
        Err(format!("{name}: {} off: {}", bad.len(), bad[..bad.len().min(9)].join("; ")))
    }
}

fn all(kind: &str, side: &str) {
    let paths = recordings(kind);
    if std::env::var_os("GYM_REFERENCE").is_none() {
        let expected = if kind == "steps" { 31 } else { 13 };
        assert_eq!(paths.len(), expected, "recordings of {kind}");
    }
    let failed: Vec<String> = paths.iter().filter_map(|path| compare(path, side).err()).collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn forward_calls() {
    all("forward", "out");
}

#[test]
fn steps() {
    all("steps", "after");
}
