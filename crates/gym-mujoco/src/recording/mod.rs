//! Recorded steps and forward calls of another engine, compared with this engine's.
//!
//! A recording is a JSON object. `kind` is `"steps"` or `"forward"`. `model` names a built-in
//! model, optionally after a prefix and a dot; or `xml` names an MJCF file beside the recording.
//! Each of `cases` has a state (`qpos`, `qvel`, `qacc_warmstart`, `ctrl`, `time`). The answer to a
//! case is the state after one step, under `after`, or the results of one forward call, under
//! `out`, with MuJoCo's names. `mujoco` is the version of libmujoco that was recorded; the default
//! is the newest. A recording without a `kind` is a table of a compiled model; the answer is this
//! compiler's table.

mod features;

use std::path::Path;
use std::sync::Arc;

use serde::Deserialize;
use serde_json::{Map, Value, json};

use mujoco_engine::model::Solver;
use mujoco_engine::{Data, Error, Model, Result, Revision, forward, physics, step};

/// A state in the form of recordings.
#[derive(Deserialize)]
struct State {
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    qacc_warmstart: Vec<f64>,
    ctrl: Vec<f64>,
    time: f64,
}

impl State {
    fn into_data(self, m: &Model) -> Result<Data> {
        let mut d = Data::new(m);
        (d.qpos, d.qvel, d.qacc_warmstart) = (self.qpos, self.qvel, self.qacc_warmstart);
        (d.ctrl, d.time) = (self.ctrl, self.time);
        d.check(m)?;
        Ok(d)
    }
}

/// Whether this is a recording of the engine or a table of a compiled model. Recordings of
/// environments are neither.
#[must_use]
pub fn is_of_engine(recording: &Map<String, Value>) -> bool {
    recording.contains_key("cases")
        || recording.contains_key("body_mass")
        || features::is_of_features(recording)
}

/// Computes the results of this engine for a recording; `folder` contains the recording.
///
/// # Errors
/// If the recording names no model, or a state does not fit the model.
pub fn answer(recording: &Map<String, Value>, folder: &Path) -> Result<Map<String, Value>> {
    if features::is_of_features(recording) {
        return features::answer(recording, folder);
    }
    let wrong = |what: &str| Error::Data(format!("the recording has {what}"));
    let m = model(recording, folder)?;
    let mut answer = recording.clone();
    let (side, run): (_, fn(&Model, &mut Data) -> Value) =
        match recording.get("kind").and_then(Value::as_str) {
            Some("steps") => ("after", after_step),
            Some("forward") => ("out", after_forward),
            Some(kind) => {
                return Err(wrong(&format!(
                    "the kind {kind:?}: the kinds are \"steps\" and \"forward\""
                )));
            }
            None => {
                let figures = m.figures().into_iter();
                let figures =
                    figures.filter(|(key, _)| key != "model" && recording.contains_key(key));
                answer.extend(figures);
                return Ok(answer);
            }
        };
    let cases = answer.get_mut("cases").and_then(Value::as_array_mut);
    let cases = cases.ok_or_else(|| wrong("no list of cases"))?;
    for (i, case) in cases.iter_mut().enumerate() {
        let state = State::deserialize(&*case)
            .map_err(|error| wrong(&format!("a case {i} that is not a state: {error}")))?;
        let mut data = state.into_data(&m)?;
        // MuJoCo stores twenty counts; a recording has one for each island, or one if there is no
        // island
        let counts = case[side]["solver_niter"].as_array().map_or(0, Vec::len);
        case[side] = run(&m, &mut data);
        if let Some(own) = case[side]["solver_niter"].as_array_mut() {
            own.resize(own.len().max(counts.min(20)), 0.into());
        }
    }
    Ok(answer)
}

fn model(recording: &Map<String, Value>, folder: &Path) -> Result<Arc<Model>> {
    let text = |key: &str| recording.get(key).and_then(Value::as_str);
    let revision = match text("mujoco").map(str::parse) {
        Some(version) => version.map_err(Error::Data)?,
        None => Revision::default(),
    };
    match (text("xml"), text("model")) {
        (Some(xml), _) => Model::from_path_with(folder.join(xml), revision).map(Arc::new),
        (None, Some(name)) => {
            let name = name.rsplit('.').next().unwrap_or(name);
            crate::load(&format!("{name}.xml"), revision)
                .map_err(|error| Error::Data(format!("the recording's model: {error}")))
        }
        (None, None) => Err(Error::Data(
            "the recording has neither `model` nor `xml`".into(),
        )),
    }
}

/// The results of a step.
fn after_step(m: &Model, d: &mut Data) -> Value {
    step(m, d);
    physics::rne_post_constraint(m, d);
    json!({
        "qpos": d.qpos, "qvel": d.qvel, "qacc": d.qacc, "qacc_warmstart": d.qacc_warmstart,
        "time": d.time, "ncon": d.contact.len(), "nefc": d.efc.nefc(), "nisland": d.efc.nisland,
        "solver_niter": d.solver_niter, "qfrc_constraint": d.qfrc_constraint,
        "cfrc_ext": d.cfrc_ext,
    })
}

/// The results of a forward call.
fn after_forward(m: &Model, d: &mut Data) -> Value {
    forward(m, d);
    physics::rne_post_constraint(m, d);
    let positions = json!({
        "xpos": d.xpos, "xquat": d.xquat, "xmat": d.xmat, "xipos": d.xipos, "ximat": d.ximat,
        "xanchor": d.xanchor, "xaxis": d.xaxis, "geom_xpos": d.geom_xpos, "geom_xmat": d.geom_xmat,
        "site_xpos": d.site_xpos, "subtree_com": d.subtree_com, "cinert": d.cinert, "cdof": d.cdof,
        "qLDiagInv": d.qld_diag_inv, "ten_length": d.ten_length,
        "actuator_length": along_joints(m, &d.qpos, &m.jnt_qposadr),
        "qM": rows(&physics::full_m(m, d), m.nv()), "ncon": d.contact.len(), "nefc": d.efc.nefc(),
        "nisland": d.efc.nisland, "contact": d.contact.iter().map(contact).collect::<Vec<_>>(),
    });
    let dynamics = json!({
        "cvel": d.cvel, "cdof_dot": d.cdof_dot, "ten_velocity": d.ten_velocity,
        "actuator_velocity": along_joints(m, &d.qvel, &m.jnt_dofadr),
        "actuator_force": d.actuator_force, "qfrc_bias": d.qfrc_bias,
        "qfrc_passive": d.qfrc_passive, "qfrc_actuator": d.qfrc_actuator,
        "qfrc_smooth": d.qfrc_smooth, "qacc_smooth": d.qacc_smooth, "qacc": d.qacc,
        "qfrc_constraint": d.qfrc_constraint, "cfrc_ext": d.cfrc_ext,
        "solver_niter": d.solver_niter,
    });
    let mut all = Map::new();
    for part in [positions, dynamics, constraints(m, d)] {
        if let Value::Object(part) = part {
            all.extend(part);
        }
    }
    Value::Object(all)
}

fn constraints(m: &Model, d: &Data) -> Value {
    let efc = &d.efc;
    let jacobian = rows(&efc.full_jacobian(m.nv()), m.nv());
    // libmujoco computes `efc_state` before it splits the islands, at the accelerations without
    // constraints
    let active: Vec<u8> = match m.opt.solver {
        Solver::PGS => efc
            .force
            .iter()
            .map(|force| u8::from(*force > 0.0))
            .collect(),
        _ => efc.b.iter().map(|b| u8::from(*b < 0.0)).collect(),
    };
    json!({
        "efc_pos": efc.pos, "efc_margin": efc.margin, "efc_diagA": efc.diag_approx(),
        "efc_R": efc.r, "efc_D": efc.d, "efc_KBIP": efc.kbip, "efc_vel": efc.vel,
        "efc_aref": efc.aref, "efc_b": efc.b, "efc_force": efc.force, "efc_state": active,
        "efc_J": jacobian, "efc_island": efc.island,
    })
}

fn contact(c: &mujoco_engine::Contact) -> Value {
    json!({
        "geom": c.geom, "dim": c.dim, "dist": c.dist, "pos": c.pos, "frame": c.frame,
        "includemargin": c.includemargin, "friction": c.friction, "solref": c.solref,
        "solimp": c.solimp, "mu": c.mu, "efc_address": c.efc_address,
    })
}

/// A matrix of `width` columns as a list of rows.
fn rows(matrix: &[f64], width: usize) -> Vec<Vec<f64>> {
    matrix.chunks(width.max(1)).map(<[f64]>::to_vec).collect()
}

/// The positions or velocities of the actuators' joints, times their gear.
fn along_joints(m: &Model, numbers: &[f64], addresses: &[usize]) -> Vec<f64> {
    let ids = m.actuator_trnid.iter();
    let joints = ids.map(|id| usize::try_from(id[0]).unwrap_or(0));
    let moved = joints.zip(&m.actuator_gear);
    moved
        .map(|(joint, gear)| gear[0] * numbers[addresses[joint]])
        .collect()
}
