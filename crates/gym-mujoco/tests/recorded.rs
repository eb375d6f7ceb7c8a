//! Steps and forward calls of libmujoco 3.12.0, repeated.

#![recursion_limit = "256"]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gym_mujoco::{Data, Model, forward, physics, step};
use serde_json::{Value, json};

/// The folders of recordings: the one in this crate, and the one that `GYM_REFERENCE` names.
fn folders() -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recorded");
    let more = std::env::var_os("GYM_REFERENCE").map(|folder| PathBuf::from(folder).join("traces_mujoco"));
    std::iter::once(own).chain(more.filter(|folder| folder.is_dir())).collect()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The model of a recording: the text that it names, or a built-in one.
fn model(path: &Path, file: &Value) -> Model {
    let xml = match file["xml"].as_str() {
        Some(xml) => path.with_file_name(xml),
        None => Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("models")
            .join(file["model"].as_str().unwrap())
            .with_extension("xml"),
    };
    Model::from_xml(&read(&xml)).unwrap_or_else(|e| panic!("{}: {e}", xml.display()))
}

/// A recorded number, list or list of lists as numbers.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        Value::Bool(b) => vec![f64::from(u8::from(*b))],
        other => other.as_f64().into_iter().collect(),
    }
}

/// The largest difference, relative above 1; infinite where lengths differ.
fn off(expected: &Value, got: &Value) -> f64 {
    let (a, b) = (numbers(expected), numbers(got));
    if a.len() != b.len() {
        return f64::INFINITY;
    }
    a.iter().zip(&b).map(|(a, b)| (a - b).abs() / a.abs().max(1.0)).fold(0.0, f64::max)
}

fn start(m: &Model, case: &Value) -> Data {
    let mut d = Data::new(m);
    d.qpos = numbers(&case["qpos"]);
    d.qvel = numbers(&case["qvel"]);
    d.qacc_warmstart = numbers(&case["qacc_warmstart"]);
    d.ctrl = numbers(&case["ctrl"]);
    d.time = case["time"].as_f64().unwrap();
    d
}

fn after_step(m: &Model, d: &mut Data) -> Value {
    step(m, d);
    physics::rne_post_constraint(m, d);
    json!({
        "qpos": d.qpos, "qvel": d.qvel, "qacc": d.qacc, "qacc_warmstart": d.qacc_warmstart, "time": d.time,
        "ncon": d.contact.len(), "nefc": d.efc.nefc(), "nisland": d.efc.nisland, "solver_niter": d.solver_niter,
        "qfrc_constraint": d.qfrc_constraint, "cfrc_ext": d.cfrc_ext,
    })
}

fn after_forward(m: &Model, d: &mut Data) -> Value {
    forward(m, d);
    physics::rne_post_constraint(m, d);
    let efc = &d.efc;
    let contacts: Vec<Value> = d.contact.iter().map(|c| json!({
        "geom": c.geom, "dim": c.dim, "dist": c.dist, "pos": c.pos, "frame": c.frame, "includemargin": c.includemargin,
        "friction": c.friction, "solref": c.solref, "solimp": c.solimp, "mu": c.mu, "efc_address": c.efc_address,
    })).collect();
    json!({
        "xpos": d.xpos, "xquat": d.xquat, "xmat": d.xmat, "xipos": d.xipos, "ximat": d.ximat, "xanchor": d.xanchor, "xaxis": d.xaxis,
        "geom_xpos": d.geom_xpos, "geom_xmat": d.geom_xmat, "site_xpos": d.site_xpos, "subtree_com": d.subtree_com,
        "cinert": d.cinert, "cdof": d.cdof, "cvel": d.cvel, "cdof_dot": d.cdof_dot, "qLDiagInv": d.qld_diag_inv,
        "ten_length": d.ten_length, "ten_velocity": d.ten_velocity, "actuator_force": d.actuator_force,
        "qfrc_bias": d.qfrc_bias, "qfrc_passive": d.qfrc_passive, "qfrc_actuator": d.qfrc_actuator, "qfrc_smooth": d.qfrc_smooth,
        "qacc_smooth": d.qacc_smooth, "qacc": d.qacc, "qfrc_constraint": d.qfrc_constraint, "cfrc_ext": d.cfrc_ext,
        "qM": physics::full_m(m, d), "ncon": d.contact.len(), "nefc": efc.nefc(), "nisland": efc.nisland,
        "solver_niter": d.solver_niter, "efc_pos": efc.pos, "efc_margin": efc.margin, "efc_diagApprox": efc.diag_approx,
        "efc_R": efc.r, "efc_D": efc.d, "efc_KBIP": efc.kbip, "efc_vel": efc.vel, "efc_aref": efc.aref, "efc_force": efc.force,
        "efc_J": efc.full_jacobian(m.nv()), "efc_island": efc.island, "contact": contacts,
    })
}

/// Compares all cases of a file; tells the worst, and fails with all that is off.
fn compare(file: &Value, m: &Model, side: &str, run: fn(&Model, &mut Data) -> Value) -> Result<(), String> {
    let name = file["model"].as_str().unwrap();
    let (mut worst, mut bad, mut iterations, mut deep) = (BTreeMap::<String, f64>::new(), Vec::new(), 0, 0);
    for (i, case) in file["cases"].as_array().unwrap().iter().enumerate() {
        let got = run(m, &mut start(m, case));
        if case["deep"] == true {
            deep += 1;
            continue;
        }
        let limit = case["tolerance"].as_f64().unwrap_or(1e-9);
        for (key, expected) in case[side].as_object().unwrap() {
            if key == "solver_niter" {
                iterations += usize::from(off(expected, &got[key]) > 0.0);
                continue;
            }
            if got[key].is_null() {
                continue;
            }
            let mut w = if key == "contact" {
                let (a, b) = (expected.as_array().unwrap(), got[key].as_array().unwrap());
                let of = |(a, b): (&Value, &Value)| {
                    a.as_object().unwrap().iter().map(|(k, v)| off(v, &b[k])).fold(0.0, f64::max)
                };
                if a.len() == b.len() { a.iter().zip(b).map(of).fold(0.0, f64::max) } else { f64::INFINITY }
            } else {
                off(expected, &got[key])
            };
            if expected.is_u64() && w > 0.0 {
                w = f64::INFINITY;
            }
            let entry = worst.entry(if limit > 1e-9 { format!("{key}*") } else { key.clone() }).or_default();
            *entry = entry.max(w);
            if w > limit {
                bad.push(format!("case {i}: {key} {w:.1e}"));
            }
        }
    }
    let worst: Vec<String> =
        worst.iter().filter(|(_, w)| **w > 0.0).map(|(k, w)| format!("{k} {w:.0e}")).collect();
    println!("{name} {side}: {} ; {deep} deep; iterations differ in {iterations}", worst.join("  "));
    if bad.is_empty() {
        Ok(())
    } else {
        Err(format!("{name} {side}: {} off, first {:?}", bad.len(), &bad[..bad.len().min(12)]))
    }
}

fn all(kind: &str, side: &str, run: fn(&Model, &mut Data) -> Value) {
    let entries = folders().into_iter().flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let paths = entries.map(|entry| entry.unwrap().path());
    let is_kind = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        name.starts_with(&format!("{kind}.")) && name.ends_with(".json")
    };
    let mut paths: Vec<PathBuf> = paths.filter(is_kind).collect();
    paths.sort();
    assert!(!paths.is_empty(), "there are no recordings of {kind}");
    let mut failed = Vec::new();
    for path in paths {
        let file: Value =
            serde_json::from_str(&read(&path)).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        failed.extend(compare(&file, &model(&path, &file), side, run).err());
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn forward_calls() {
    all("forward", "out", after_forward);
}

#[test]
fn steps() {
    all("steps", "after", after_step);
}
