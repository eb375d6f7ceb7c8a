//! Data that served one model serves another: after a reset it has the sizes, and takes the steps, of data made for it.

use mujoco_engine::{Data, Model, step};
use serde_json::json;

use super::parts::seen;

/// Two bodies, one within the other or beside it, and parts of a model.
fn text(nested: bool, option: &str, world: &str, more: &str) -> String {
    let second = r#"<body name="b" pos="1 0 0"><joint name="j" axis="0 1 0"/><geom name="h" size=".1" pos=".2 0 0"/><site name="t"/></body>"#;
    let first =
        r#"<joint name="i" axis="0 1 0"/><geom name="g" size=".1" pos=".2 0 0"/><site name="s"/>"#;
    let bodies = if nested {
        format!("<body>{first}{second}</body>")
    } else {
        format!("<body>{first}</body>{second}")
    };
    format!(
        "<mujoco><option {option}</option><worldbody><geom type=\"plane\" size=\"9 9 1\" pos=\"0 0 -.25\"/>{world}{bodies}</worldbody>{more}</mujoco>"
    )
}

/// Models of which each differs from the first in one size.
fn models() -> Vec<Model> {
    let box_of = r#"<body pos="0 3 0"><joint type="slide" axis="0 0 1"/><geom type="SHAPE" size=".1 .1 .1"/></body>"#;
    let shape = |kind: &str| box_of.replace("SHAPE", kind);
    let texts = [
        text(true, ">", "", ""),
        text(false, ">", "", ""),
        text(true, "integrator=\"RK4\">", "", ""),
        text(true, "integrator=\"implicit\">", "", ""),
        text(true, "integrator=\"implicitfast\">", "", ""),
        text(true, "solver=\"PGS\">", "", ""),
        text(true, "solver=\"CG\" cone=\"elliptic\">", "", ""),
        text(true, "jacobian=\"sparse\">", "", ""),
        text(false, "><flag sleep=\"enable\"/>", "", ""),
        text(true, ">", "<site/>", ""),
        text(true, ">", "<body><geom size=\".1\"/></body>", ""),
        text(true, ">", "<geom size=\".1\"/>", ""),
        text(true, ">", "<body mocap=\"true\"/>", ""),
        text(true, ">", &shape("sphere"), ""),
        text(true, ">", &shape("box"), ""),
        text(true, ">", &shape("ellipsoid"), ""),
        text(true, "ccd_iterations=\"90\">", &shape("ellipsoid"), ""),
        text(
            true,
            ">",
            "<body pos=\"0 3 0\"><freejoint/><geom size=\".1\"/></body>",
            "",
        ),
        text(
            true,
            ">",
            "<body pos=\"0 3 0\"><joint type=\"ball\"/><geom size=\".1\" pos=\".1 0 0\"/></body>",
            "",
        ),
        text(true, ">", "", "<actuator><motor joint=\"j\"/></actuator>"),
        text(
            true,
            ">",
            "",
            "<actuator><intvelocity joint=\"j\" actrange=\"-1 1\"/></actuator>",
        ),
        text(
            true,
            ">",
            "",
            "<tendon><fixed><joint joint=\"j\" coef=\"1\"/></fixed></tendon>",
        ),
        text(
            true,
            ">",
            "",
            "<tendon><spatial stiffness=\"1\"><site site=\"s\"/><site site=\"t\"/></spatial></tendon>",
        ),
        text(
            true,
            ">",
            "",
            "<equality><connect body1=\"b\" anchor=\"0 0 0\"/></equality>",
        ),
        text(true, ">", "", "<sensor><jointpos joint=\"j\"/></sensor>"),
        text(
            true,
            ">",
            "",
            "<sensor><accelerometer site=\"t\"/></sensor>",
        ),
    ];
    texts
        .iter()
        .map(|text| Model::from_xml(text).unwrap_or_else(|error| panic!("{text}: {error}")))
        .collect()
}

#[test]
fn data_of_one_model_serves_each_other() {
    let models = models();
    let run = |d: &mut Data, m: &Model| {
        for i in 0..4 {
            d.ctrl.fill(0.5);
            d.qfrc_applied.fill(f64::from(i) * 0.1);
            step(m, d);
        }
    };
    let fresh: Vec<_> = models
        .iter()
        .map(|m| {
            let mut d = Data::new(m);
            run(&mut d, m);
            json!([d, seen(&d), d.tree_asleep])
        })
        .collect();
    for (from, first) in models.iter().enumerate() {
        let mut used = Data::new(first);
        run(&mut used, first);
        for (to, second) in models.iter().enumerate() {
            let mut d = used.clone();
            d.reset(second);
            run(&mut d, second);
            let found = json!([d, seen(&d), d.tree_asleep]);
            let pairs = found
                .as_array()
                .unwrap()
                .iter()
                .zip(fresh[to].as_array().unwrap());
            for (part, (found, fresh)) in pairs.enumerate() {
                assert_eq!(
                    found, fresh,
                    "part {part} of data of model {from} for model {to}"
                );
            }
        }
    }
}
