//! Tests of the environment with a worker in Rust, so that they run without Python.

use std::io::{self, BufReader, Read, Write};
use std::os::fd::AsFd;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::{env, fs, process};

use gym_core::render::RenderMode;
use gym_core::{Array, Configure, Env, EnvExt, Error, Reset, Snapshot, Value};
use serde_json::{Value as Json, json};

use crate::wire::{Reader, write};
use crate::worker::Request;
use crate::{Config, PythonEnv};

/// The variable that makes [`worker`] serve an environment.
const SERVES: &str = "GYM_BRIDGE_TEST_SERVES";

/// The program that the tests use instead of Python: the test [`worker`], which replies on its
/// standard input, because the test harness writes to its standard output.
fn interpreter() -> PathBuf {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    let make = || {
        let test = env::current_exe().unwrap();
        let path = test.with_extension("worker.sh");
        let made = test.with_extension(format!("{}.sh", process::id()));
        let test = test.display();
        let script =
            format!("#!/bin/sh\n{SERVES}=1 exec '{test}' --exact fake::worker > /dev/null\n");
        fs::write(&made, script).unwrap();
        fs::set_permissions(&made, fs::Permissions::from_mode(0o755)).unwrap();
        fs::rename(&made, &path).unwrap();
        path
    };
    PATH.get_or_init(make).clone()
}

fn dict<const N: usize>(entries: [(&str, Value); N]) -> Value {
    Value::Dict(entries.map(|(key, value)| (key.to_owned(), value)).into())
}

fn text(text: &str) -> Value {
    Value::Text(text.to_owned())
}

fn number(n: i64, start: i64) -> Value {
    let (n, start) = (Value::Int(n), Value::Int(start));
    dict([("kind", text("Discrete")), ("n", n), ("start", start)])
}

/// An environment that observes the number of its steps, and whose info has the last action.
#[derive(Default)]
struct Served {
    steps: i64,
    limit: i64,
}

impl Served {
    fn about(&self) -> Value {
        let bound = |bound: f32| Value::Array(Array::from([bound; 2]));
        let action = dict([
            ("kind", text("Box")),
            ("low", bound(-1.0)),
            ("high", bound(1.0)),
            ("shape", Value::Tuple(vec![Value::Int(2)])),
        ]);
        dict([
            ("name", text("Served")),
            ("spaces", Value::Tuple(vec![number(1 << 20, 0), action])),
            (
                "render_modes",
                Value::Tuple(
                    ["human", "rgb_array", "rgb_array_list", "other"]
                        .map(text)
                        .into(),
                ),
            ),
            ("render_fps", Value::Int(self.limit)),
        ])
    }

    /// The bytes of a reply.
    fn answer(&mut self, request: u8, values: &[Value]) -> Vec<u8> {
        let mut out = vec![0];
        let is = |asked: Request| request == asked as u8;
        if is(Request::Make) {
            let asked: Json = serde_json::from_str(values[0].as_text().unwrap()).unwrap();
            self.limit = asked["make_kwargs"]["limit"].as_i64().unwrap_or(-1);
            write(&self.about(), &mut out);
        } else if is(Request::Reset) {
            self.steps = 0;
            let seed = ("seed", values[0].clone());
            let told = dict([seed, ("options", values[1].clone())]);
            for value in [Value::Null, Value::Int(self.steps), told] {
                write(&value, &mut out);
            }
        } else if is(Request::Step) {
            self.steps += 1;
            out.extend(0.5_f64.to_le_bytes());
            out.extend([
                u8::from(self.steps == 9),
                u8::from(self.steps == self.limit),
            ]);
            write(&Value::Int(self.steps), &mut out);
            write(&dict([("action", values[0].clone())]), &mut out);
        } else if is(Request::Dump) {
            let (steps, limit) = (Value::Int(self.steps), Value::Int(self.limit));
            write(&Value::Tuple(vec![steps, limit]), &mut out);
        } else if is(Request::Load) {
            let [steps, limit] = values[1].as_tuple().unwrap() else {
                panic!("{values:?}");
            };
            (self.steps, self.limit) = (steps.as_int().unwrap(), limit.as_int().unwrap());
            write(&self.about(), &mut out);
        } else {
            assert!(is(Request::Close), "{request}");
        }
        out
    }
}

/// Serves an environment, in a process that a test has started.
#[test]
fn worker() {
    if env::var_os(SERVES).is_none() {
        return;
    }
    let pipe = io::stdin().as_fd().try_clone_to_owned().unwrap();
    let mut pipe = BufReader::new(UnixStream::from(pipe));
    let (mut served, mut length) = (Served::default(), [0; 4]);
    while pipe.read_exact(&mut length).is_ok() {
        let mut reader = Reader::new(&mut pipe, u32::from_le_bytes(length).into());
        let request = reader.byte().unwrap();
        let mut values = Vec::new();
        while !reader.is_done() {
            values.push(reader.value().unwrap());
        }
        let reply = served.answer(request, &values);
        let mut frame = (reply.len() as u32).to_le_bytes().to_vec();
        frame.extend(reply);
        pipe.get_mut().write_all(&frame).unwrap();
        if request == Request::Close as u8 {
            return;
        }
    }
}

fn config(limit: i64) -> Config {
    let kwargs = json!({ "limit": limit });
    Config {
        env_id: Some("Served-v0".into()),
        make_kwargs: kwargs.as_object().unwrap().clone(),
        python: Some(interpreter()),
        allow_pickle: true,
        ..Config::default()
    }
}

fn served(limit: i64) -> PythonEnv {
    PythonEnv::configure(config(limit), 0).unwrap()
}

fn action() -> Value {
    Value::from([0.5_f32, -0.5])
}

#[test]
fn calls_and_answers_arrive_whole() {
    let mut env = served(2);
    assert_eq!(env.describe(), "Served");
    assert_eq!(env.observation_space().to_string(), "Discrete(1048576)");
    assert_eq!(
        env.action_space().to_string(),
        "Box(-1.0, 1.0, (2,), float32)"
    );
    let reset = Reset::seed(7_u64).option("low", 1);
    assert_eq!(env.reset(reset).unwrap(), Value::Int(0));
    let info = env.info_map();
    assert_eq!(
        (&info["seed"], &info["options"]),
        (&text("7"), &text(r#"{"low":1}"#))
    );
    for steps in 1..=9 {
        let step = env.step(&action()).unwrap();
        assert_eq!((step.observation, step.reward), (Value::Int(steps), 0.5));
        assert_eq!((step.terminated, step.truncated), (steps == 9, steps == 2));
        assert_eq!(env.info_map()["action"], action());
    }
}

/// A clone and a restored environment continue from the state of the original, even before a reset.
#[test]
fn clones_and_snapshots_are_where_the_environment_is() {
    let is_needed =
        |env: &mut PythonEnv| matches!(env.step(&action()), Err(Error::ResetNeeded("step")));
    let copies = |env: &PythonEnv| {
        let mut restored = served(-1);
        restored.reset(0).unwrap();
        restored.restore(&env.snapshot().unwrap()).unwrap();
        [env.clone(), restored]
    };
    let mut env = served(-1);
    assert!(is_needed(&mut env));
    assert!(copies(&env).iter_mut().all(is_needed));
    env.reset(0).unwrap();
    for steps in 1..4 {
        env.step(&action()).unwrap();
        for mut copy in copies(&env) {
            assert_eq!(copy.info_map(), env.info_map());
            let step = copy.step(&action()).unwrap();
            assert_eq!(step.observation, Value::Int(steps + 1));
        }
    }
    env.close();
    assert!(matches!(
        env.clone().step(&action()),
        Err(Error::Closed("step"))
    ));
    assert!(matches!(env.snapshot(), Err(Error::Closed("snapshot"))));
}

/// A refused snapshot changes nothing.
#[test]
fn a_snapshot_of_other_arguments_is_refused() {
    let mut env = served(3);
    env.reset(0).unwrap();
    env.step(&action()).unwrap();
    let before = env.snapshot().unwrap();
    let spoilt = |place: &str, value: Json| -> Snapshot {
        let mut state = json!(before);
        *state.pointer_mut(place).expect(place) = value;
        serde_json::from_value(state).unwrap()
    };
    for (snapshot, reason) in [
        (served(2).snapshot().unwrap(), "with other arguments"),
        (
            spoilt("/config/timeout", json!(9.0)),
            "with other arguments",
        ),
        (spoilt("/config", json!({})), "cannot restore"),
        (spoilt("/pickle", json!("x")), "ended during `unpickle`"),
    ] {
        let error = env.restore(&snapshot).unwrap_err();
        assert!(matches!(error, Error::Snapshot(_)), "{error}");
        assert!(error.to_string().contains(reason), "{error}");
        assert_eq!(env.snapshot().unwrap(), before, "{reason}");
    }
    env.restore(&before).unwrap();
    let unsafe_config = Config {
        allow_pickle: false,
        ..config(3)
    };
    let mut env = PythonEnv::configure(unsafe_config, 0).unwrap();
    for error in [env.snapshot().map(drop), env.restore(&before)] {
        let error = error.unwrap_err().to_string();
        assert!(error.contains("allow_pickle"), "{error}");
    }
}

#[test]
fn actions_that_do_not_fit_never_reach_the_worker() {
    let tuple = |numbers: &[f64]| Value::Tuple(numbers.iter().map(|x| Value::Float(*x)).collect());
    let mut env = served(-1);
    env.reset(0).unwrap();
    for action in [
        Value::from([0.5_f32]),
        Value::from([0.5_f32; 3]),
        Value::from([0.5_f32, f32::NAN]),
        tuple(&[]),
        tuple(&[0.5]),
        tuple(&[0.5; 3]),
        tuple(&[0.5, f64::INFINITY]),
        Value::Tuple(vec![Value::Float(0.5), text("x")]),
        Value::Int(1),
        Value::Null,
    ] {
        let error = env.step(&action).unwrap_err();
        assert!(
            matches!(error, Error::InvalidAction { .. }),
            "{action}: {error}"
        );
    }
    // the bridge does not check bounds, and numbers keep their type
    for (steps, action) in [
        Value::from([7.0_f32, -7.0]),
        Value::from([0.1_f64, 0.2]),
        Value::from([1_i64, 0]),
        tuple(&[0.1, -9.0]),
    ]
    .into_iter()
    .enumerate()
    {
        let step = env.step(&action).unwrap();
        assert_eq!(step.observation, Value::Int(steps as i64 + 1));
        assert_eq!(env.info_map()["action"], action);
    }
}

/// The metadata leaves out render modes that the bridge does not support. An invalid frame rate is
/// replaced by 30.
#[test]
fn metadata_is_that_of_the_worker() {
    for (limit, fps) in [(7, 7), (-1, 30), (i64::MAX, 30)] {
        let metadata = served(limit).metadata();
        assert_eq!(
            metadata.render_modes,
            [RenderMode::Human, RenderMode::RgbArray]
        );
        assert_eq!(metadata.render_fps, fps);
    }
}
