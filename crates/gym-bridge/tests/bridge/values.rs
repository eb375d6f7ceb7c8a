//! Observations, actions, seeds and spaces arrive as they were sent.

use std::process::Command;

use gym_core::render::{RenderMode, Rendered};
use gym_core::vector::{Columns, VectorKind};
use gym_core::{Env, EnvExt, Error, Reset, Space, Value};

use crate::{MODULE, bridge, echo, has, python, widens};

#[test]
fn elements_of_every_space_go_there_and_come_back() {
    if !has(&["gymnasium"]) {
        return;
    }
    for kind in [
        "box",
        "discrete",
        "multi_discrete",
        "multi_binary",
        "text",
        "tuple",
        "dict",
        "sequence",
        "graph",
        "graph_of_dicts",
        "one_of",
        "number",
        "picture",
        "several_bounds",
        "half_bounded",
        "shifted",
        "grid",
        "bits",
        "letters",
        "stacked",
        "stacked_arrays",
        "arrays",
        "nested",
        "nodes",
        "namesakes",
    ] {
        let mut env = echo(kind)
            .build()
            .unwrap_or_else(|error| panic!("{kind}: {error}"));
        // the same sampler gives the same first element in Rust and in Python
        let first = env
            .reset(42)
            .unwrap_or_else(|error| panic!("{kind}: {error}"));
        let mut actions = env.action_sampler(42).unwrap();
        if !(kind.starts_with("graph") || kind == "nodes") {
            assert_eq!(first, actions.sample(), "{kind}");
        }
        for _ in 0..20 {
            let action = actions.sample();
            let step = env
                .step(&action)
                .unwrap_or_else(|error| panic!("{kind}, {action:?}: {error}"));
            assert_eq!(step.observation, action, "{kind}");
            assert_eq!(
                (step.reward, step.terminated, step.truncated),
                (0.5, false, false)
            );
        }
        let info = env.info_map();
        // Python's own text of the space, whose arrays may be on several lines
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let theirs = info["space"].as_text().expect("a text");
        assert_eq!(words(&env.action_space().to_string()), words(theirs));
        assert_eq!(env.observation_space(), env.action_space(), "{kind}");
        let list = Value::Tuple(vec![Value::Int(1), Value::Float(2.5), Value::Null]);
        assert_eq!(info["nested"], Value::Dict(vec![("list".into(), list)]));
        let array = info["array"].as_array().expect("an array");
        assert_eq!(
            (array.shape(), array.as_slice::<f64>()),
            (&[2, 2][..], Some(&[1.0, 0.0, 0.0, 1.0][..]))
        );
    }
}

#[test]
fn seeds_and_options_arrive_whole() {
    if !has(&["gymnasium"]) {
        return;
    }
    let mut env = echo("discrete").build().unwrap();
    let seed = 1u128 << 100;
    env.reset(Reset::seed(gym_core::Seed::from_u128(seed)).option("low", vec![1, 2]))
        .unwrap();
    let info = env.info_map();
    assert_eq!(info["options"], Value::Text("{'low': [1, 2]}".into()));
    assert!(
        !info.contains_key("object") && !info.contains_key("seed"),
        "what has no form is left out: {info:?}"
    );
    assert!(matches!(
        env.step(&Value::Int(9)),
        Err(gym_core::Error::InvalidAction { .. })
    ));
}

#[test]
fn python_draws() {
    if !has(&["gymnasium"]) {
        return;
    }
    let mut env = echo("discrete")
        .render_mode(RenderMode::RgbArray)
        .build()
        .unwrap();
    assert_eq!(env.metadata().render_fps, 7);
    // recorders read the render mode
    assert_eq!(env.render_mode(), Some(RenderMode::RgbArray));
    assert_eq!(env.clone().render_mode(), Some(RenderMode::RgbArray));
    // a picture may be black
    for (seed, level) in [(0, 0), (9, 9)] {
        env.reset(seed).unwrap();
        let Rendered::Frame(frame) = env.render().unwrap() else {
            panic!("a frame")
        };
        assert_eq!((frame.width(), frame.height()), (6, 4));
        assert!(
            frame.pixels().iter().all(|pixel| *pixel == level),
            "{level}"
        );
    }
    let mut env = echo("discrete")
        .render_mode(RenderMode::Ansi)
        .build()
        .unwrap();
    env.reset(0).unwrap();
    assert!(matches!(env.render().unwrap(), Rendered::Text(text) if text == "a text"));
    let mut env = echo("discrete")
        .render_mode(RenderMode::RgbArrayList)
        .build()
        .unwrap();
    env.reset(0).unwrap();
    env.step(&Value::Int(0)).unwrap();
    assert_eq!(
        env.render()
            .unwrap()
            .into_frames()
            .map(|frames| frames.len()),
        Some(2)
    );
    let mut env = echo("discrete").build().unwrap();
    env.reset(0).unwrap();
    let error = env.render().unwrap_err().to_string();
    assert!(error.contains("made without a render mode"), "{error}");
}

/// An image is written from its array to the pipe without a copy; uniform bounds are sent as one
/// number.
#[test]
fn large_arrays_are_not_copied_in_the_worker() {
    if !has(&["gymnasium"]) {
        return;
    }
    let check = r#"
import sys
worker = {"__name__": "worker"}
exec(sys.argv[1], worker)
import numpy as np
from gymnasium import spaces
worker["np"] = np
space = spaces.Box(0, 255, (1024, 1024, 3), np.uint8)
server, Frame = worker["Server"](), worker["Frame"]
for picture in np.zeros((1024, 1024, 3), np.uint8), np.zeros((1024, 1024, 3), np.uint8)[::-1]:
    out = Frame(0)
    worker["element"](out, space, "Box", picture)
    worker["plain"](out, {"picture": picture, "left out": [picture, object()], "n": 1})
    parts = list(out.parts())
    memory = [len(part) for part in parts if isinstance(part, memoryview)]
    assert memory == [picture.nbytes] * 2 and sum(map(len, parts)) - sum(memory) < 100, memory
    assert sum(map(len, parts)) == 4 + int.from_bytes(parts[0][:4], "little")
    if picture.flags.c_contiguous:
        views = [np.frombuffer(part, np.uint8) for part in parts if isinstance(part, memoryview)]
        assert all(np.shares_memory(view, picture) for view in views)
out = Frame(0)
worker["plain"](out, worker["describe"](space))
assert out.size() < 200, out.size()
"#;
    let script = include_str!("../../src/worker.py");
    let output = Command::new(python())
        .args(["-c", check, script])
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn large_observations_arrive_whole() {
    if !has(&["gymnasium"]) {
        return;
    }
    for (dtype, bytes) in [("uint8", 1), ("float32", 4), ("float16", 2)] {
        let env = bridge("bridge/Large-v0").arg("module", MODULE);
        let kwargs = serde_json::json!({"mebibytes": 3, "dtype": dtype});
        let mut env = env.arg("make_kwargs", kwargs).build().unwrap();
        let mut observation = env.reset(0).unwrap();
        for step in 1..=3 {
            env.step_into(&Value::Int(0), &mut observation).unwrap();
            let array = observation.as_array().unwrap();
            assert_eq!(array.shape(), [3, 1024, 1024 / bytes]);
            let mut numbers = array.iter_f64();
            assert_eq!(numbers.next(), Some(7.0 + f64::from(step)));
            assert!(numbers.all(|x| x == 7.0));
        }
    }
}

#[test]
fn numbers_keep_their_precision() {
    if !has(&["gymnasium"]) {
        return;
    }
    let mut env = bridge("bridge/Half-v0")
        .arg("module", MODULE)
        .build()
        .unwrap();
    assert_eq!(env.reset(0).unwrap(), Value::Array([0.5_f32, -1.0].into()));
    for (action, dtype) in [
        (Value::Array([0.25_f32, 1.0].into()), "float32"),
        (Value::Array([0.25, 1.0].into()), "float64"),
        (
            Value::Tuple(vec![Value::Float(0.25), Value::Int(1)]),
            "float64",
        ),
    ] {
        assert_eq!(
            env.step(&action).unwrap().observation,
            Value::Array([0.25_f32, 1.0].into())
        );
        assert_eq!(env.info_map()["type"], Value::Text(dtype.into()));
    }
    for bad in [
        Value::Array([0.0, f64::NAN].into()),
        Value::Tuple(vec![Value::Null; 2]),
        Value::Int(1),
    ] {
        assert!(
            env.step(&bad)
                .unwrap_err()
                .to_string()
                .contains("invalid action")
        );
    }
    let error = env
        .step(&Value::Array([9.0, 0.0].into()))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("the observation array(['a', 'b']") && !error.contains("raised"),
        "{error}"
    );
}

/// An element of another space is no action, unless it is an array that Python would cast.
#[test]
fn actions_of_other_kinds_and_shapes_are_refused_before_they_are_sent() {
    if !has(&["gymnasium"]) {
        return;
    }
    let floats = |n: usize| Value::Tuple(vec![Value::Float(0.5); n]);
    let mut actions = vec![
        Value::Null,
        Value::Bool(true),
        Value::Float(0.5),
        Value::Int(99),
    ];
    actions.extend([floats(0), floats(1), floats(2), floats(3), floats(6)]);
    let row = |length: usize| Value::Array(vec![0.5; length].into());
    actions.extend([
        row(0),
        row(2),
        row(6),
        Value::Array([f64::INFINITY; 2].into()),
    ]);
    let kinds = [
        "box",
        "number",
        "picture",
        "half_bounded",
        "discrete",
        "shifted",
        "grid",
        "bits",
        "letters",
        "tuple",
        "dict",
        "sequence",
        "nested",
    ];
    let mut envs = kinds.map(|kind| echo(kind).build().unwrap());
    for env in &mut envs {
        env.reset(1).unwrap();
        actions.push(env.action_sampler(3).unwrap().sample());
    }
    for (kind, env) in kinds.iter().zip(&mut envs) {
        let space = env.action_space();
        for action in &actions {
            let fits = match (&space, action) {
                (Space::Box(space), Value::Array(array)) => {
                    let is_cast = space.dtype().is_float() || array.dtype() == space.dtype();
                    is_cast && array.shape() == space.shape() && array.is_finite()
                }
                (Space::Box(space), Value::Tuple(items)) => {
                    let is_float = |item: &Value| item.as_float().is_some();
                    space.dtype().is_float()
                        && space.shape() == [items.len()]
                        && items.iter().all(is_float)
                }
                (space, action) => space.contains(action),
            };
            match env.step(action) {
                Ok(_) => assert!(fits, "{kind} takes {action:?}"),
                Err(Error::InvalidAction { .. }) => assert!(!fits, "{kind} refuses {action:?}"),
                Err(error) => panic!("{kind}, {action:?}: {error}"),
            }
        }
    }
}

/// Bounds may change at a reset; shapes and dtypes may not.
#[test]
fn spaces_that_change_at_a_reset_are_those_of_python() {
    if !has(&["gymnasium"]) {
        return;
    }
    let mut env = widens(0).build().unwrap();
    assert_eq!(
        env.observation_space().to_string(),
        "Box(0.0, 1.0, (1,), float32)"
    );
    env.reset(Reset::default().option("wide", true)).unwrap();
    assert_eq!(
        env.observation_space().to_string(),
        "Box(0.0, 9.0, (1,), float32)"
    );
    let error = env
        .reset(Reset::default().option("actions", true))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("changed at the reset") && error.contains("Discrete(3)"),
        "{error}"
    );
    assert_eq!(
        env.action_space().to_string(),
        "Box(-1.0, 1.0, (2,), float32)"
    );
}

#[test]
fn vectors_run_in_parallel() {
    if !has(&["gymnasium"]) {
        return;
    }
    for kind in [VectorKind::Sync, VectorKind::Async] {
        let mut envs = bridge("CartPole-v1").vector(3).kind(kind).build().unwrap();
        let mut columns = Columns::default();
        envs.reset_into(&5.into(), &mut columns).unwrap();
        let mut alone = bridge("CartPole-v1").build().unwrap();
        let first = alone.reset(6).unwrap();
        let second_row = envs
            .single_observation_space()
            .iterate(&columns.observations)
            .unwrap()
            .nth(1);
        assert_eq!(second_row, Some(first));
    }
}
