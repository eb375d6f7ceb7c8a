//! The whole text of refusals: what is wrong, and in which part.
//!
//! After an intended change, store the new texts with
//! `GYM_UPDATE_KEPT=1 cargo test --package rust-gym-core --test it refusals`.

use std::fmt::Write;
use std::path::Path;

use gym_core::spaces::{
    DictSpace, GraphSpace, MultiBinary, MultiDiscrete, OneOfSpace, SequenceSpace, TextSpace,
    TupleSpace,
};
use gym_core::{Result, Space, Value};
use gym_testing::kept;
use serde_json::{Value as Json, json};

/// A space of each kind, with an element.
pub(crate) fn kinds() -> Vec<(Space, Json)> {
    let three = || Space::discrete(3);
    let pair = || Space::from(TupleSpace::new([three(), Space::discrete(2)]));
    let text = TextSpace::new(1, 2).and_then(|text| text.with_charset("ab"));
    let dict = DictSpace::new([("a", three()), ("b", pair())]).unwrap();
    let graph = GraphSpace::new(three(), Some(Space::discrete(2))).unwrap();
    let links = json!({"nodes": [0, 2], "edges": [1], "edge_links": [[1, 0]]});
    vec![
        (three(), json!(2)),
        (Space::boxed([0.0; 2], [1.0; 2]), json!([0.5, 1.0])),
        (MultiDiscrete::new([3, 4]).unwrap().into(), json!([2, 3])),
        (MultiBinary::new([2]).unwrap().into(), json!([0, 1])),
        (text.unwrap().into(), json!("ba")),
        (pair(), json!([2, 1])),
        (dict.into(), json!({"a": 1, "b": [2, 1]})),
        (SequenceSpace::new(pair()).into(), json!([[2, 1], [0, 0]])),
        (
            SequenceSpace::stacked(pair()).into(),
            json!([[2, 0], [1, 0]]),
        ),
        (graph.into(), links),
        (
            OneOfSpace::new([three(), pair()]).unwrap().into(),
            json!([1, [2, 1]]),
        ),
    ]
}

/// The places of all parts, the whole first.
fn places(json: &Json, place: &str, found: &mut Vec<String>) {
    found.push(place.to_owned());
    match json {
        Json::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                places(item, &format!("{place}/{i}"), found);
            }
        }
        Json::Object(entries) => {
            for (key, entry) in entries {
                places(entry, &format!("{place}/{key}"), found);
            }
        }
        _ => {}
    }
}

/// What may stand in a place instead.
fn others(part: &Json) -> Vec<Json> {
    let mut others = vec![json!(null), json!(-7), json!(9.5), json!("x"), json!([])];
    match part {
        Json::Array(items) => others.push([items.as_slice(), &[items[0].clone()]].concat().into()),
        Json::Object(entries) => {
            for key in entries.keys() {
                let mut fewer = entries.clone();
                fewer.remove(key);
                others.push(fewer.into());
            }
            let mut more = entries.clone();
            more.insert("more".into(), json!(0));
            others.push(more.into());
        }
        _ => {}
    }
    others
}

fn tell(told: &mut String, what: &str, answer: Result<()>) {
    let answer = answer.map_or_else(|error| error.to_string(), |()| "taken".into());
    writeln!(told, "  {what}: {answer}").unwrap();
}

/// Elements as JSON, of which each part in turn is something else.
#[test]
fn a_refused_element_tells_the_part_and_the_fault() {
    let mut told = String::new();
    for (kind, element) in kinds() {
        writeln!(told, "{kind}").unwrap();
        // the second of two, so that no place is always the first
        let space = Space::from(TupleSpace::new([kind.clone(), kind]));
        let whole = json!([element, element]);
        let read = |json: &Json| space.from_json(json).and_then(|value| space.check(&value));
        read(&whole).unwrap();
        let mut all = Vec::new();
        places(&element, "/1", &mut all);
        for place in all {
            for other in others(whole.pointer(&place).unwrap()) {
                let what = format!("{place} is {other}");
                let mut spoilt = whole.clone();
                *spoilt.pointer_mut(&place).unwrap() = other;
                tell(&mut told, &what, read(&spoilt));
            }
        }
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it");
    kept(&folder.join("refused_elements.txt"), &told);
}

/// Values of other spaces, flat elements with a wrong number, and batches with a row of another space.
#[test]
fn a_refused_value_tells_the_part_and_the_fault() {
    let mut told = String::new();
    let elements = |(space, json): (Space, Json)| (space.from_json(&json).unwrap(), space);
    let all: Vec<(Value, Space)> = kinds().into_iter().map(elements).collect();
    for (element, kind) in &all {
        writeln!(told, "{kind}").unwrap();
        let space = Space::from(TupleSpace::new([kind.clone(), kind.clone()]));
        let mut batch = kind.empty_batch(2).unwrap();
        for (other, _) in &all {
            let pair = Value::Tuple(vec![element.clone(), other.clone()]);
            tell(&mut told, &other.to_string(), space.check(&pair));
            tell(&mut told, "  as JSON", space.to_json(&pair).map(drop));
            tell(&mut told, "  flat", space.flatten(&pair).map(drop));
            tell(
                &mut told,
                "  as a row",
                kind.write_row(&mut batch, 1, other),
            );
        }
        let pair = Value::Tuple(vec![element.clone(); 2]);
        let Value::Array(flat) = space.flatten(&pair).unwrap() else {
            continue;
        };
        let flat: Vec<f64> = flat.iter_f64().collect();
        for (i, number) in (flat.len() / 2..flat.len()).flat_map(|i| [(i, 0.5), (i, f64::NAN)]) {
            let mut spoilt = flat.clone();
            spoilt[i] = number;
            let answer = space.unflatten(&Value::Array(spoilt.into()));
            tell(
                &mut told,
                &format!("flat with {number} at {i}"),
                answer.map(drop),
            );
        }
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it");
    kept(&folder.join("refused_values.txt"), &told);
}

/// Batches of other spaces or of another length, flat elements and actions of other spaces: each call
/// with its whole refusal.
#[test]
fn a_refused_batch_or_action_tells_the_part_and_the_fault() {
    let three = || Space::discrete(3);
    let ranks = SequenceSpace::new(three());
    let deep = DictSpace::new([("a", ranks.clone().into()), ("b", three())]).unwrap();
    let long = TupleSpace::new([three(), ranks.into()]);
    let mut all: Vec<(Space, Value)> = kinds()
        .into_iter()
        .chain([
            (deep.into(), json!({"a": [2], "b": 1})),
            (long.into(), json!([1, [2, 0]])),
        ])
        .map(|(space, json)| (space.clone(), space.from_json(&json).unwrap()))
        .collect();
    let numbers = |value: Value| (Space::boxed([0.0; 2], [1.0; 2]), value);
    all.extend([
        numbers([f32::NAN, 0.0].into()),
        numbers([0.5_f64, f64::INFINITY].into()),
        numbers([0_i32, 7].into()),
        numbers(Value::Tuple(vec![Value::Float(0.5), Value::Bool(true)])),
    ]);
    let mut told = String::new();
    for (space, element) in &all[..kinds().len() + 2] {
        writeln!(told, "{space}").unwrap();
        for (i, (kind, other)) in all.iter().enumerate() {
            let two = Value::Tuple(vec![element.clone(), other.clone()]);
            let batch = match kind.concatenate(&[other.clone(), other.clone()]) {
                Ok(batch) if i % 2 == 0 => batch,
                _ => two,
            };
            let (mut row, mut real) = (Value::Null, Value::Null);
            let answers = [
                ("checked", space.check_batch(&batch, 2)),
                ("for three", space.check_batch(&batch, 3)),
                ("as actions", space.check_actions(&batch, 2)),
                ("row", space.read_row(&batch, 1, &mut row)),
                ("row that is not there", space.read_row(&batch, 2, &mut row)),
                ("action", space.read_action(&batch, 1, &mut row)),
                ("iterated", space.iterate(&batch).map(drop)),
                (
                    "together",
                    space
                        .concatenate(&[element.clone(), other.clone()])
                        .map(drop),
                ),
                ("from flat", space.unflatten(other).map(drop)),
                ("as numbers", space.real_action(other, None, &mut real)),
                ("refused", Err(space.refuse_action(other))),
            ];
            let mut texts: Vec<(String, Vec<&str>)> = Vec::new();
            for (call, answer) in answers {
                let text = answer.map_or_else(|error| error.to_string(), |()| "taken".into());
                match texts.iter_mut().find(|(known, _)| *known == text) {
                    Some((_, calls)) => calls.push(call),
                    None => texts.push((text, vec![call])),
                }
            }
            writeln!(told, "  {other} in {batch}").unwrap();
            for (text, calls) in texts {
                writeln!(told, "    {}: {text}", calls.join(", ")).unwrap();
            }
        }
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it");
    kept(&folder.join("refused_batches.txt"), &told);
}
