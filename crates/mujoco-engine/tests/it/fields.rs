//! Each attribute changes the fields of a model that it changes in libmujoco, to the same numbers.
//! `recorded/fields.py` recorded them.

use std::collections::BTreeMap;

use mujoco_engine::{Model, Revision};
use serde_json::Value;

use super::digest::Digest;
use super::{parts, results};

fn recorded() -> Value {
    serde_json::from_str(include_str!("../recorded/fields.json")).unwrap()
}

/// Returns the model of a recording: `text` stands at `@place`, and what is in parentheses at others.
fn model(base: &str, place: &str, text: &str) -> String {
    let mut parts = base.split('@');
    let mut model = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|c: char| !c.is_alphanumeric()).unwrap();
        let (name, rest) = part.split_at(end);
        let (own, rest) = match rest.strip_prefix('(') {
            Some(rest) => rest.split_once(')').unwrap(),
            None => ("", rest),
        };
        model += if name == place { text } else { own };
        model += rest;
    }
    model
}

/// Appends the numbers in a value; returns whether it has no others.
fn flatten(value: &Value, numbers: &mut Vec<u64>) -> bool {
    match value {
        Value::Bool(is) => numbers.push(f64::from(u8::from(*is)).to_bits()),
        Value::Number(number) => numbers.push(number.as_f64().unwrap().to_bits()),
        Value::Array(parts) => return parts.iter().all(|part| flatten(part, numbers)),
        _ => return false,
    }
    true
}

type Fields = BTreeMap<String, Vec<u64>>;

/// The numbers of each field.
fn fields(value: &Value) -> Fields {
    let mut fields = Fields::new();
    for (name, value) in value.as_object().unwrap() {
        let mut numbers = Vec::new();
        if flatten(value, &mut numbers) {
            fields.insert(name.clone(), numbers);
        } else if ["opt", "stat"].contains(&&**name) {
            for (own, numbers) in self::fields(value) {
                fields.insert(format!("{name}.{own}"), numbers);
            }
        }
    }
    fields
}

fn is_of_meshes(field: &str) -> bool {
    field.starts_with("mesh_") || ["geom_aabb", "geom_dataid"].contains(&field)
}

#[test]
fn attributes_change_the_fields_that_they_change_in_libmujoco() {
    let recorded = recorded();
    let base = recorded["base"].as_str().unwrap();
    let rows = recorded["rows"].as_array().unwrap();
    let (mut before, mut known) = (Vec::<Fields>::new(), Fields::new());
    let mut wrong = Vec::new();
    for (version, expected) in recorded["versions"].as_object().unwrap() {
        let revision: Revision = version.parse().unwrap();
        let own = |place: &str, text: &str| {
            let model = Model::from_xml_with(&model(base, place, text), revision)
                .unwrap_or_else(|error| panic!("{version}, {place} {text}: {error}"));
            fields(&serde_json::to_value(&*model).unwrap())
        };
        known.extend(fields(&expected["plain"]));
        let mut plain = own("", "");
        plain.retain(|name, _| known.contains_key(name));
        assert!(plain.len() > 150, "{} fields", plain.len());
        let mut compare = |place: &str, name: &str, own: &[u64], known: &[u64]| {
            if own != known {
                let [own, known] = [own, known]
                    .map(|bits| -> Vec<_> { bits.iter().map(|x| f64::from_bits(*x)).collect() });
                wrong.push(format!(
                    "{version}, {place}: {name} is {own:?}, not {known:?}"
                ));
            }
        };
        for (name, numbers) in &plain {
            compare("plain", name, numbers, &known[name]);
        }
        let changes: Vec<Fields> = expected["rows"]
            .as_array()
            .unwrap()
            .iter()
            .enumerate()
            .map(|(i, row)| match row {
                Value::Null => before[i].clone(),
                row => fields(row),
            })
            .collect();
        assert_eq!(changes.len(), rows.len());
        for (row, changes) in rows.iter().zip(&changes) {
            let [place, text] = [0, 1].map(|i| row[i].as_str().unwrap());
            let own = own(place, text);
            for (name, plain) in &plain {
                let own = own.get(name).map_or(&[][..], |own| own);
                // models without meshes lack fields of meshes
                if !(own.is_empty() && is_of_meshes(name)) {
                    let known = changes.get(name).unwrap_or(plain);
                    compare(&format!("{place} {text}"), name, own, known);
                }
            }
        }
        before = changes;
    }
    assert!(
        wrong.is_empty(),
        "{} differ:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

/// The numbers of all fields that MuJoCo has too, but for 0 and -1, which stand for nothing and may be left out.
fn digest(text: &str, version: &str, known: &Fields) -> String {
    let m = match Model::from_xml_with(text, version.parse().unwrap()) {
        Ok(m) => m,
        Err(error) => return error.to_string(),
    };
    let mut digest = Digest::default();
    for (name, numbers) in fields(&serde_json::to_value(&*m).unwrap()) {
        if !known.contains_key(&name) {
            continue;
        }
        let word = name.bytes().map(f64::from).sum();
        for (place, bits) in numbers.iter().enumerate() {
            let number = f64::from_bits(*bits);
            if number != 0.0 && number != -1.0 {
                digest.numbers(&[word, place as f64, number]);
            }
        }
    }
    format!("{:016x}", digest.0)
}

/// `recorded/compiled/record.py` recorded the digests.
#[test]
fn models_with_each_part_have_the_fields_that_they_have_in_libmujoco() {
    let recorded = recorded();
    let mut known = fields(&recorded["versions"]["3.12.0"]["plain"]);
    // flags that have no effect here, numbers of constraints that nothing reads, and boxes that only meshes need
    for name in ["opt.enableflags", "eq_data", "geom_aabb"] {
        known.remove(name).expect(name);
    }
    let recordings = [
        ("3.12", include_str!("../recorded/compiled/3.12.txt")),
        ("3.17", include_str!("../recorded/compiled/3.17.txt")),
        ("4.0", include_str!("../recorded/compiled/4.0.txt")),
    ];
    // (lengths that are measured in steps with the limit of a ball joint differ in their last bits)
    parts::assert_alike(&results::models(), recordings, |text, version| {
        digest(text, version, &known)
    });
}

/// The attributes of a text, with their values.
fn attributes(text: &str) -> Vec<(&str, &str)> {
    let parts: Vec<_> = text.split('\'').collect();
    let pairs = parts.chunks_exact(2);
    pairs
        .map(|pair| (pair[0].trim().trim_end_matches('='), pair[1]))
        .collect()
}

#[test]
fn each_word_that_should_be_a_number_is_refused_if_it_is_none() {
    let recorded = recorded();
    let base = recorded["base"].as_str().unwrap();
    let (mut refused, mut accepted) = (0, Vec::new());
    for row in recorded["rows"].as_array().unwrap() {
        let [place, text] = [&row[0], &row[1]].map(|part| part.as_str().unwrap());
        for (name, value) in attributes(text) {
            let words: Vec<_> = value.split_whitespace().collect();
            if words.is_empty() || words.iter().any(|word| word.parse::<f64>().is_err()) {
                continue;
            }
            for k in 0..words.len() {
                let mut wrong = words.clone();
                wrong[k] = "1o";
                let [from, to] = [value, &wrong.join(" ")].map(|x| format!("{name}='{x}'"));
                let text = model(base, place, &text.replacen(&from, &to, 1));
                let Err(error) = Model::from_xml(&text) else {
                    accepted.push(format!("{place} {name}"));
                    continue;
                };
                let (error, named) = (error.to_string(), format!("attribute \"{name}\""));
                assert!(
                    error.contains(&named) && error.contains("1o"),
                    "{to}: {error}"
                );
                refused += 1;
            }
        }
    }
    assert!(refused > 400, "{refused}");
    // all tendons are drawn alike: what they look like in MuJoCo is not read
    accepted.dedup();
    assert_eq!(accepted, ["spatial width", "spatial rgba"]);
}

#[test]
fn each_element_refuses_an_attribute_that_it_does_not_have() {
    let recorded = recorded();
    let plain = model(recorded["base"].as_str().unwrap(), "", "");
    let plain = plain.replacen("<statistic", "<default/><statistic", 1);
    let (mut refused, mut accepted) = (0, Vec::new());
    for (at, _) in plain.match_indices('<') {
        let rest = &plain[at + 1..];
        let element = rest.split(|c: char| !c.is_alphanumeric()).next().unwrap();
        if element.is_empty() {
            continue; // the end of one
        }
        let (before, after) = plain.split_at(at + 1 + element.len());
        let Err(error) = Model::from_xml(&format!("{before} nosuch='1'{after}")) else {
            accepted.push(element);
            continue;
        };
        let named = format!("<{element}> attribute \"nosuch\"");
        assert!(error.to_string().contains(&named), "{error}");
        refused += 1;
    }
    assert!(refused > 60, "{refused}");
    assert_eq!(accepted, [""; 0]);
}
