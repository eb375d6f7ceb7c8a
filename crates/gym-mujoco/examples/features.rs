//! Compares what the engine makes of recordings of features with what they say, by bits.
//!
//! `cargo run -p gym-mujoco --example features -- FILE...`

use gym_mujoco::recording;
use serde_json::{Map, Value};

fn bits(value: &Value) -> Vec<u64> {
    match value {
        Value::Array(list) => list.iter().flat_map(bits).collect(),
        number => vec![number.as_f64().unwrap_or(f64::NAN).to_bits()],
    }
}

fn first(place: &str, expected: &Value, found: &Value) -> Option<String> {
    for (key, expected) in expected.as_object()? {
        let (a, b) = (bits(expected), bits(&found[key]));
        if a != b {
            let at = a.iter().zip(&b).position(|(a, b)| a != b);
            let number = |x: Option<&u64>| x.map_or(f64::NAN, |x| f64::from_bits(*x));
            let at = at.unwrap_or(a.len().min(b.len()));
            return Some(format!(
                "{place}: {key}[{at}] {:?} for {:?} ({} for {})",
                number(b.get(at)),
                number(a.get(at)),
                b.len(),
                a.len()
            ));
        }
    }
    None
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut equal, mut total) = (0, 0);
    for path in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&path)?;
        let file: Map<String, Value> = serde_json::from_str(&text)?;
        if let (Ok(step), Ok(version)) = (std::env::var("DUMP"), std::env::var("VER")) {
            dump(&file, step.parse()?, &version)?;
            continue;
        }
        let name = file["name"].as_str().unwrap_or_default().to_owned();
        let answer = recording::answer(&file, std::path::Path::new(""))?;
        if let Some(error) = answer.get("error") {
            println!("{name}: {error}");
            total += 2;
            continue;
        }
        for (version, expected) in file["versions"].as_object().into_iter().flatten() {
            let found = &answer["versions"][version];
            let steps = expected["steps"].as_array().into_iter().flatten();
            let mut faults: Vec<Option<String>> = steps
                .enumerate()
                .map(|(i, step)| {
                    let place = format!("step {i}");
                    first(&place, &step["after"], &found["steps"][i]["after"])
                })
                .collect();
            for (mark, state) in expected["episode"].as_object().into_iter().flatten() {
                faults.push(first(
                    &format!("after {mark}"),
                    state,
                    &found["episode"][mark],
                ));
            }
            let good = faults.iter().filter(|fault| fault.is_none()).count();
            let fault = faults.iter().flatten().next();
            total += 1;
            equal += usize::from(fault.is_none());
            let fault = fault.map_or(String::new(), |fault| format!("; {fault}"));
            println!("{name} {version}: {good} of {}{fault}", faults.len());
        }
    }
    println!("{equal} of {total} equal");
    Ok(())
}

fn dump(
    file: &Map<String, Value>,
    step: usize,
    version: &str,
) -> Result<(), Box<dyn std::error::Error>> {
    use gym_mujoco::{Data, Model};
    let m = Model::from_xml_with(file["xml"].as_str().unwrap(), version.parse()?)?;
    let case = &file["versions"][version]["steps"][step];
    let list = |key: &str| -> Vec<f64> {
        case[key]
            .as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect()
    };
    let mut d = Data::new(&m);
    d.qpos = list("qpos");
    d.qvel = list("qvel");
    d.act = list("act");
    d.ctrl = list("ctrl");
    d.qacc_warmstart = list("qacc_warmstart");
    d.mocap_pos = list("mocap_pos").as_chunks().0.to_vec();
    d.mocap_quat = list("mocap_quat").as_chunks().0.to_vec();
    d.time = list("time")[0];
    gym_mujoco::forward(&m, &mut d);
    println!(
        "{}",
        serde_json::json!({"efc_pos": d.efc.pos, "efc_vel": d.efc.vel, "efc_aref": d.efc.aref, "efc_D": d.efc.d,
      "efc_diagA": d.efc.diag_approx, "qacc_smooth": d.qacc_smooth, "qfrc_constraint": d.qfrc_constraint, "qfrc_smooth": d.qfrc_smooth,
      "niter": d.solver_niter, "con_pos": d.contact.iter().map(|c| c.pos).collect::<Vec<_>>(), "con_frame": d.contact.iter().map(|c| c.frame).collect::<Vec<_>>(), "cdof": d.cdof, "qacc": d.qacc, "eq_data": m.eq_data, "efc_force": d.efc.force, "body_invweight0": m.body_invweight0})
    );
    Ok(())
}
