//! Recordings of models with one feature each: single steps from given states, and an episode of
//! random controls, by several versions of MuJoCo.
//!
//! `xml` is the text of the model, or `file` names its file, absolute or relative to the folder of
//! the recording. `seed` is the seed of the controls. For each version, `versions`
//! has `steps` (states, each with the state `after` a step) and `episode` (the states after certain
//! numbers of steps). The answer has the same form, for the versions that the engine supports. For
//! a model that the engine refuses, the answer has `error`.

use std::path::Path;

use gym_core::RandomState;
use serde::Deserialize;
use serde_json::{Map, Value, json};

use mujoco_engine::{Data, Error, Model, Result, Revision, step};

/// A state in the form of these recordings.
#[derive(Deserialize)]
struct State {
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    act: Vec<f64>,
    ctrl: Vec<f64>,
    qacc_warmstart: Vec<f64>,
    mocap_pos: Vec<f64>,
    mocap_quat: Vec<f64>,
    /// The time, as a list of one number.
    time: Vec<f64>,
}

impl State {
    fn into_data(self, m: &Model) -> Result<Data> {
        let mut d = Data::new(m);
        (d.qpos, d.qvel, d.act, d.ctrl) = (self.qpos, self.qvel, self.act, self.ctrl);
        d.qacc_warmstart = self.qacc_warmstart;
        d.time = self.time.first().copied().unwrap_or(0.0);
        d.mocap_pos = self.mocap_pos.as_chunks().0.to_vec();
        d.mocap_quat = self.mocap_quat.as_chunks().0.to_vec();
        d.check(m)?;
        Ok(d)
    }
}

/// Whether a recording has this form.
pub(super) fn is_of_features(recording: &Map<String, Value>) -> bool {
    recording.get("kind").and_then(Value::as_str) == Some("features")
}

/// Computes the results of this engine for a recording; `folder` contains the recording.
pub(super) fn answer(recording: &Map<String, Value>, folder: &Path) -> Result<Map<String, Value>> {
    let wrong = |what: &str| Error::Data(format!("the recording has {what}"));
    let text = |key: &str| recording.get(key).and_then(Value::as_str);
    let model = |revision| match (text("xml"), text("file")) {
        (Some(xml), None) => Ok(Model::from_xml_with(xml, revision)),
        (None, Some(file)) => Ok(Model::from_path_with(folder.join(file), revision)),
        (Some(_), Some(_)) => Err(wrong("both `xml` and `file`: give one of them")),
        (None, None) => Err(wrong(
            "no model: give its text as `xml`, or its path as `file`",
        )),
    };
    let versions = recording.get("versions").and_then(Value::as_object);
    let versions = versions.ok_or_else(|| wrong("no versions"))?;
    let seed = recording.get("seed").and_then(Value::as_u64).unwrap_or(0);
    let mut answers = Map::new();
    for (version, recorded) in versions {
        let Ok(revision) = version.parse::<Revision>() else {
            continue;
        };
        let m = match model(revision)? {
            Ok(m) => m,
            Err(error) => {
                let refused = json!({"error": error.to_string()});
                return Ok(refused.as_object().cloned().unwrap_or_default());
            }
        };
        answers.insert(version.clone(), of_version(&m, recorded, seed as u32)?);
    }
    let answer = json!({"versions": answers});
    Ok(answer.as_object().cloned().unwrap_or_default())
}

fn of_version(m: &Model, recorded: &Value, seed: u32) -> Result<Value> {
    let mut steps = Vec::new();
    let cases = recorded["steps"].as_array().into_iter().flatten();
    for (i, case) in cases.enumerate() {
        let state = State::deserialize(case).map_err(|error| {
            Error::Data(format!(
                "the recording has a step {i} without a state: {error}"
            ))
        })?;
        let mut d = state.into_data(m)?;
        step(m, &mut d);
        steps.push(json!({"after": after(&d)}));
    }
    let marks = recorded["episode"].as_object().into_iter().flatten();
    let mut marks: Vec<usize> = marks.filter_map(|(mark, _)| mark.parse().ok()).collect();
    marks.sort_unstable();
    Ok(json!({"steps": steps, "episode": episode(m, &marks, seed)}))
}

/// The results of a step, with scalars as lists of one.
fn after(d: &Data) -> Value {
    json!({
        "qpos": d.qpos, "qvel": d.qvel, "act": d.act, "qacc": d.qacc, "sensordata": d.sensordata,
        "ncon": [d.contact.len()], "nefc": [d.efc.nefc()], "efc_force": d.efc.force,
        "actuator_force": d.actuator_force, "ten_length": d.ten_length, "qfrc_passive": d.qfrc_passive,
        "time": [d.time],
    })
}

/// Runs an episode from the initial configuration with random uniform controls. Returns the states
/// after the numbers of steps in `marks`.
fn episode(m: &Model, marks: &[usize], seed: u32) -> Value {
    let (mut d, mut controls) = (Data::new(m), RandomState::new(seed));
    let (mut states, mut taken) = (Map::new(), 0);
    for &mark in marks.iter().filter(|mark| **mark <= 10_000) {
        while taken < mark {
            for i in 0..m.nu() {
                let [low, high] = m.actuator_ctrlrange[i];
                let control = controls.uniform(-1.0, 1.0);
                d.ctrl[i] = if m.actuator_ctrllimited[i] {
                    low + (control + 1.0) / 2.0 * (high - low)
                } else {
                    control
                };
            }
            step(m, &mut d);
            taken += 1;
        }
        let state =
            json!({"qpos": d.qpos, "qvel": d.qvel, "act": d.act, "sensordata": d.sensordata});
        states.insert(mark.to_string(), state);
    }
    Value::Object(states)
}
