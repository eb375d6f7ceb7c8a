//! The whole text of refusals of arguments and names; the whole infos of vectors.
//!
//! After an intended change, store the new texts with
//! `GYM_UPDATE_KEPT=1 cargo test --package rust-gym-core --test it told`.

use std::fmt::Write;
use std::path::Path;

use gym_core::names::{Names, parts};
use gym_core::spaces::{DictSpace, TupleSpace};
use gym_core::vector::{Autoreset, SyncVectorEnv, VectorReset};
use gym_core::wrappers::TimeLimit;
use gym_core::{
    Array, DType, Env, EnvExt, Outcome, Reset, Result, Space, Value, VectorEnv, VectorEnvExt,
    arguments,
};
use gym_testing::kept;
use serde_json::{Value as Json, json};

fn keep(name: &str, told: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it");
    kept(&folder.join(name), told);
}

gym_core::arguments! {
    /// Arguments of every type.
    struct Config {
        /// A flag.
        pub flag: bool = true,
        /// A number.
        pub real: f64 = 0.5,
        /// A number in single precision.
        pub single: f32 = 0.25,
        /// From -128 to 127.
        pub tiny: i8 = 1,
        /// From 0 to 255.
        pub shade: u8 = 2,
        /// From 0 on.
        #[versions = 2..]
        pub width: u32 = 3,
        /// Any whole number.
        #[versions = 0 | 1]
        pub height: i64 = 4,
        /// A number of things.
        pub count: usize = 5,
        /// A text.
        pub text: String = "text".into(),
        /// A text or nothing.
        pub maybe: Option<String> = None,
        /// Texts.
        pub lines: Vec<String> = vec![],
        /// Three numbers.
        pub three: [f64; 3] = [1.0, 2.0, 3.0],
        /// The type of numbers.
        pub dtype: DType = DType::F32,
    }
}

/// Each argument with a value of each kind, and what is unknown: the first of several faults is told.
#[test]
fn an_argument_that_does_not_fit_is_told_in_full() {
    let values = [
        json!(null),
        json!(true),
        json!(1),
        json!(-1),
        json!(1.5),
        json!(300),
        json!(-1_i64 << 40),
        json!(u64::MAX),
        json!("float64"),
        json!([]),
        json!([1, 2.5, 3]),
        json!(["a", 1]),
        json!({"a": 1}),
    ];
    let mut told = String::new();
    let read = |version, given: &Json| {
        let given = given.as_object().unwrap();
        arguments::read(&Config::default(), version, given, "`A-v2`")
    };
    let stored = serde_json::to_value(Config::default()).unwrap();
    let names: Vec<&String> = stored.as_object().unwrap().keys().collect();
    for name in names {
        for value in &values {
            let version = if name == "height" { 1 } else { 2 };
            let text = match read(version, &json!({ name: value })) {
                Ok(config) => serde_json::to_value(config).unwrap()[name].to_string(),
                Err(error) => error.to_string(),
            };
            writeln!(told, "{name} is {value}: {text}").unwrap();
        }
    }
    for (version, given) in [
        (2, json!({"heigth": 1})),
        (1, json!({"heigth": 1})),
        (1, json!({"widht": 1})),
        (2, json!({"height": 1})),
        (1, json!({"width": 1})),
        (2, json!({"nothing": 1})),
        (2, json!({"": 1})),
        (2, json!({"zzz": 1, "aaa": 2})),
        (2, json!({"aaa": 2, "real": "x"})),
        (2, json!({"shade": -1, "tiny": 200})),
        (2, json!({"three": [1, 2], "count": 1.5})),
        (2, json!({"real": 1, "text": 2, "width": 7})),
    ] {
        let text = read(version, &given).map_or_else(|error| error.to_string(), |_| "taken".into());
        writeln!(told, "{given} in version {version}: {text}").unwrap();
    }
    keep("refused_arguments.txt", &told);
}

/// Names of numbers count within their part, and the part is named.
#[test]
fn a_name_that_does_not_fit_is_told_with_its_part() {
    let pair = || Space::boxed([0.0; 2], [1.0; 2]);
    let inner = TupleSpace::new([Space::discrete(2), pair()]);
    let nested: Space = DictSpace::new([("a", pair()), ("b", inner.into())])
        .unwrap()
        .into();
    let refused = |space: &Space, names: &[&str]| {
        let names = Names::new(names, &[]).observation;
        let told = parts(space, &names).map(|parts| parts.len());
        told.unwrap_err().to_string()
    };
    let mut told = String::new();
    for (space, names) in [
        (pair(), &["x"] as &[&str]),
        (pair(), &["x", "x"]),
        (pair(), &["", "x"]),
        (nested.clone(), &["x", "y", "n", "x"]),
        (nested.clone(), &["x", "y", "n", "x", "y", "z"]),
        (nested.clone(), &["x", "x", "n", "x", "y"]),
        (nested.clone(), &["x", "y", " ", "x", "y"]),
        (nested.clone(), &["x", "y", "n", "y", "y"]),
        (nested.clone(), &["x", "y", "n", "y", "\n"]),
    ] {
        writeln!(told, "{names:?}: {}", refused(&space, names)).unwrap();
    }
    // the same name in two parts
    let names = Names::new(&["x", "y", "x", "x", "y"], &[]).observation;
    assert_eq!(parts(&nested, &names).unwrap().len(), 3);
    keep("refused_names.txt", &told);
}

/// An environment with given infos, whose episodes have `length` steps.
#[derive(Clone, Debug)]
struct Informed {
    infos: Vec<(&'static str, Value)>,
    length: i64,
    steps: i64,
}

impl Env for Informed {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(100)
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        (self.steps, *observation) = (0, 0);
        Ok(())
    }

    fn step_into(&mut self, _: &i64, observation: &mut i64) -> Result<Outcome> {
        self.steps += 1;
        *observation = self.steps;
        Ok(Outcome {
            reward: 1.0,
            terminated: self.steps == self.length,
            truncated: false,
        })
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        for (name, value) in &self.infos {
            visit(name, value.clone());
        }
    }
}

/// Infos of each kind, which the first, the second or both of three environments have; another kind in the third.
#[test]
fn infos_of_a_vector_have_a_column_of_each_kind() {
    let dict = |x: Value| Value::Dict(vec![("x".into(), x), ("y".into(), Value::Bool(true))]);
    let kinds = [
        [Value::Bool(true), Value::Bool(false)],
        [Value::Int(-3), Value::Int(4)],
        [Value::Float(0.5), Value::Float(f64::NAN)],
        [Value::Text("a".into()), Value::Text("b".into())],
        [Value::from([1_u8, 2]), Value::from([3_u8, 4])],
        [Value::from([0.5_f32]), Value::from([1.5_f32, 2.5])],
        [
            Value::Array(Array::zeros(DType::I16, [2, 1]).unwrap()),
            Value::Int(1),
        ],
        [Value::Tuple(vec![Value::Int(1)]), Value::Tuple(vec![])],
        [dict(Value::Int(1)), dict(Value::Bool(true))],
        [dict(dict(Value::Text("deep".into()))), Value::Dict(vec![])],
        [Value::Null, Value::Int(1)],
        [Value::Int(1), Value::Float(2.75)],
    ];
    let mut told = String::new();
    for [one, two] in &kinds {
        let with = |value: Option<&Value>, length| Informed {
            infos: value.iter().map(|value| ("of", (*value).clone())).collect(),
            length,
            steps: 0,
        };
        for (first, second, third) in [
            (Some(one), Some(two), None),
            (None, Some(two), Some(one)),
            (Some(one), None, Some(&Value::Bool(true))),
        ] {
            let envs = [with(first, 9), with(second, 2), with(third, 1)];
            writeln!(told, "{first:?}, {second:?}, {third:?}").unwrap();
            for mode in [
                Autoreset::NextStep,
                Autoreset::SameStep,
                Autoreset::Disabled,
            ] {
                let envs = SyncVectorEnv::new(envs.clone()).unwrap();
                let mut envs = envs.with_autoreset(mode);
                let mut columns = envs.columns().unwrap();
                envs.reset_into(&0.into(), &mut columns).unwrap();
                if mode == Autoreset::NextStep {
                    writeln!(told, "  reset: {:?}", envs.infos(&columns)).unwrap();
                    let second = VectorReset::default().mask(vec![false, true, false]);
                    envs.reset_into(&second, &mut columns).unwrap();
                    writeln!(told, "  the second: {:?}", envs.infos(&columns)).unwrap();
                }
                envs.step_into(&Value::from([0_i64; 3]), &mut columns)
                    .unwrap();
                writeln!(told, "  {mode:?}: {:?}", envs.infos(&columns)).unwrap();
            }
        }
    }
    keep("infos.txt", &told);
}

/// JSON has no infinity: texts stand for what is not finite, wherever it is.
#[test]
fn numbers_that_are_not_finite_are_texts_in_plain_json() {
    for (number, json) in [
        (f64::INFINITY, json!("inf")),
        (f64::NEG_INFINITY, json!("-inf")),
        (f64::NAN, json!("NaN")),
        (-0.5, json!(-0.5)),
    ] {
        let values = [Value::Float(number), Value::from([0.25, number])];
        let expected = [json.clone(), json!([0.25, json])];
        for (value, expected) in values.iter().zip(&expected) {
            assert_eq!(value.to_json(), *expected);
            let tuple = Value::Tuple(vec![Value::Null, value.clone()]);
            assert_eq!(tuple.to_json(), json!([null, expected]));
            let dict = Value::Dict(vec![("a".into(), value.clone())]);
            assert_eq!(dict.to_json(), json!({ "a": expected }));
            let chosen = Value::OneOf(1, Box::new(value.clone()));
            assert_eq!(chosen.to_json(), json!([1, expected]));
        }
    }
}

/// A step beyond the limit is truncated as well, until the next reset; so does a clone and what is restored.
#[test]
fn every_step_beyond_a_limit_is_truncated() {
    let endless = Informed {
        infos: vec![],
        length: 0,
        steps: 0,
    };
    let mut env = TimeLimit::new(endless, 3).unwrap();
    for _ in 0..2 {
        env.reset(0).unwrap();
        for step in 1..7 {
            let mut clone = env.clone();
            for env in [&mut env, &mut clone] {
                let outcome = env.step(&0).unwrap();
                assert_eq!(outcome.truncated, step >= 3, "step {step}");
                assert!(!outcome.terminated);
                assert_eq!((env.elapsed_steps(), env.max_episode_steps()), (step, 3));
            }
        }
    }
}

/// JSON with one part changed, each with its place: another kind in its place, and a part more, a part less, or two in
/// the other order.
fn damages(place: &str, json: &Json, list: &mut Vec<(String, Json)>) {
    let mut add = |what: String, damaged: Json| list.push((format!("{place} {what}"), damaged));
    for other in [
        json!(null),
        json!(-1),
        json!(1.5),
        json!("x"),
        json!([]),
        json!({}),
    ] {
        add(format!("is {other}"), other);
    }
    match json {
        Json::Array(items) => {
            let [mut less, mut more, mut turned] = [(); 3].map(|()| items.clone());
            if let Some(last) = less.pop() {
                more.push(last);
                turned.reverse();
                add("has a part less".into(), less.into());
                add("has a part more".into(), more.into());
                add("has its parts in reverse".into(), turned.into());
            }
        }
        Json::Object(entries) => {
            for (key, value) in entries {
                let [mut less, mut renamed] = [(); 2].map(|()| entries.clone());
                less.remove(key);
                renamed.remove(key);
                renamed.insert(format!("{key}x"), value.clone());
                add(format!("has no {key:?}"), less.into());
                add(format!("has {:?}", format!("{key}x")), renamed.into());
            }
            let mut more = entries.clone();
            more.insert("more".into(), json!(1));
            add("has more".into(), more.into());
        }
        _ => {}
    }
    let mut within = |key: String, part: &Json, put: &dyn Fn(Json) -> Json| {
        let mut parts = Vec::new();
        damages(&format!("{place}/{key}"), part, &mut parts);
        list.extend(
            parts
                .into_iter()
                .map(|(what, damaged)| (what, put(damaged))),
        );
    };
    match json {
        Json::Array(items) => {
            for (i, part) in items.iter().enumerate() {
                within(i.to_string(), part, &|damaged| {
                    let mut items = items.clone();
                    items[i] = damaged;
                    items.into()
                });
            }
        }
        Json::Object(entries) => {
            for (key, part) in entries {
                within(key.clone(), part, &|damaged| {
                    let mut entries = entries.clone();
                    entries[key] = damaged;
                    entries.into()
                });
            }
        }
        _ => {}
    }
}

/// The stored form of each kind of value with one part changed: another value, or what is wrong with it.
#[test]
fn a_stored_value_that_was_changed_is_read_or_told_as_recorded() {
    let mut told = String::new();
    for stored in [
        json!({"$float": "inf"}),
        json!({"$float32": [[0.5, "NaN"], [2.0, 3.0]]}),
        json!({"$uint8": "AAEC", "shape": [3, 1]}),
        json!({"$dict": [["b", 1], ["a", {"$float": "NaN"}]]}),
        json!({"$graph": [{"$int64": [1, 2]}, null, {"$uint8": [0]}]}),
        json!({"$one_of": [3, "text"]}),
        json!({"a": [true, 2]}),
    ] {
        let whole = serde_json::from_value::<Value>(stored.clone());
        writeln!(told, "{stored}: {}", whole.unwrap()).unwrap();
        let mut list = Vec::new();
        damages("", &stored, &mut list);
        for (what, damaged) in list {
            let read = serde_json::from_value::<Value>(damaged);
            let text = read.map_or_else(
                |error| error.to_string(),
                |value| format!("reads {value:?}"),
            );
            writeln!(told, "{what}: {text}").unwrap();
        }
    }
    keep("damaged_values.txt", &told);
}
