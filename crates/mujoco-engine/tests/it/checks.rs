//! What no compiled model can have is refused with its whole message. The numbers of a model that has every kind of object
//! are replaced one by one, and its lists shortened and lengthened: `recorded/checks.txt` has the messages. After an
//! intended change, store them with `GYM_UPDATE_KEPT=1 cargo test --package mujoco-engine --test it checks`.

use mujoco_engine::{CompiledModel, Model};
use serde_json::{Value, json};

use crate::numbers;

/// The model of other tests, with shapes, a texture, bodies that may sleep, and more kinds of references.
fn text() -> String {
    let parts = [
        (
            "<asset>",
            r#"<asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><mesh name="n" vertex="0 0 0 1 0 0 0 1 0 0 0 1 1 1 1"/>
                <hfield name="h" nrow="2" ncol="2" size="1 1 1 1"/><texture name="t" type="2d" builtin="flat" width="2" height="2"/>"#,
        ),
        (r#"rgba="1 0 0 1"/>"#, r#"rgba="1 0 0 1" texture="t"/>"#),
        (
            "<camera name",
            r#"<geom type="mesh" mesh="m" pos="9 9 9"/><geom type="hfield" hfield="h" pos="-9 -9 -9"/>
                <geom type="mesh" mesh="n" pos="9 0 9"/><camera name"#,
        ),
        (
            "<contact>",
            r#"<contact><exclude body1="upper" body2="lower"/>"#,
        ),
        (
            "<equality>",
            r#"<equality><weld body1="ball" body2="box"/><connect site1="s0" site2="s1"/>"#,
        ),
        (
            "<actuator>",
            r#"<actuator><motor cranksite="s0" slidersite="s1" cranklength="1"/><motor site="s0" refsite="s1"/>
                <adhesion body="box" ctrlrange="0 1"/>"#,
        ),
        (
            "<sensor>",
            r#"<sensor><framepos objtype="geom" objname="g0" reftype="site" refname="s1"/><distance geom1="g0" geom2="g2"/>
                <contact geom1="g2" num="2"/><insidesite site="s0" objtype="body" objname="box"/><tendonpos tendon="u"/>"#,
        ),
        (
            r#"viscosity=".01"/>"#,
            r#"viscosity=".01"><flag sleep="enable"/></option>"#,
        ),
    ];
    parts
        .iter()
        .fold(numbers::TEXT.to_owned(), |text, (old, new)| {
            assert!(text.contains(old), "{old}");
            text.replacen(old, new, 1)
        })
}

/// A change at a place of a model: what it does, and the new value.
type Change = (String, &'static str, Value);

/// The changes of a value: other numbers, and lists of other lengths. Of a list, the last element is changed; of a row of
/// numbers, the first and the last; of the hulls of meshes each, for some say where others stand.
fn changes(place: &str, value: &Value, list: &mut Vec<Change>) {
    match value {
        Value::Object(fields) => {
            for (name, value) in fields {
                changes(&format!("{place}/{name}"), value, list);
            }
        }
        Value::Array(rows) => {
            let Some(end) = rows.last() else { return };
            let within = place.matches('/').count() > 1 && !place.starts_with("/names");
            if !within {
                let (mut shorter, mut longer) = (rows.clone(), rows.clone());
                shorter.pop();
                longer.push(end.clone());
                list.push((place.to_owned(), "shorter", json!(shorter)));
                list.push((place.to_owned(), "longer", json!(longer)));
            }
            if within && rows.len() > 1 {
                changes(&format!("{place}/0"), &rows[0], list);
            }
            let last = rows.len() - 1;
            let first = if place == "/mesh_graph" { 0 } else { last };
            for (i, row) in rows.iter().enumerate().skip(first) {
                changes(&format!("{place}/{i}"), row, list);
            }
        }
        Value::Number(number) if number.is_f64() => {
            for other in [-1.0, 0.0, 1e3, 1e300] {
                list.push((place.to_owned(), "is", json!(other)));
            }
        }
        Value::Number(_) => {
            let others = [-1, 7, 0, 1, 99_999];
            let count = if place.starts_with("/mesh_graph/") {
                2
            } else {
                5
            };
            for other in &others[..count] {
                list.push((place.to_owned(), "is", json!(other)));
            }
        }
        _ => {}
    }
}

#[test]
fn what_no_model_has_is_refused_in_the_recorded_words() {
    let m = Model::from_xml(&text()).unwrap_or_else(|error| panic!("{error}"));
    let mut figures = serde_json::to_value(&*m).unwrap();
    let mut list = Vec::new();
    changes("", &figures, &mut list);
    assert!(list.len() > 1500, "{}", list.len());
    let mut found = Vec::new();
    for (place, what, value) in list {
        let before = figures.pointer(&place).unwrap().clone();
        let shown = if what == "is" {
            format!(" {value}")
        } else {
            String::new()
        };
        *figures.pointer_mut(&place).unwrap() = value;
        let error = match serde_json::from_value::<CompiledModel>(figures.clone()) {
            Ok(changed) => Model::new(changed).err().map(|error| error.to_string()),
            // the words of the reader of JSON are its own
            Err(error) => Some(error.to_string()).filter(|error| error.contains("supported are")),
        };
        if let Some(error) = error {
            let error = error
                .strip_prefix("the compiled model is not valid: ")
                .unwrap_or(&error);
            found.push(format!("{place} {what}{shown}: {error}"));
        }
        *figures.pointer_mut(&place).unwrap() = before;
    }
    // the order of fields is that of the reader of JSON
    found.sort();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/recorded/checks.txt");
    if std::env::var_os("GYM_UPDATE_KEPT").is_some() {
        std::fs::write(path, found.join("\n") + "\n").unwrap();
    }
    let known = std::fs::read_to_string(path).unwrap();
    let known: Vec<_> = known.lines().collect();
    let wrong: Vec<_> = found
        .iter()
        .filter(|line| !known.contains(&line.as_str()))
        .collect();
    assert!(found == known, "{wrong:#?}");
}
