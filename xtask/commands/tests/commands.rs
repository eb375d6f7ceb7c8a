//! The commands as a user runs them.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value as Json;

fn xtask(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_xtask-commands")).args(arguments).output().expect("the command starts")
}

/// What a command that succeeds prints.
fn prints(arguments: &[&str]) -> String {
    let output = xtask(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// What a command that fails says.
fn fails(arguments: &[&str]) -> String {
    let output = xtask(arguments);
    assert!(!output.status.success(), "{arguments:?} succeeds");
    String::from_utf8(output.stderr).expect("text")
}

/// An empty folder of a test's own.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn json(path: &std::path::Path) -> Json {
    serde_json::from_slice(&std::fs::read(path).expect("the file")).expect("JSON")
}

#[test]
fn list() {
    assert!(prints(&["list"]).contains("CartPole-v1"));
    assert!(prints(&["list", "--long"]).contains("Discrete(500)"));
}

#[test]
fn demo() {
    let out = folder("demo");
    let table = prints(&["demo", "--episodes", "2", "--max-frames", "4", "--out", out.to_str().unwrap()]);
    for id in ["CartPole-v1", "Taxi-v4", "CliffWalking-v0", "Blackjack-v1"] {
        assert!(table.contains(id), "{table}");
        for extension in ["gif", "svg", "png"] {
            let file = out.join(format!("{id}.{extension}"));
            assert!(std::fs::metadata(&file).is_ok_and(|file| file.len() > 500), "{}", file.display());
        }
    }
}

#[test]
fn run_writes_episodes() {
    let file = folder("run").join("episodes.json");
    let path = file.to_str().unwrap();
    prints(&["run", "Pendulum-v1", "--seeds", "3..5", "--kwargs", r#"{"g": 9.81}"#, "--json", path]);
    let episodes = json(&file);
    let episodes = episodes.as_array().expect("a list");
    assert_eq!(episodes.len(), 2);
    assert_eq!(episodes[0]["seed"], 3);
    assert_eq!(episodes[0]["length"], 200);
    assert_eq!((&episodes[0]["terminated"], &episodes[0]["truncated"]), (&false.into(), &true.into()));
    assert!(episodes[0]["return"].as_f64().unwrap() < episodes[0]["last_reward"].as_f64().unwrap());
    assert_eq!(episodes[0]["last_observation"].as_array().unwrap().len(), 3);
    let again = folder("run-again").join("episodes.json");
    let path = again.to_str().unwrap();
    prints(&["run", "Pendulum-v1", "--seeds", "4..5", "--kwargs", r#"{"g": 9.81}"#, "--json", path]);
    assert_eq!(json(&again)[0], episodes[1], "an episode depends on its seed alone");
}

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
    prints(&["replay", "--out", answers.to_str().unwrap(), trace.to_str().unwrap()]);
    let text = std::fs::read_to_string(answers.join("trace.json")).unwrap();
    assert!(text.contains(seed), "the seed keeps its digits: {text}");
    assert_eq!(json(&answers.join("trace.json"))["note"], "kept");
    prints(&["replay", answers.join("trace.json").to_str().unwrap()]);

    std::fs::write(&trace, recorded.replace(r#""observation": 1"#, r#""observation": 4"#)).unwrap();
    let difference = fails(&["replay", trace.to_str().unwrap()]);
    assert!(difference.contains("event 1, observation: 1 for 4"), "{difference}");
    std::fs::write(&trace, "[]").unwrap();
    assert!(fails(&["replay", trace.to_str().unwrap()]).contains("not a trace"));
}

#[test]
fn the_book_is_up_to_date() {
    prints(&["docs", "--check"]);
}

/// Each has a controller, and one that is better than chance.
#[test]
fn heuristics_beat_chance() {
    let mean = |id: &str, policy: &str| {
        let file = folder(&format!("heuristic-{id}-{policy}")).join("episodes.json");
        prints(&["run", id, "--policy", policy, "--seeds", "0..20", "--json", file.to_str().unwrap()]);
        let episodes = json(&file);
        let returns = episodes.as_array().unwrap().iter().map(|episode| episode["return"].as_f64().unwrap());
        returns.sum::<f64>() / 20.0
    };
    for (id, least) in [
        ("CartPole-v1", 475.0),
        ("MountainCar-v0", -110.0),
        ("MountainCarContinuous-v0", 90.0),
        ("Pendulum-v1", -200.0),
        ("Acrobot-v1", -100.0),
        ("FrozenLake-v1", 0.6),
        ("CliffWalking-v1", -13.0),
        ("Taxi-v4", 7.0),
        ("LunarLander-v3", 200.0),
    ] {
        let (good, random) = (mean(id, "heuristic"), mean(id, "random"));
        assert!(good >= least && good > random, "{id}: {good}, at random {random}");
    }
    let error =
        fails(&["run", "CarRacing-v3", "--policy", "heuristic", "--kwargs", r#"{"continuous": false}"#]);
    assert!(error.contains("has no heuristic"), "{error}");
}

#[test]
fn new_refuses_bad_names_and_leaves_nothing() {
    let parent = folder("new-refused");
    for name in ["", "1a", "My_envs", "a-b", "a b", "gym_core", "test", "../x", "a/b"] {
        let path = parent.join("x");
        assert!(fails(&["new", "--path", path.to_str().unwrap(), "--", name]).contains("NAME"), "{name:?}");
    }
    let taken = parent.join("taken");
    std::fs::create_dir(&taken).unwrap();
    assert!(fails(&["new", "my_envs", "--path", taken.to_str().unwrap()]).contains("exists already"));
    let file = parent.join("file");
    std::fs::write(&file, "").unwrap();
    let inside = file.join("x");
    assert!(fails(&["new", "my_envs", "--path", inside.to_str().unwrap()]).starts_with("error: "));
    let left: Vec<_> = std::fs::read_dir(&parent).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

#[test]
fn soak_has_flat_memory() {
    let text = prints(&["soak", "CartPole-v1", "Taxi-v4", "LunarLander-v3", "--steps", "60000"]);
    assert!(text.contains("60000 steps of 3 environments with flat memory"), "{text}");
}

#[test]
fn errors_are_told_on_one_line() {
    let unknown = fails(&["run", "CartPoleee-v1"]);
    assert!(unknown.starts_with("error: ") && unknown.contains("did you mean `CartPole-v1`?"), "{unknown}");
    let out = fails(&["gif", "CartPole-v1", "--out", "/nonexistent/folder/x.gif"]);
    assert!(out.contains("/nonexistent/folder"), "{out}");
    assert!(fails(&["run", "CartPole-v1", "--seeds", "5..5"]).contains("A < B"));
    assert!(fails(&["run", "CartPole-v1", "--kwargs", "[]"]).contains("not a JSON object"));
    assert!(fails(&["run", "CartPole-v1", "--kwargs", r#"{"foo": 1}"#]).contains("unknown field `foo`"));
}

#[test]
fn old_versions_are_pointed_out() {
    let output = xtask(&["run", "CartPole-v0", "--seeds", "0..1"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("warn: `CartPole-v0` is out of date"));
}

#[test]
fn what_cannot_be_done_is_said_before_anything_is_played() {
    assert!(fails(&["soak", "CartPole-v1", "--steps", "0"]).contains("--steps"));
    for command in ["gif", "soak"] {
        let error = fails(&[command, "CartPole-v1", "--seed", "-1"]);
        assert!(error.contains("invalid value '-1' for '--seed") && error.contains("from 0 to"), "{error}");
    }
    for option in ["--json", "--plot"] {
        let output = xtask(&["run", "CartPole-v1", option, "/nonexistent/folder/x.svg"]);
        assert!(!output.status.success() && output.stdout.is_empty(), "{option}: it plays first");
        assert!(String::from_utf8_lossy(&output.stderr).contains("/nonexistent/folder"));
    }
}

/// The table says how each episode ended, and the means are those of its rows.
#[test]
fn run_prints_how_episodes_end() {
    let rows = |id: &str, seeds: &str| -> Vec<Vec<String>> {
        let text = prints(&["run", id, "--policy", "random", "--seeds", seeds]);
        text.lines().map(|line| line.split_whitespace().map(str::to_owned).collect()).collect()
    };
    let poles = rows("CartPole-v1", "0..2");
    assert_eq!(poles[0], ["seed", "return", "length", "ended"]);
    assert!(poles[1..3].iter().all(|row| row[3..] == ["terminated"]), "{poles:?}");
    let pendulums = rows("Pendulum-v1", "0..2");
    assert!(pendulums[1..3].iter().all(|row| row[2..] == ["200", "truncated"]), "{pendulums:?}");
    let number = |row: usize| pendulums[row][1].parse::<f64>().unwrap();
    let mean: f64 = pendulums[3][1].parse().unwrap();
    assert!((mean - (number(1) + number(2)) / 2.0).abs() < 0.01, "{pendulums:?}");
}

/// One trace that differs is enough, beside others that do not.
#[test]
fn replay_fails_if_one_trace_does() {
    let out = folder("replay-some");
    let recorded =
        r#"{"id": "FrozenLake-v1", "events": [{"reset": {"seed": 1, "options": null}, "observation": 0}]}"#;
    let [good, bad] = ["good", "bad"].map(|name| out.join(name).with_extension("json"));
    std::fs::write(&good, recorded).unwrap();
    std::fs::write(&bad, recorded.replace(r#""observation": 0"#, r#""observation": 3"#)).unwrap();
    let [good, bad] = [good.to_str().unwrap(), bad.to_str().unwrap()];
    for order in [[good, bad], [bad, good]] {
        let error = fails(&["replay", order[0], order[1]]);
        assert!(error.contains("1 of 2 traces failed"), "{error}");
    }
    prints(&["replay", good]);
}
