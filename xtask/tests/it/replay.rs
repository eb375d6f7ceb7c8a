//! `replay` compares recordings, and writes answers.

use serde_json::Value as Json;

use super::{fails, folder, json, prints};

#[test]
fn replay_compares_and_writes() {
    let out = folder("replay");
    let trace = out.join("trace.json");
    let seed = "1427247692705959881058285969449495136382746631"; // 2^150 + 7
    let recorded = format!(
        r#"{{"id": "FrozenLake-v1", "kwargs": {{"is_slippery": false}}, "note": "kept", "events": [
            {{"reset": {{"seed": {seed}, "options": null}}, "observation": 0, "info": {{"prob": 1}}}},
            {{"step": 2, "observation": 1, "reward": 0.0, "terminated": false, "truncated": false, "info": {{"prob": 1.0}}}}
        ]}}"#
    );
    std::fs::write(&trace, &recorded).unwrap();
    prints(&["replay", trace.to_str().unwrap()]);

    let answers = out.join("answers");
    prints(&[
        "replay",
        "--out",
        answers.to_str().unwrap(),
        trace.to_str().unwrap(),
    ]);
    let text = std::fs::read_to_string(answers.join("trace.json")).unwrap();
    assert!(text.contains(seed), "the seed keeps its digits: {text}");
    assert_eq!(json(&answers.join("trace.json"))["note"], "kept");
    assert_eq!(text.matches("\"events\"").count(), 1, "{text}");
    prints(&["replay", answers.join("trace.json").to_str().unwrap()]);

    std::fs::write(
        &trace,
        recorded.replace(r#""observation": 1"#, r#""observation": 4"#),
    )
    .unwrap();
    let difference = fails(&["replay", trace.to_str().unwrap()]);
    assert!(
        difference.contains("event 1, observation: 1 for 4"),
        "{difference}"
    );
    std::fs::write(&trace, "[]").unwrap();
    assert!(fails(&["replay", trace.to_str().unwrap()]).contains("not a trace"));
    // nothing may follow a recording, of any kind
    let model = r#"{"model": "ant.xml", "xml": "<mujoco/>", "versions": {}, "seed": 0} {}"#;
    std::fs::write(&trace, model).unwrap();
    let arguments = [
        "replay",
        "--out",
        answers.to_str().unwrap(),
        trace.to_str().unwrap(),
    ];
    let error = fails(&arguments);
    assert!(error.contains("trailing characters"), "{error}");
}

/// The answers that `replay` writes contain the state of a MuJoCo task.
#[test]
fn replay_writes_the_state() {
    let out = folder("replay-state");
    let recorded = r#"{"id": "InvertedPendulum-v5", "events": [
        {"reset": {"seed": 1, "options": null}, "observation": [0, 0, 0, 0], "state": {"qpos": [0, 0], "qvel": [0, 0]}}
    ]}"#;
    let trace = out.join("trace.json");
    std::fs::write(&trace, recorded).unwrap();
    let answers = out.join("answers");
    prints(&[
        "replay",
        "--out",
        answers.to_str().unwrap(),
        trace.to_str().unwrap(),
    ]);
    let answer = &json(&answers.join("trace.json"))["events"][0];
    let numbers = |json: &Json| json.as_array().unwrap().clone();
    let state = [
        numbers(&answer["state"]["qpos"]),
        numbers(&answer["state"]["qvel"]),
    ]
    .concat();
    assert_eq!(
        state,
        numbers(&answer["observation"]),
        "two positions, two velocities"
    );
    assert_ne!(state[0], state[2]);
}

/// The command fails if one of several traces differs.
#[test]
fn replay_fails_if_one_trace_does() {
    let out = folder("replay-some");
    let recorded = r#"{"id": "FrozenLake-v1", "events": [{"reset": {"seed": 1, "options": null}, "observation": 0}]}"#;
    let [good, bad] = ["good", "bad"].map(|name| out.join(name).with_extension("json"));
    std::fs::write(&good, recorded).unwrap();
    std::fs::write(
        &bad,
        recorded.replace(r#""observation": 0"#, r#""observation": 3"#),
    )
    .unwrap();
    let [good, bad] = [good.to_str().unwrap(), bad.to_str().unwrap()];
    for order in [[good, bad], [bad, good]] {
        let error = fails(&["replay", order[0], order[1]]);
        assert!(error.contains("1 of 2 traces failed"), "{error}");
    }
    assert!(fails(&["replay", bad, good, bad]).contains("2 of 3 traces failed"));
    assert_eq!(
        fails(&["replay", "/nonexistent/a.json"])
            .matches("a.json")
            .count(),
        1,
        "it is named once"
    );
    prints(&["replay", good]);
}

#[test]
fn replay_loses_no_recording() {
    let out = folder("replay-names");
    let recorded = r#"{"id": "FrozenLake-v1", "events": [{"reset": {"seed": 1, "options": null}, "observation": 0}]}"#;
    let path = |name: &str| {
        let path = out.join(name).join("c.json");
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, recorded).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let [a, b] = ["a", "b"].map(path);
    let answers = out.join("d");
    let error = fails(&["replay", &a, &b, "--out", answers.to_str().unwrap()]);
    assert!(error.contains("would both be written to"), "{error}");
    assert!(
        !answers.join("c.json").exists(),
        "nothing is written before"
    );
    for out in [out.join("a"), out.join("b/../a")] {
        let error = fails(&["replay", &a, "--out", out.to_str().unwrap()]);
        assert!(
            error.contains("is a recording to replay: choose another folder"),
            "{error}"
        );
    }
    assert_eq!(std::fs::read_to_string(&a).unwrap(), recorded);
    prints(&["replay", &a, &a, "--out", answers.to_str().unwrap()]);
}

#[test]
fn a_trace_without_events_is_not_equal() {
    let trace = folder("replay-empty").join("trace.json");
    std::fs::write(&trace, r#"{"id": "FrozenLake-v1", "events": []}"#).unwrap();
    assert!(fails(&["replay", trace.to_str().unwrap()]).contains("nothing to compare"));
}

/// Devices, which may be endless, are not read.
#[cfg(target_os = "linux")]
#[test]
fn devices_are_refused() {
    for command in ["replay", "mjcf"] {
        let error = fails(&[command, "/dev/zero"]);
        assert!(error.contains("/dev/zero: not a regular file"), "{error}");
    }
}

/// `replay` compares entries of the head that describe the environment, and names the other
/// entries.
#[test]
fn replay_compares_the_head_and_names_the_rest() {
    let out = folder("replay-head");
    let head = serde_json::json!({
        "id": "FrozenLake-v1", "kwargs": {"is_slippery": false}, "policy": "by hand", "numpy": "2.4.6",
        "observation_space": "Discrete(16)", "action_space": "Discrete(4)", "max_episode_steps": 100,
        "reward_threshold": 0.7,
        "events": [{"reset": {"seed": 1, "options": null}, "observation": 0, "info": {"prob": 1}}]
    });
    let trace = out.join("trace.json");
    let path = trace.to_str().unwrap();
    let write = |json: &Json| std::fs::write(&trace, json.to_string()).unwrap();
    write(&head);
    let text = prints(&["replay", path]);
    for part in [
        "observation, info, observation_space",
        "equal; not compared: numpy, policy",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    for (name, value, message) in [
        (
            "max_episode_steps",
            500.into(),
            "max_episode_steps: 100 for 500",
        ),
        (
            "max_episode_steps",
            Json::Null,
            "max_episode_steps: 100 for null",
        ),
        (
            "reward_threshold",
            0.8.into(),
            "reward_threshold: 0.7 for 0.8",
        ),
        (
            "observation_space",
            "Discrete(17)".into(),
            "observation_space: \"Discrete(16)\" for \"Discrete(17)\"",
        ),
        ("action_space", "Discrete(5)".into(), "action_space"),
    ] {
        let mut other = head.clone();
        other[name] = value;
        write(&other);
        let error = fails(&["replay", path]);
        assert!(error.contains(message), "{error}");
    }
    // recordings without answers or without events
    for events in [
        serde_json::json!([]),
        serde_json::json!([{"reset": {"seed": 1}}, {"step": 2}]),
    ] {
        let mut other = head.clone();
        other["events"] = events;
        write(&other);
        assert!(fails(&["replay", path]).contains("nothing to compare"));
    }
    let mut other = head.clone();
    other["events"] =
        serde_json::json!([{"reset": {"seed": 1}, "observation": vec![0; 1_000_000]}]);
    write(&other);
    let error = fails(&["replay", path]);
    assert!(
        error.contains("0 for a list of 1000000") && error.len() < 1000,
        "{}",
        error.len()
    );
}

/// A recording with a duplicate key is an error, because the key has two values. `replay` names the
/// entries that it does not compare.
#[test]
fn what_a_recording_says_is_used_or_refused_or_named() {
    let trace = folder("replay-unused").join("trace.json");
    let path = trace.to_str().unwrap();
    let text = r#"{"id": "FrozenLake-v1", "kwargs": {"is_slippery": false}, "events": [
        {"reset": {"seed": 1, "options": {}}, "observation": 0, "info": {"prob": 1}}]}"#;
    let write = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        std::fs::write(&trace, text.replace(from, to)).unwrap();
    };
    for (from, to, key) in [
        (
            r#""is_slippery": false"#,
            r#""is_slippery": true, "is_slippery": false"#,
            "is_slippery",
        ),
        (r#""prob": 1"#, r#""prob": 2, "prob": 1"#, "prob"),
        (r#""options": {}"#, r#""options": {"a": 1, "a": 2}"#, "a"),
        (
            r#""observation": 0"#,
            r#""observation": {"b": 0, "b": 0}"#,
            "b",
        ),
    ] {
        write(from, to);
        let error = fails(&["replay", path]);
        assert!(
            error.contains(&format!("the key `{key}` stands twice")),
            "{error}"
        );
    }
    for (from, to) in [
        (r#""id": "#, r#""id": "Taxi-v4", "id": "#),
        (
            r#""observation": 0"#,
            r#""observation": 1, "observation": 0"#,
        ),
        (r#""events": "#, r#""seed": 1, "seed": 1, "events": "#),
    ] {
        write(from, to);
        fails(&["replay", path]);
    }
    for (name, value) in [
        ("mujoco", r#""3.12""#),
        ("render_mode", r#""rgb_array""#),
        ("frame_mask", "[[0, 0, 1, 1]]"),
        ("observation_mask", "[[0, 0, 1, 1]]"),
    ] {
        write(
            r#""events": "#,
            &format!(r#""{name}": {value}, "events": "#),
        );
        let text = prints(&["replay", path]);
        assert!(
            text.contains(&format!("equal; not compared: {name}")),
            "{text}"
        );
    }
}
