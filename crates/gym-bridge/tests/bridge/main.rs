//! Environments of a real Python with gymnasium: `GYM_BRIDGE_PYTHON`, or else `python3`. Without
//! gymnasium, the tests print a note and pass.

use std::path::Path;
use std::process::Command;

use gym_bridge as _;
use gym_core::registry::EnvBuilder;
use gym_core::render::{RenderMode, Rendered};
use gym_core::vector::{Columns, VectorKind};
use gym_core::{BoxEnv, Env, EnvExt, Reset, Value, builder};

const MODULE: &str = "tests.python.envs";

fn python() -> String {
    std::env::var("GYM_BRIDGE_PYTHON").unwrap_or_else(|_| "python3".into())
}

/// Whether Python can import all `modules`. If not, prints the missing modules.
fn has(modules: &[&str]) -> bool {
    let import = format!("import {}", modules.join(", "));
    let there = Command::new(python())
        .args(["-W", "ignore", "-c", &import])
        .output()
        .is_ok_and(|output| output.status.success());
    if !there {
        println!(
            "SKIPPED: `{}` has not all of {}",
            python(),
            modules.join(", ")
        );
    }
    there
}

fn bridge(env_id: &str) -> EnvBuilder {
    builder("GymV26Environment-v0")
        .arg("env_id", env_id)
        .arg("python", python())
        .arg("backend", "gymnasium")
}

fn bad() -> EnvBuilder {
    bridge("bridge/Bad-v0").arg("module", MODULE)
}

fn echo(kind: &str) -> EnvBuilder {
    bridge("bridge/Echo-v0")
        .arg("module", MODULE)
        .arg("make_kwargs", serde_json::json!({"kind": kind}))
}

fn is_running(pid: i64) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    status
        .lines()
        .any(|line| line.starts_with("State:") && !line.contains('Z'))
}

/// Returns the process id of an environment of the kind `Bad`.
fn pid(env: &BoxEnv) -> i64 {
    env.info_map()["pid"].as_int().expect("a number")
}

#[test]
fn what_is_missing_is_told() {
    let error = |builder: EnvBuilder| builder.build().expect_err("it cannot be made").to_string();
    let make = || builder("GymV26Environment-v0");
    assert!(
        error(make()).contains("`env_id` is missing"),
        "{}",
        error(make())
    );
    let no_python = error(
        make()
            .arg("env_id", "CartPole-v1")
            .arg("python", "/nonexistent/python"),
    );
    assert!(
        no_python.contains("`/nonexistent/python` cannot be run")
            && no_python.contains("install Python"),
        "{no_python}"
    );
    let backend = error(make().arg("env_id", "CartPole-v1").arg("backend", "jym"));
    assert!(
        backend.contains("choose \"gym\" or \"gymnasium\""),
        "{backend}"
    );
    let timeout = error(make().arg("env_id", "CartPole-v1").arg("timeout", -1.0));
    assert!(timeout.contains("`timeout` is -1"), "{timeout}");
    if has(&["numpy"]) {
        let module = error(
            make()
                .arg("env_id", "X-v0")
                .arg("python", python())
                .arg("module", "no_such_module"),
        );
        assert!(module.contains("pip install no-such-module"), "{module}");
    }
    if has(&["gymnasium"]) {
        let unknown = error(bridge("NoSuchEnv-v0"));
        assert!(
            unknown.contains("raised NameNotFound in `make`") && unknown.contains("NoSuchEnv"),
            "{unknown}"
        );
    }
}

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
    ] {
        let mut env = echo(kind)
            .build()
            .unwrap_or_else(|error| panic!("{kind}: {error}"));
        // the same sampler gives the same first element in Rust and in Python
        let first = env
            .reset(42)
            .unwrap_or_else(|error| panic!("{kind}: {error}"));
        let mut actions = env.action_sampler(42).unwrap();
        if !kind.starts_with("graph") {
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
    env.reset(0).unwrap();
    let Rendered::Frame(frame) = env.render().unwrap() else {
        panic!("a frame")
    };
    assert_eq!(
        (frame.width(), frame.height(), frame.pixels()[0]),
        (6, 4, 9)
    );
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

#[test]
fn what_goes_wrong_in_python_is_an_error() {
    if !has(&["gymnasium"]) {
        return;
    }
    let mut env = bad().build().unwrap();
    assert!(matches!(
        env.step(&Value::Int(0)),
        Err(gym_core::Error::ResetNeeded(_))
    ));
    env.reset(0).unwrap();
    let raised = env.step(&Value::Int(1)).unwrap_err().to_string();
    assert!(
        raised.contains("raised ValueError in `step`: it does not like 1")
            && raised.contains("envs.py:"),
        "{raised}"
    );
    assert!(
        env.step(&Value::Int(4))
            .unwrap_err()
            .to_string()
            .contains("sys.exit(1)")
    );
    assert_eq!(
        env.step(&Value::Int(0)).unwrap().observation,
        Value::Int(0),
        "after an exception it goes on"
    );
    for _ in 0..2 {
        let grown = env
            .reset(Reset::default().option("grow", true))
            .unwrap_err()
            .to_string();
        assert!(
            grown.contains("Box(0.0, 1.0, (3,), float32)")
                && grown.contains("and were Discrete(2)"),
            "{grown}"
        );
    }
    let long = bridge("bridge/Large-v0").arg("module", MODULE);
    let long = long
        .arg(
            "make_kwargs",
            serde_json::json!({"mebibytes": 1, "dtype": "longdouble"}),
        )
        .build();
    let long = long.unwrap_err().to_string();
    assert!(
        long.contains("a box of float128 is not supported") || long.contains("a box of longdouble"),
        "{long}"
    );

    for (action, expected) in [(2, "exit status: 7"), (5, "signal: 11")] {
        let mut env = bad().build().unwrap();
        env.reset(0).unwrap();
        for _ in 0..2 {
            let ended = env.step(&Value::Int(action)).unwrap_err().to_string();
            assert!(
                ended.contains("the worker of `bridge/Bad-v0` ended during `step`"),
                "{ended}"
            );
            assert!(
                ended.contains(expected) && ended.contains("make the environment anew"),
                "{ended}"
            );
        }
    }
}

#[test]
fn odd_results_are_named_and_the_worker_lives() {
    if !has(&["gymnasium"]) {
        return;
    }
    let mut env = bridge("bridge/Odd-v0")
        .arg("module", MODULE)
        .build()
        .unwrap();
    let first = env.reset(0).unwrap();
    let said = [
        "the reward is '1.0' of type str: it must be a number",
        "the reward is None of type NoneType",
        "terminated is 'no' of type str: it must be True or False",
        "the info is [1] of type list: it must be a dict",
        "it must return observation, reward, terminated, truncated and info",
        "raised KeyboardInterrupt in `step`",
        "raised GeneratorExit in `step`",
        "raised Mute in `step`: (a Mute whose str fails with RuntimeError)",
        "... (5000000 characters)",
        "raised KeyboardInterrupt in `step`",
        "the environment called sys.exit(Mute())",
        "the observation 1 is not an element of",
        "the reply has 1073",
    ];
    for (action, expected) in (0..).zip(said) {
        let error = env.step(&Value::Int(action)).unwrap_err().to_string();
        assert!(error.contains(expected) && error.len() < 3000, "{error}");
    }
    // Ctrl+C between two requests
    let interrupt = Command::new("kill")
        .args(["-INT", &pid(&env).to_string()])
        .status()
        .unwrap();
    assert!(interrupt.success());
    assert!(
        env.step(&Value::Int(13)).is_ok(),
        "an entry without a name is left out"
    );
    assert!(env.info_map().is_empty());
    // the environment drew the first number of the space's generator, so this is the second
    let step = env.step(&Value::Int(14)).unwrap();
    assert_eq!(
        (step.reward, step.terminated, step.truncated),
        (0.5, true, false)
    );
    assert_eq!(env.reset(0).unwrap(), first);
    assert_eq!(
        env.step(&Value::Int(14)).unwrap().observation,
        step.observation
    );
    let error = env
        .reset(Reset::default().option("alone", true))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("`reset` returned 'alone': it must return observation and info"),
        "{error}"
    );
}

#[test]
fn observations_beyond_their_space_are_named() {
    if !has(&["gymnasium"]) {
        return;
    }
    for (kind, count) in [
        ("Discrete", 3),
        ("Box", 7),
        ("Text", 2),
        ("Tuple", 4),
        ("Dict", 4),
        ("Graph", 2),
        ("OneOf", 3),
    ] {
        let env = bridge("bridge/Observes-v0").arg("module", MODULE);
        let mut env = env
            .arg("make_kwargs", serde_json::json!({"kind": kind}))
            .build()
            .unwrap();
        env.reset(0).unwrap();
        for action in 0..count {
            let error = env.step(&Value::Int(action)).expect_err(kind).to_string();
            let is_named = error.contains("is not an element of")
                || error.contains("an observation has the shape");
            assert!(
                is_named && !error.contains("raised"),
                "{kind} {action}: {error}"
            );
        }
    }
}

fn lies(fault: &str) -> EnvBuilder {
    bridge("bridge/Lies-v0")
        .arg("module", MODULE)
        .arg("make_kwargs", serde_json::json!({"fault": fault}))
}

/// The error names the space, and the reason.
#[test]
fn spaces_that_cannot_be_read_are_named() {
    if !has(&["gymnasium"]) {
        return;
    }
    for (fault, words) in [
        (
            "no action space",
            ["the action space", "the space None is not supported"],
        ),
        ("n", ["the observation space", "cannot be read: ValueError"]),
        (
            "keys",
            ["the observation space: the key 0", "it must be a text"],
        ),
        ("size", ["the observation space", "memory"]),
        ("bounds", ["the action space", "nan"]),
    ] {
        let error = lies(fault).build().unwrap_err().to_string();
        let is_named = words
            .iter()
            .all(|word| error.to_lowercase().contains(&word.to_lowercase()));
        assert!(
            is_named && error.contains("cannot be run"),
            "{fault}: {error}"
        );
    }
    lies("metadata").build().unwrap().reset(0).unwrap();
}

/// A space that a step changes in place is an error, although the Python object is the same.
#[test]
fn a_space_that_a_step_changes_in_its_place_is_an_error() {
    if !has(&["gymnasium"]) {
        return;
    }
    for (fault, words) in [
        ("in place", "Discrete(5)"),
        ("action in place", "Discrete(2)"),
    ] {
        let mut env = lies(fault).build().unwrap();
        env.reset(0).unwrap();
        let error = env.step(&Value::Int(0)).unwrap_err().to_string();
        assert!(
            error.contains("the spaces changed in a step") && error.contains(words),
            "{fault}: {error}"
        );
    }
}

/// An info that contains itself, or that repeats its parts very often, is an error before the
/// timeout.
#[test]
fn an_endless_info_is_an_error() {
    if !has(&["gymnasium"]) {
        return;
    }
    for fault in ["cycle", "double"] {
        let mut env = lies(fault).arg("timeout", 30.0).build().unwrap();
        env.reset(0).unwrap();
        let error = env.step(&Value::Int(0)).unwrap_err().to_string();
        assert!(
            error.contains("the info") && error.contains("more than 1000000 parts"),
            "{fault}: {error}"
        );
        env.reset(0).unwrap();
    }
}

/// A process that the environment forks must not answer instead of the worker.
#[test]
fn only_the_worker_answers() {
    if !has(&["gymnasium"]) {
        return;
    }
    for fault in ["fork", "fork quietly"] {
        let mut env = lies(fault).arg("timeout", 30.0).build().unwrap();
        env.reset(0).unwrap();
        for steps in 1..5 {
            env.step(&Value::Int(0)).unwrap();
            assert_eq!(env.info_map()["steps"], Value::Int(steps), "{fault}");
        }
    }
}

#[test]
fn a_number_that_becomes_infinite_is_named() {
    if !has(&["gymnasium"]) {
        return;
    }
    let mut env = lies("precision").build().unwrap();
    env.reset(0).unwrap();
    let error = env.step(&Value::Int(0)).unwrap_err().to_string();
    assert!(
        error.contains("it holds numbers that float32 cannot represent"),
        "{error}"
    );
}

#[test]
fn pictures_of_another_kind_are_named() {
    if !has(&["gymnasium"]) {
        return;
    }
    for (fault, mode, words) in [
        (
            "text",
            RenderMode::RgbArray,
            "rendered a text in the mode rgb_array",
        ),
        (
            "nothing",
            RenderMode::RgbArray,
            "rendered nothing in the mode rgb_array",
        ),
        (
            "nothing",
            RenderMode::Ansi,
            "rendered nothing in the mode ansi: it must be a text",
        ),
        (
            "array",
            RenderMode::Ansi,
            "rendered an array in the mode ansi",
        ),
        (
            "empty",
            RenderMode::RgbArray,
            "with shape [0, 3, 3] in the mode rgb_array: a frame is uint8",
        ),
    ] {
        let mut env = lies(fault).render_mode(mode).build().unwrap();
        env.reset(0).unwrap();
        let error = env.render().unwrap_err().to_string();
        assert!(error.contains(words), "{fault}: {error}");
    }
    let mut env = lies("text").render_mode(RenderMode::Ansi).build().unwrap();
    env.reset(0).unwrap();
    assert!(matches!(env.render().unwrap(), Rendered::Text(text) if text == "a text"));
}

/// An error in `drop` is printed to standard error, which the test reads from a child process.
#[test]
fn what_goes_wrong_at_the_end_is_told() {
    const HANGS: &str = "GYM_BRIDGE_TEST_HANGS";
    if !has(&["gymnasium"]) {
        return;
    }
    if let Ok(hangs) = std::env::var(HANGS) {
        let env = bridge("bridge/Odd-v0").arg("module", MODULE);
        drop(
            env.arg("make_kwargs", serde_json::json!({"hangs": hangs == "true"}))
                .build()
                .unwrap(),
        );
        return;
    }
    for (hangs, told) in [
        ("false", "raised OSError in `close`: it does not close"),
        ("true", "did not answer `close` within 2 s and was ended\n"),
    ] {
        let output = Command::new(std::env::current_exe().unwrap())
            .args([
                "--exact",
                "what_goes_wrong_at_the_end_is_told",
                "--nocapture",
            ])
            .env(HANGS, hangs)
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && stderr.contains(told), "{stderr}");
    }
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
    let script = include_str!("../src/worker.py");
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

#[test]
fn a_worker_that_hangs_is_ended() {
    if !has(&["gymnasium"]) {
        return;
    }
    let mut env = bad().arg("timeout", 10.0).build().unwrap();
    env.reset(0).unwrap();
    let worker = pid(&env);
    let error = env.step(&Value::Int(3)).unwrap_err().to_string();
    assert!(
        error.contains("did not answer `step` within 10 s") && error.contains("`timeout`"),
        "{error}"
    );
    assert!(!is_running(worker));
}

#[test]
fn no_worker_outlives_its_environment() {
    if !has(&["gymnasium"]) {
        return;
    }
    let mut env = bad().build().unwrap();
    env.reset(0).unwrap();
    let mut clone = env.clone();
    clone.reset(0).unwrap();
    let (first, second) = (pid(&env), pid(&clone));
    assert_ne!(first, second, "a clone is a process of its own");
    assert!(is_running(first) && is_running(second));
    env.close();
    assert!(!is_running(first) && is_running(second));
    assert!(matches!(
        env.step(&Value::Int(0)),
        Err(gym_core::Error::Closed(_) | gym_core::Error::ResetNeeded(_))
    ));
    drop(clone);
    assert!(!is_running(second));
}

#[test]
fn clones_and_snapshots_continue() {
    if !has(&["gymnasium"]) {
        return;
    }
    let make = || {
        bridge("CartPole-v1")
            .arg("allow_pickle", true)
            .build()
            .unwrap()
    };
    let mut env = make();
    env.reset(7).unwrap();
    env.step(&Value::Int(1)).unwrap();
    let (mut clone, snapshot) = (env.clone(), env.snapshot().unwrap());
    let mut restored = make();
    restored.restore(&snapshot).unwrap();
    for action in [0, 1, 1, 0, 1] {
        let step = env.step(&Value::Int(action)).unwrap();
        assert_eq!(clone.step(&Value::Int(action)).unwrap(), step);
        assert_eq!(restored.step(&Value::Int(action)).unwrap(), step);
    }
    let refused = bridge("CartPole-v1")
        .build()
        .unwrap()
        .snapshot()
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("restoring runs code") && refused.contains("allow_pickle"),
        "{refused}"
    );
}

/// Returns an environment that counts its steps in its info, without the wrappers of Python's
/// `make`.
fn widens(start: i64) -> EnvBuilder {
    let env = bridge("bridge/Widens-v0")
        .arg("module", MODULE)
        .arg("allow_pickle", true);
    let env = env.arg("make_kwargs", serde_json::json!({ "start": start }));
    env.order_enforce(false).disable_env_checker(true)
}

#[test]
fn clones_and_snapshots_tell_the_last_info() {
    if !has(&["gymnasium"]) {
        return;
    }
    let action = Value::from([0.5_f32, -0.5]);
    let steps = |env: &BoxEnv| env.info_map().get("steps").cloned();
    let mut env = widens(3).build().unwrap();
    assert!(
        matches!(
            env.clone().step(&action),
            Err(gym_core::Error::ResetNeeded(_))
        ),
        "nor does a clone"
    );
    env.reset(0).unwrap();
    env.step(&action).unwrap();
    assert_eq!(steps(&env), Some(Value::Int(4)));
    let snapshot = env.snapshot().unwrap();
    let mut restored = widens(3).build().unwrap();
    assert!(matches!(
        restored.step(&action),
        Err(gym_core::Error::ResetNeeded(_))
    ));
    restored.restore(&snapshot).unwrap();
    for mut env in [env.clone(), restored] {
        assert_eq!(steps(&env), Some(Value::Int(4)), "before a step of its own");
        env.step(&action).unwrap();
        assert_eq!(steps(&env), Some(Value::Int(5)));
    }
    let refused = widens(2)
        .build()
        .unwrap()
        .restore(&snapshot)
        .unwrap_err()
        .to_string();
    assert!(refused.contains("with other arguments"), "{refused}");
    env.close();
    assert!(matches!(
        env.restore(&snapshot),
        Err(gym_core::Error::Closed("restore"))
    ));
}

#[test]
fn actions_that_do_not_fit_never_reach_python() {
    if !has(&["gymnasium"]) {
        return;
    }
    let mut env = widens(0).build().unwrap();
    env.reset(0).unwrap();
    let tuple = |numbers: &[f64]| Value::Tuple(numbers.iter().map(|x| Value::Float(*x)).collect());
    for action in [
        Value::from([0.5_f32]),
        Value::from([0.5_f32; 3]),
        Value::from([0.5_f32, f32::NAN]),
        tuple(&[0.5]),
        tuple(&[0.5, f64::INFINITY]),
        Value::Int(1),
        Value::Null,
    ] {
        let error = env.step(&action).unwrap_err();
        assert!(
            matches!(error, gym_core::Error::InvalidAction { .. }),
            "{action}: {error}"
        );
    }
    assert_eq!(env.info_map()["steps"], Value::Int(0), "none was a step");
    env.step(&tuple(&[0.5, -7.0])).unwrap();
    assert_eq!(
        env.info_map()["steps"],
        Value::Int(1),
        "bounds are Python's to enforce"
    );
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

/// Agents read the spaces once in an episode: a step that changes them is an error. A new object
/// with an equal space is allowed.
#[test]
fn spaces_that_change_in_a_step_are_an_error() {
    if !has(&["gymnasium"]) {
        return;
    }
    let action = Value::from([0.5_f32, 0.5]);
    let late = |what: &str| {
        let mut env = widens(0).build().unwrap();
        env.reset(Reset::default().option("late", what)).unwrap();
        env.step(&action).unwrap();
        env.step(&action).map(drop)
    };
    late("equal").unwrap();
    late("never").unwrap();
    for (what, words) in [("actions", "0.5"), ("observations", "2.0")] {
        let error = late(what).unwrap_err().to_string();
        assert!(
            error.contains("the spaces changed in a step") && error.contains(words),
            "{error}"
        );
    }
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

/// Episodes of gym 0.26, minigrid, highway-env and ale-py, recorded in Python.
#[test]
fn recorded_episodes_come_out_equal() {
    if !has(&["numpy"]) {
        return;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference");
    let mut compared = 0;
    for entry in std::fs::read_dir(folder).expect("the recordings") {
        let path = entry.expect("readable").path();
        let trace: serde_json::Value =
            serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        let text = |key: &str| trace[key].as_str().map(str::to_owned);
        let backend = text("backend").expect("a library");
        let modules: Vec<String> = [Some(backend.clone()), text("module")]
            .into_iter()
            .flatten()
            .collect();
        if !has(&modules.iter().map(String::as_str).collect::<Vec<_>>()) {
            continue;
        }
        let mut env = builder("GymV26Environment-v0")
            .arg("env_id", text("id"))
            .arg("make_kwargs", trace["kwargs"].clone())
            .arg("backend", backend)
            .arg("module", trace["module"].clone())
            .arg("python", python())
            .build()
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        for (i, event) in trace["events"]
            .as_array()
            .expect("events")
            .iter()
            .enumerate()
        {
            let place = format!("{}, event {i}", path.display());
            let observation = match event.get("step") {
                None => env
                    .reset(event["reset"]["seed"].as_u64())
                    .unwrap_or_else(|error| panic!("{place}: {error}")),
                Some(action) => {
                    let action = env.action_space().from_json(action).unwrap();
                    let step = env
                        .step(&action)
                        .unwrap_or_else(|error| panic!("{place}: {error}"));
                    assert_eq!(Some(step.reward), event["reward"].as_f64(), "{place}");
                    assert_eq!(
                        Some(step.terminated),
                        event["terminated"].as_bool(),
                        "{place}"
                    );
                    assert_eq!(
                        Some(step.truncated),
                        event["truncated"].as_bool(),
                        "{place}"
                    );
                    step.observation
                }
            };
            assert!(
                is_recorded(&event["observation"], &observation),
                "{place}: {observation:?}"
            );
            let recorded = event["info"].as_object().expect("info");
            let info = env.info_map();
            for (key, value) in recorded
                .iter()
                .filter(|(key, _)| trace["info_same_twice"] == true || *key != "action")
            {
                let ours = info
                    .get(key)
                    .unwrap_or_else(|| panic!("{place}: info has no {key}"));
                assert!(
                    is_recorded(value, ours),
                    "{place}, info {key}: {ours:?} for {value}"
                );
            }
            assert_eq!(info.len(), recorded.len(), "{place}: {info:?}");
        }
        compared += 1;
    }
    println!("{compared} recorded environments compared");
}

/// Whether `value` equals `recorded`, which contains the numbers or, for a large array, a checksum.
fn is_recorded(recorded: &serde_json::Value, value: &Value) -> bool {
    use serde_json::Value as Json;
    match (recorded, value) {
        (Json::Object(map), Value::Array(array)) => {
            let bytes = array.as_slice::<u8>().expect("only pictures are large");
            map["crc32"].as_u64() == Some(crc32fast::hash(bytes).into())
        }
        (Json::Object(map), Value::Dict(entries)) => {
            map.len() == entries.len()
                && entries
                    .iter()
                    .all(|(key, value)| map.get(key).is_some_and(|json| is_recorded(json, value)))
        }
        (Json::Array(items), Value::Tuple(values)) => {
            items.len() == values.len()
                && items
                    .iter()
                    .zip(values)
                    .all(|(item, value)| is_recorded(item, value))
        }
        (Json::Array(_), Value::Array(array)) => {
            let mut flat = Vec::new();
            flatten(recorded, &mut flat);
            flat.len() == array.len()
                && flat
                    .iter()
                    .zip(array.iter_f64())
                    .all(|(a, b)| a.to_bits() == b.to_bits())
        }
        (Json::Bool(a), Value::Bool(b)) => a == b,
        (Json::Bool(a), Value::Int(b)) => i64::from(*a) == *b,
        (Json::Number(a), Value::Int(b)) => a.as_i64() == Some(*b),
        (Json::Number(a), Value::Float(b)) => a.as_f64().map(f64::to_bits) == Some(b.to_bits()),
        (Json::String(a), Value::Text(b)) => a == b,
        (Json::Null, Value::Null) => true,
        _ => false,
    }
}

fn flatten(json: &serde_json::Value, out: &mut Vec<f64>) {
    match json.as_array() {
        Some(items) => items.iter().for_each(|item| flatten(item, out)),
        None => out.extend(json.as_f64().or(match json.as_str() {
            Some("inf") => Some(f64::INFINITY),
            Some("-inf") => Some(f64::NEG_INFINITY),
            _ => None,
        })),
    }
}
