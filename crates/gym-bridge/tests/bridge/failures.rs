//! What goes wrong in Python is an error with its cause, and no worker stays behind.

use std::process::Command;

use gym_core::registry::EnvBuilder;
use gym_core::render::{RenderMode, Rendered};
use gym_core::{Env, EnvExt, Reset, Value, builder};

use crate::{MODULE, bad, bridge, has, is_running, pid, python, widens};

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
                "failures::what_goes_wrong_at_the_end_is_told",
                "--nocapture",
            ])
            .env(HANGS, hangs)
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && stderr.contains(told), "{stderr}");
    }
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
        let before = [env.observation_space(), env.action_space()];
        (env.step(&action).map(drop), before)
    };
    late("equal").0.unwrap();
    late("never").0.unwrap();
    for (what, words) in [("actions", "0.5"), ("observations", "2.0")] {
        let (step, [observations, actions]) = late(what);
        let error = step.unwrap_err().to_string();
        let before = format!("and were {observations} and {actions}. Change them in `reset`.");
        assert!(
            error.contains("the spaces changed in a step")
                && error.contains(words)
                && error.contains(&before),
            "{error}"
        );
    }
}
