//! Compares steps and forward calls with recordings of libmujoco 3.12.0 and 4.0.0, to the last bit.
//!
//! The recordings of this crate are always compared, and further recordings in the folder
//! `GYM_REFERENCE`, if it is set.

use std::path::{Path, PathBuf};

use gym_mujoco::recording;
use serde_json::{Map, Value, json};

use crate::common::same;

/// Returns all recordings of a kind.
fn recordings(kind: &str) -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recorded");
    let more =
        std::env::var_os("GYM_REFERENCE").map(|folder| PathBuf::from(folder).join("mujoco_exact"));
    let folders = [own.join("4.0"), own].into_iter();
    let folders = folders.chain(more.filter(|folder| folder.is_dir()));
    let entries = folders.flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let is_kind = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy();
        name.starts_with(&format!("{kind}.")) || name.ends_with(&format!(".{kind}.json"))
    };
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(is_kind)
        .collect();
    paths.sort();
    paths
}

/// Recordings that are compared only up to rounding. From 60 degrees of freedom on, libmujoco sums
/// in the order of its sparse matrices; and in one case with springs of free joints, libmujoco's
/// arc tangent is not correctly rounded.
const TO_ROUNDING: [&str; 2] = ["steps.mixed01.json", "steps.mixed11.json"];

/// Returns the largest difference, relative for numbers above 1; infinity if lengths, keys or
/// integers differ.
fn off(expected: &Value, got: &Value) -> f64 {
    match (expected, got) {
        (Value::Number(a), Value::Number(b)) if a.is_f64() || b.is_f64() => {
            let (a, b) = (
                a.as_f64().unwrap_or(f64::NAN),
                b.as_f64().unwrap_or(f64::NAN),
            );
            (a - b).abs() / a.abs().max(1.0)
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            a.iter().zip(b).map(|(a, b)| off(a, b)).fold(0.0, f64::max)
        }
        _ if same(expected, got) => 0.0,
        _ => f64::INFINITY,
    }
}

/// Compares all cases of a recording. The error lists all differences.
fn compare(path: &Path, side: &str) -> Result<(), String> {
    let name = path.file_name().unwrap().to_string_lossy();
    let fail = |error: &dyn std::fmt::Display| format!("{name}: {error}");
    let text = std::fs::read_to_string(path).map_err(|error| fail(&error))?;
    let file: Map<String, Value> = serde_json::from_str(&text).map_err(|error| fail(&error))?;
    let answer = recording::answer(&file, path.parent().unwrap()).map_err(|error| fail(&error))?;
    let cases = |file: &Map<String, Value>| file["cases"].as_array().unwrap().clone();
    let (asked, answered) = (cases(&file), cases(&answer));
    assert_eq!(asked.len(), answered.len());
    let to_rounding = TO_ROUNDING.contains(&&*name);
    let (mut bad, mut compared) = (Vec::new(), 0);
    for (i, (case, got)) in asked.iter().zip(&answered).enumerate() {
        for (key, expected) in case[side].as_object().unwrap() {
            let Some(got) = got[side].get(key) else {
                continue;
            };
            compared += 1;
            if if to_rounding {
                off(expected, got) > 1e-11
            } else {
                !same(expected, got)
            } {
                bad.push(format!("case {i}, {key} {:.1e}", off(expected, got)));
            }
        }
    }
    assert!(
        compared >= 11 * asked.len(),
        "{name}: {compared} numbers or lists of numbers compared"
    );
    if bad.is_empty() {
        Ok(())
    } else {
        Err(format!(
            "{name}: {} off: {}",
            bad.len(),
            bad[..bad.len().min(9)].join("; ")
        ))
    }
}

fn all(kind: &str, side: &str) {
    let paths = recordings(kind);
    if std::env::var_os("GYM_REFERENCE").is_none() {
        let expected = if kind == "steps" { 64 } else { 21 };
        assert_eq!(paths.len(), expected, "recordings of {kind}");
    }
    let failed: Vec<String> = paths
        .iter()
        .filter_map(|path| compare(path, side).err())
        .collect();
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

/// Without an island, some recordings have no iteration count, others have the first of MuJoCo's
/// counts.
#[test]
fn as_many_counts_of_the_solver_as_recorded() {
    for recorded in [json!([]), json!([0])] {
        let aloft = json!({
            "qpos": [0.0, 3.0, 0.0, -0.1, -0.1, 0.0], "qvel": vec![0.0; 6], "qacc_warmstart": vec![0.0; 6],
            "ctrl": vec![0.0; 3], "time": 0.0, "after": {"solver_niter": recorded},
        });
        let file = json!({"model": "hopper", "kind": "steps", "cases": [aloft]});
        let answer = recording::answer(file.as_object().unwrap(), Path::new("")).unwrap();
        let after = &answer["cases"][0]["after"];
        assert_eq!(
            (&after["nisland"], &after["solver_niter"]),
            (&json!(0), &recorded)
        );
    }
}
