//! Compares the environments with recorded episodes of Gymnasium's MuJoCo environments.
//!
//! The recordings of this crate are always compared, and further recordings in the folder
//! `GYM_REFERENCE`, if it is set.

use std::path::{Path, PathBuf};

use gym_core::{Env, registry};
use gym_trace::Trace;
use serde_json::{Value, json};

/// Compares a file. Returns the number of events, or the first difference as an error. `0.0` and
/// `-0.0` differ.
fn compare(path: &Path) -> Result<usize, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let trace: Trace = serde_json::from_str(&text).map_err(|error| error.to_string())?;
    let answers = trace.replay().map_err(|error| error.to_string())?;
    match trace.first_difference(&answers) {
        Some(difference) => Err(difference),
        None => Ok(trace.events.len()),
    }
}

/// Returns the traces in a folder. Their names contain the id of a task.
fn traces(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| name(path).contains("-v"))
        .collect();
    paths.sort();
    paths
}

fn name(path: &Path) -> String {
    path.file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default()
}

fn compare_all(paths: &[PathBuf]) {
    let mut wrong = Vec::new();
    for path in paths {
        match compare(path) {
            Ok(events) => println!("{}: {events} events", name(path)),
            Err(error) => wrong.push(format!(
                "{}: {}",
                name(path),
                &error[..error.len().min(400)]
            )),
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {} differ:\n{}",
        wrong.len(),
        paths.len(),
        wrong.join("\n")
    );
}

#[test]
fn every_id_repeats_the_beginning_of_a_recording() {
    let paths = traces(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recorded"));
    for registration in registry::all() {
        let recorded = format!("{}.seed0.json", registration.id());
        assert!(
            paths.iter().any(|path| name(path) == recorded),
            "{recorded} is missing"
        );
    }
    compare_all(&paths);
}

#[test]
fn all_recorded_episodes() {
    if let Some(folder) = std::env::var_os("GYM_REFERENCE") {
        let paths = traces(&PathBuf::from(folder).join("traces_mujoco"));
        assert!(!paths.is_empty(), "there are no traces");
        compare_all(&paths);
    }
}

#[test]
fn a_trace_that_differs_is_found() {
    let folder = std::env::temp_dir().join(format!("gym-mujoco-traces-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recorded/Hopper-v5.seed0.json");
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let differs = folder.join("Hopper-v5.json");
    for (place, other) in [
        (
            "/events/5/reward",
            json!(file["events"][5]["reward"].as_f64().unwrap().next_up()),
        ),
        ("/events/5/info/x_velocity", json!(null)),
        ("/events/26/terminated", json!(false)),
        ("/events/3/state/qvel/2", json!(0.5)),
    ] {
        let mut file = file.clone();
        *file.pointer_mut(place).unwrap() = other;
        std::fs::write(&differs, file.to_string()).unwrap();
        assert!(compare(&differs).is_err(), "{place}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// The argument `mujoco` has precedence over the version in the head. `replay` then names the
/// version as not compared.
#[test]
fn the_version_of_mujoco_in_the_head_is_the_default() {
    for (id, kwargs, taken, unused) in [
        ("Hopper-v5", json!({}), "3.12", vec![]),
        ("Hopper-v5", json!({"mujoco": "4.0"}), "4.0", vec!["mujoco"]),
    ] {
        let head = json!({"id": id, "kwargs": kwargs, "mujoco": "3.12", "events": []});
        let trace: Trace = serde_json::from_value(head).unwrap();
        let env = trace.make().unwrap();
        assert_eq!(env.inspect().unwrap().arguments()["mujoco"], taken);
        assert_eq!(trace.not_compared(), unused);
    }
}
